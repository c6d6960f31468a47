#pragma once

/// @file
/// Rays against shapes.

#include <optional>

#include <Eigen/Core>

#include "planning/world/shape.h"

namespace longarm::planning {

/// Distance from `origin` along the unit vector `direction` to the first point of the shape at `pose`; 0 when the
/// origin is inside (solids).  Same frame for all three.  Pure function.
std::optional<double> rayDistance(const Shape& shape, const Pose& pose, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction);

/// Radius of a sphere around the shape's origin that holds it [m].
double boundingRadius(const Shape& shape);

}  // namespace longarm::planning
