#pragma once

/// @file
/// Planes from two connected lines.

#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/sketch/shapes.h"

namespace longarm::vision {

struct PlaneOptions {
  double refuse_angle = 10 * 0.017453292519943295;   ///< Normal less certain than this (RMS) is refused [rad].
  double warn_angle = 3 * 0.017453292519943295;      ///< [rad]
};

/// The plane of three points.
/// @param points         (3 x 3) vertices 0, 1, 2 as columns, 1 shared by the two lines [m].
/// @param covariance     (9 x 9) of the three, vertices one below the other [m^2].
/// @param towards        A place that the normal points to: the middle of the cameras [m].
/// @param warnings       Receives a sentence when the normal is less certain than warn_angle; may be null.
/// @returns kDegenerate when the points are in line or the normal is less certain than refuse_angle; the message
///   gives the angle between the lines and says what to do.  Pure function.
Result<PlaneShape> planeThrough(const Eigen::Matrix3d& points, const Eigen::Matrix<double, 9, 9>& covariance,
                                const Eigen::Vector3d& towards, std::vector<std::string>* warnings,
                                const PlaneOptions& options = {});

}  // namespace longarm::vision
