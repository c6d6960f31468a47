#pragma once

/// @file
/// A view: one camera frozen at one place, and a snapshot: a view with its picture and the robot's state.

#include <map>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/base_motion.h"
#include "core/ids.h"
#include "core/motion.h"
#include "core/pose.h"
#include "vision/camera/camera_model.h"

namespace longarm::vision {

/// Where a picture was taken from and with what.
struct View {
  std::string name;
  CameraModel camera;
  std::string parent = "base_link";          ///< Frame that X_WC and every result are expressed in.
  Pose X_WC = Pose::Identity();              ///< Camera optical frame in `parent`.
  double sigma_px = 0.5;                     ///< Pick noise, 1 sigma [px].
  std::optional<double> zoom;                ///< Setting that `camera` holds for, 0 ... 1; empty: the lens is fixed.
  /// Covariance of (rotvec [rad], translation [m]) of X_WC as a left perturbation in `parent`; zero if unknown.
  /// The two parts are split: R <- Exp(rotvec) R, p <- p + translation (the camera turns about its own centre).
  Matrix6d pose_covariance = Matrix6d::Zero();
  /// Covariance of (fx fy skew cx cy k1 k2 p1 p2 k3) [px^2, 1]; zero if unknown.  Views of one camera (same name and
  /// numbers) share this error, whatever their poses.
  Eigen::Matrix<double, 10, 10> intrinsics_covariance = Eigen::Matrix<double, 10, 10>::Zero();

  /// Raw pixel of a point given in `parent`; fails as CameraModel::project.
  Result<Eigen::Vector2d> project(const Eigen::Vector3d& p_W) const;
};

/// One picture, frozen with its camera model and the state of the robot at its own exposure.  Immutable once made.
struct Snapshot {
  SnapshotId id;
  View view;
  cv::Mat image;                             ///< 8-bit BGR or grey; never written after publication.
  double stamp_s = 0;                        ///< Monotonic time of exposure [s].
  double wall_time_s = 0;                    ///< Wall time, for display and records [s since 1970].
  JointState robot_state;                    ///< Joints at the exposure; empty for pictures from files.
  std::optional<BaseState> base;             ///< Odometry at the exposure; empty: no base, or from files.
  std::string source;                        ///< "live", or the path of the file.
};
using SnapshotPtr = std::shared_ptr<const Snapshot>;

}  // namespace longarm::vision
