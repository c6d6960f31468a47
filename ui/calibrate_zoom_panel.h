#pragma once

/// @file
/// CalibrateZoomPanel: the table of a zoom camera, setting by setting.

#include <QWidget>

#include "session/calibration/zoom_controller.h"
#include "ui/appearance.h"
#include "ui/workbench.h"
#include "ui/zoom_curve.h"
#include "widgets/hold_button.h"

class QComboBox;
class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QTableWidget;

namespace longarm::ui {

/// GUI thread only.
class CalibrateZoomPanel final : public QWidget {
  Q_OBJECT

 public:
  CalibrateZoomPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  QTableWidget* nodes() const { return m_nodes; }
  QComboBox* camera() const { return m_camera; }
  QDoubleSpinBox* setting() const { return m_setting; }
  QPushButton* addButton() const { return m_add; }
  widgets::HoldButton* useButton() const { return m_use; }
  QPushButton* goButton() const { return m_go; }
  QString advice() const;

 protected:
  void showEvent(QShowEvent* event) override;
  void hideEvent(QHideEvent* event) override;

 private:
  QWidget* buildSteps(Appearance& appearance);
  QWidget* buildTable();
  void bind();
  void refresh();
  void refreshDrive();
  QString whyNotGo() const;
  void go();
  session::ZoomController& model() const { return m_bench.zoom(); }

  Workbench& m_bench;
  QTableWidget* m_nodes;
  QComboBox* m_camera;
  QDoubleSpinBox* m_setting;
  QPushButton *m_go, *m_advised, *m_add, *m_remove, *m_open, *m_folder, *m_clear, *m_save;
  QLabel *m_advice, *m_warnings;
  ZoomCurve* m_curve;
  widgets::HoldButton* m_use;
};

}  // namespace longarm::ui
