#pragma once

/// @file
/// A rigid transform from nothing: points to rays that need not meet.

#include <vector>

#include <Eigen/Core>

#include "core/pose.h"

namespace longarm::calibration {

/// The point T y must lie on the ray.
struct RayToPoint {
  Eigen::Vector3d origin, direction;     ///< In the left-hand frame of T; direction of length 1.
  Eigen::Vector3d y;                     ///< In the right-hand frame of T.
};

/// A transform and how badly the points miss the rays.
struct RayFit {
  Pose T;
  double misses = 0;                     ///< Sum of squared distances [m^2].
};

/// Minima of the summed squared distance of points to rays, best first.
///
/// With the translation eliminated that sum is a quadratic form in the nine entries of the rotation; it is descended
/// on SO(3) from the 24 rotations of the cube, which lie within 62.3 degrees of every rotation, and each minimum is
/// kept once.  One camera centre for all rays or many makes no difference.  Pure function; the same for any order of
/// the observations but for rounding.
/// @pre At least three observations.
std::vector<RayFit> fitRays(const std::vector<RayToPoint>& observations);

/// The 24 rotations of the cube.
const std::vector<Eigen::Matrix3d>& cubeRotations();

}  // namespace longarm::calibration
