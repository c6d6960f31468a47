#pragma once

/// @file
/// CalibrateLibraryPanel: how the cameras do, and every calibration that was accepted.

#include <QWidget>

#include "ui/appearance.h"
#include "ui/workbench.h"
#include "widgets/hold_button.h"
#include "widgets/image_canvas.h"

class QDoubleSpinBox;
class QLabel;
class QPushButton;
class QTableWidget;

namespace longarm::ui {

/// Left the cameras with age and health, below them the calibrations of the chosen one; right the difference of a chosen
/// calibration from the one in use, over the picture.  GUI thread only.
class CalibrateLibraryPanel final : public QWidget {
  Q_OBJECT

 public:
  CalibrateLibraryPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  QTableWidget* cameras() const { return m_cameras; }
  QTableWidget* records() const { return m_records; }
  widgets::HoldButton* useButton() const { return m_use; }
  QString difference() const;

 Q_SIGNALS:
  void poseWanted(const QString& camera);          ///< The two-minute way back after a knock.

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  QWidget* buildTables(Appearance& appearance);
  QWidget* buildDifference(Appearance& appearance);
  void bind();
  void refresh();
  void refreshCameras();
  void refreshRecords();
  void refreshDifference();
  QString chosenCamera() const;
  QString chosenRecord() const;                    ///< Id; empty: the workcell's own file, or nothing is chosen.
  void use();

  Workbench& m_bench;
  QTableWidget *m_cameras, *m_records;
  QPushButton *m_export, *m_repose;
  widgets::HoldButton* m_use;
  widgets::ImageCanvas* m_canvas;
  QDoubleSpinBox* m_depth;
  QLabel *m_health, *m_difference;
};

}  // namespace longarm::ui
