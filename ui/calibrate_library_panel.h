#pragma once

/// @file
/// CalibrateLibraryPanel: how the cameras do, and every calibration that was accepted.

#include <optional>
#include <string>

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

/// Left the cameras with age and health, and the pan-tilts and objects; below them the calibrations of the chosen one; right the
/// difference of a chosen calibration from the one in use, over the picture.  GUI thread only.
class CalibrateLibraryPanel final : public QWidget {
  Q_OBJECT

 public:
  CalibrateLibraryPanel(Workbench& bench, Appearance& appearance, QWidget* parent = nullptr);

  QTableWidget* cameras() const { return m_cameras; }
  QTableWidget* records() const { return m_records; }
  widgets::HoldButton* useButton() const { return m_use; }
  QPushButton* reposeButton() const { return m_repose; }
  QPushButton* againButton() const { return m_again; }
  QPushButton* exportButton() const { return m_export; }
  QString difference() const;
  void choose(const QString& camera);

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
  void refreshPlacement(const std::optional<session::CalibrationRecord>& record);
  std::optional<double> zoomOf(const QString& camera) const;
  void fillCamera(int row, const std::string& name);
  void fillPlace(int row, session::Subject subject, const std::string& name);
  void exportTo(const session::CalibrationRecord& record);
  session::Subject chosenSubject() const;
  std::optional<session::CalibrationRecord> recordInUse() const;
  QString chosenCamera() const;                    ///< Or pan-tilt, or object.
  QString chosenRecord() const;                    ///< Id; empty: the workcell's own file, or nothing is chosen.
  void use();

  Workbench& m_bench;
  QTableWidget *m_cameras, *m_records;
  QPushButton *m_export, *m_repose, *m_again;
  widgets::HoldButton* m_use;
  widgets::ImageCanvas* m_canvas;
  QDoubleSpinBox* m_depth;
  QLabel *m_health, *m_difference;
};

}  // namespace longarm::ui
