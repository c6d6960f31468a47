#pragma once

/// @file
/// ZoomController: the table of a zoom camera, how good it is, and where it lacks a calibration.

#include <optional>
#include <vector>

#include <QObject>
#include <QString>

#include "calibration/zoom/zoom_join.h"
#include "calibration/zoom/zoom_quality.h"
#include "session/calibration/calibration_controller.h"
#include "session/controllers/job_runner.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::session {

/// GUI thread only.
class ZoomController final : public QObject {
  Q_OBJECT

 public:
  /// Everything is borrowed and outlives this.
  ZoomController(CalibrationController& calibration, JobRunner& jobs, QObject* parent = nullptr);

  void openFile(const QString& path);              ///< A zoom camera's XML.
  void openFolder(const QString& folder);          ///< Calibrations at single settings, the setting in each name.
  void clear();
  const vision::ZoomCamera& table() const { return m_table; }
  const std::vector<std::string>& warnings() const { return m_warnings; }

  /// The newest result of the board wizard as the node at `zoom`; the mount is the one in use.  Replaces a node there.
  /// Principal points are joined with those of the other settings (calibration::joinZoom).
  QString whyNotAddLens(const std::string& camera, double zoom) const;
  void addLens(const std::string& camera, double zoom);
  /// The setting at which the lens of a camera is at its long end: beyond, its picture is only enlarged.
  double lastSetting(const std::string& camera) const;
  void removeNode(std::size_t node);

  /// Every node but the first and last, predicted from the others.
  const std::vector<calibration::ZoomMiss>& misses() const { return m_misses; }
  /// Where another calibration would help most; empty when every node is green, or there are fewer than two.
  const std::vector<double>& advised() const { return m_advised; }
  /// Of all nodes but nominal ones, the worst light.
  calibration::TrafficLight light() const;

  QString whyNotSave() const;
  void save(const QString& path);
  /// Keeps the table in the library; the camera uses it from now on at every zoom.
  void use(const std::string& camera);

  /// Settings to command in turn so that play in the drive is always taken up from the same side.
  static std::vector<double> approach(double zoom);

 Q_SIGNALS:
  void changed();
  void saved(const QString& path);
  void failed(const QString& sentence);

 private:
  void take(vision::ZoomCamera table, std::vector<std::string> warnings);
  void judge();
  vision::ZoomFile file(const std::string& name) const;

  CalibrationController& m_calibration;
  JobRunner& m_jobs;
  std::vector<calibration::ZoomLens> m_lenses;     // as calibrated, each by itself; sorted
  vision::ZoomCamera m_table;                      // joined
  std::vector<std::string> m_file_warnings, m_warnings;
  std::vector<calibration::ZoomMiss> m_misses;
  std::vector<double> m_advised;
};

}  // namespace longarm::session
