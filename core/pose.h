#pragma once

/// @file
/// Rigid poses and rotations.  `X_AB` maps coordinates of a point in frame B to frame A: p_A = X_AB * p_B.
/// The conventions of the whole program are in docs/frames.md.

#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace longarm {

using Pose = Eigen::Isometry3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The pose of a named thing in the frame `parent`, as files and JSON write it.
struct PoseInParent {
  std::string parent;
  Pose pose = Pose::Identity();
};

/// Pose from translation [m] and quaternion (x, y, z, w); the quaternion is normalised.
Pose poseFrom(const Eigen::Vector3d& xyz, const Eigen::Vector4d& quaternion_xyzw);
/// Pose from translation [m] and fixed-axis roll, pitch, yaw [rad] about x, y, z in this order (URDF `rpy`).
Pose poseFromRpy(const Eigen::Vector3d& xyz, const Eigen::Vector3d& rpy);
/// Unit quaternion (x, y, z, w) with w >= 0.
Eigen::Vector4d quaternionXyzw(const Eigen::Matrix3d& R);

/// The cross-product matrix [w]x.
Eigen::Matrix3d skew(const Eigen::Vector3d& w);
/// SO(3) exponential of a rotation vector [rad].
Eigen::Matrix3d expSO3(const Eigen::Vector3d& rotvec);
/// SO(3) logarithm; the angle lies in [0, pi].
Eigen::Vector3d logSO3(const Eigen::Matrix3d& R);

/// Angle between two rotations [rad], 0 ... pi.
double angleBetween(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);
/// Linear in translation, geodesic in rotation; s = 0 gives a, s = 1 gives b.
Pose interpolate(const Pose& a, const Pose& b, double s);
/// A rotation whose z axis is `z` (any x, chosen stably).  @pre z is not zero.
Eigen::Matrix3d rotationWithZ(const Eigen::Vector3d& z);
/// Whether every entry is finite and the linear part is a right-handed rotation within `tolerance`.
bool isRigid(const Pose& X, double tolerance = 1e-6);

}  // namespace longarm
