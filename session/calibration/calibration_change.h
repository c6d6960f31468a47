#pragma once

/// @file
/// What a calibration found out, before it is kept or used.

#include <optional>
#include <string>

#include "session/calibration/camera_library.h"

namespace longarm::session {

/// What a calibration found out about one camera; what is empty stays as it is.
struct CameraChange {
  std::string camera;                              ///< Of the workcell.
  std::string kind;                                ///< As CalibrationRecord::kind.
  std::string note;
  std::optional<vision::CameraModel> lens;
  Eigen::Matrix<double, 10, 10> lens_covariance = Eigen::Matrix<double, 10, 10>::Zero();
  std::optional<Pose> X_LC;                        ///< Optical frame in the camera's link.
  Matrix6d pose_covariance = Matrix6d::Zero();     ///< Of its split increment.
  std::optional<double> zoom;                      ///< Setting at which it was found; all settings move with the mount.
  int observations = 0;
  double rms_px = 0;
  std::string raw, raw_ending;                     ///< What it was made from, as text; "csv", "json".
};

/// Where a pan-tilt or an object of the workcell was found to stand.
struct PlaceChange {
  Subject subject = Subject::kObject;
  std::string name;                                ///< Of the workcell.
  std::string note;
  Placement placement;                             ///< In the parent that the workcell gives it.
  int observations = 0;
  double rms_px = 0;
  std::string raw, raw_ending;
};

}  // namespace longarm::session
