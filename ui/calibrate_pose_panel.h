#pragma once

/// @file
/// CalibratePosePanel: where a camera, a pan-tilt's foot or an object is, from known points clicked in pictures.

#include <array>
#include <memory>

#include <QWidget>

#include "session/calibration/pose_controller.h"
#include "ui/appearance.h"
#include "ui/scene_contents.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QListWidget;
class QPushButton;
class QSplitter;
class QTableWidget;
class QTabWidget;

namespace longarm::ui {

/// The picture, the scene with the known things (click a corner in either), the list of corners, and the answer.
/// GUI thread only.
class CalibratePosePanel final : public QWidget {
  Q_OBJECT

 public:
  CalibratePosePanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);
  ~CalibratePosePanel() override;

  widgets::ImageCanvas* canvas() const { return m_canvas; }
  QComboBox* camera() const { return m_camera; }
  QComboBox* unknown() const { return m_unknown; }
  QCheckBox* cameraToo() const { return m_camera_too; }
  QComboBox* object() const { return m_object; }
  widgets::SceneView* scene() const { return m_scene; }
  QTableWidget* points() const { return m_points; }
  QListWidget* landmarks() const { return m_landmarks; }
  QPushButton* takeButton() const { return m_take; }
  QPushButton* otherButton() const { return m_other; }
  widgets::HoldButton* applyButton() const { return m_apply; }
  QString result() const;

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  QWidget* buildPicture(Appearance& appearance);
  QWidget* buildWhatStep();
  QWidget* buildPointsStep();
  QWidget* buildAnswer(Appearance& appearance);
  void buildScene(Appearance& appearance);
  void bind();
  void refreshSnapshots();
  void refreshLandmarks();
  void refresh();
  void refreshPoints();
  void refreshAnswer();
  void refreshScene();
  void refreshMarks(const Eigen::VectorXd& q);
  void onScene(const QPointF& position);
  void onPointer(const vision::PointerEvent& event);
  void takeGuess();
  void take();
  QString whyNotTake() const;
  void apply();
  session::PoseController& model() const { return m_bench.pose(); }

  Workbench& m_bench;
  Appearance& m_appearance;
  widgets::ImageCanvas* m_canvas;
  QSplitter* m_views;
  widgets::SceneView* m_scene = nullptr;           // Made when it is first seen.
  std::unique_ptr<SceneContents> m_contents;
  std::unique_ptr<scene::WorldRep> m_marks;        // Clicked points and the chosen one.
  QTabWidget* m_steps;
  QComboBox *m_camera, *m_unknown, *m_object, *m_snapshot;
  QCheckBox* m_camera_too;
  QListWidget* m_landmarks;
  std::array<QDoubleSpinBox*, 6> m_guess;
  QTableWidget* m_points;
  QPushButton *m_take, *m_remove, *m_clear, *m_other;
  widgets::HoldButton* m_apply;
  QLabel *m_hint, *m_result;
  bool m_filling = false;
};

}  // namespace longarm::ui
