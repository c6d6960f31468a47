#pragma once

/// @file
/// HealthController: which cameras were probably knocked, from what the operator marks anyway.

#include <map>
#include <vector>

#include <QObject>
#include <QString>

#include "calibration/health/miss_watch.h"
#include "session/calibration/calibration_controller.h"
#include "session/calibration/pose_controller.h"

namespace longarm::session {

/// Judges anew when sketch, clicks or calibrations change.  Only picks that were placed freely count (those slid along a curve
/// have no miss), in pictures taken by the robot's cameras since their calibration was put to use.  GUI thread only.
class HealthController final : public QObject {
  Q_OBJECT

 public:
  /// Everything is borrowed and outlives this.
  HealthController(Document& document, CalibrationController& calibration, PoseController& pose, QObject* parent = nullptr);
  ~HealthController() override;

  const std::map<std::string, calibration::CameraHealth>& cameras() const { return m_cameras; }
  calibration::CameraHealth of(const std::string& camera) const;
  /// The worst of all.
  calibration::HealthLevel level() const;
  QString worstCamera() const;                     ///< Empty when all are good or unknown.
  /// Days since the calibration in use was made, or the camera's own file was written; < 0: not known.
  double ageDays(const std::string& camera) const;
  /// Why a motion to this feature would be built on sand; empty: it would not.
  QString whyNotTrust(FeatureId feature) const;

 Q_SIGNALS:
  void changed();

 private:
  void judge();
  bool counts(const vision::Snapshot& snapshot) const;
  void addMisses(const SketchItem& item, std::vector<calibration::MissSample>* out) const;

  Document& m_document;
  CalibrationController& m_calibration;
  PoseController& m_pose;
  int m_observer = 0;
  std::map<std::string, calibration::CameraHealth> m_cameras;
};

/// Signed distance of the lines of sight through two pixels, in pixels of the nearer view at the point where they pass, and
/// what picks and stated calibrations let it be (1 sigma).  Empty: a pixel has no ray, or the lines are parallel.  Pure function.
std::optional<calibration::MissSample> missOf(const vision::View& a, const Eigen::Vector2d& pixel_a, const vision::View& b,
                                              const Eigen::Vector2d& pixel_b);

}  // namespace longarm::session
