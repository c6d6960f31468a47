#pragma once

/// @file
/// The picture of a plane.

#include <vector>

#include <Eigen/Core>

#include "calibration/intrinsics/board_view.h"
#include "core/pose.h"

namespace longarm::calibration {

/// The plane of a view's corners: x and y of frame P lie in it.
struct CornerPlane {
  Pose X_KP = Pose::Identity();
  double flatness = 0;                     ///< Extent across the plane over extent along it.
  double narrowness = 0;                   ///< Second extent over the first: 0 for a line.
};
/// @pre At least 3 corners.
CornerPlane planeOf(const std::vector<Corner>& corners);

/// Homography from plane coordinates (of P) to the given 2-D points, one per corner, by the normalised linear
/// solution.  @pre At least 4 corners.
Eigen::Matrix3d planeHomography(const std::vector<Corner>& corners, const CornerPlane& plane,
                                const std::vector<Eigen::Vector2d>& points);

/// Pose X_CP from a homography into ideal normalised coordinates, in front of the camera.
Pose poseFromHomography(const Eigen::Matrix3d& H);

}  // namespace longarm::calibration
