#pragma once

/// @file
/// CalibrateFixturePanel: a camera from one picture of a fixture.

#include <QWidget>

#include "session/calibration/fixture_controller.h"
#include "ui/appearance.h"
#include "ui/fixture_picture.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QComboBox;
class QLabel;
class QPushButton;
class QTableWidget;

namespace longarm::ui {

/// GUI thread only.
class CalibrateFixturePanel final : public QWidget {
  Q_OBJECT

 public:
  CalibrateFixturePanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  widgets::ImageCanvas* canvas() const { return m_canvas; }
  FixturePicture* fixture() const { return m_fixture; }
  QTableWidget* points() const { return m_points; }
  QPushButton* takeButton() const { return m_take; }
  QPushButton* matchButton() const { return m_match; }
  widgets::HoldButton* applyButton() const { return m_apply; }
  QString result() const;

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildPicture(Appearance& appearance);
  QWidget* buildSide(Appearance& appearance);
  void bind();
  void refresh();
  void refreshTarget();
  void refreshPoints();
  void refreshOverlay();
  session::FixtureController& model() const { return m_bench.fixture(); }

  Workbench& m_bench;
  widgets::ImageCanvas* m_canvas;
  FixturePicture* m_fixture;
  QComboBox *m_camera, *m_distortion;
  QTableWidget* m_points;
  QPushButton *m_open_fixture, *m_open_picture, *m_take, *m_match, *m_remove, *m_clear, *m_save;
  widgets::HoldButton* m_apply;
  QLabel *m_hint, *m_result;
  bool m_filling = false;
};

}  // namespace longarm::ui
