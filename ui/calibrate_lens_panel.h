#pragma once

/// @file
/// CalibrateLensPanel: distortion by hand, against edges that should be straight.

#include <array>

#include <QWidget>

#include "session/calibration/lens_controller.h"
#include "ui/appearance.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QSlider;

namespace longarm::ui {

/// GUI thread only.
class CalibrateLensPanel final : public QWidget {
  Q_OBJECT

 public:
  CalibrateLensPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  widgets::ImageCanvas* canvas() const { return m_canvas; }
  QComboBox* camera() const { return m_camera; }
  QSlider* slider(int index) const { return m_sliders[static_cast<std::size_t>(index)]; }
  QCheckBox* straightened() const { return m_straightened; }
  QPushButton* takeButton() const { return m_take; }
  QComboBox* coefficients() const { return m_coefficients; }
  QPushButton* solveButton() const { return m_solve; }
  widgets::HoldButton* applyButton() const { return m_apply; }

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildPicture(Appearance& appearance);
  QWidget* buildSide(Appearance& appearance);
  void bind();
  void refresh();
  void refreshTarget();
  void onPointer(const vision::PointerEvent& event);
  session::LensController& model() const { return m_bench.lens(); }

  Workbench& m_bench;
  widgets::ImageCanvas* m_canvas;
  QComboBox *m_camera, *m_coefficients;
  QCheckBox *m_straightened, *m_follow;
  std::array<QSlider*, 4> m_sliders;
  std::array<QDoubleSpinBox*, 4> m_values;
  QPushButton *m_open, *m_take, *m_new_guide, *m_remove, *m_solve, *m_zero, *m_reset;
  widgets::HoldButton* m_apply;
  QLabel *m_hint, *m_result;
  bool m_filling = false;
};

}  // namespace longarm::ui
