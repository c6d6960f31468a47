#pragma once

/// @file
/// Points on shapes and rays against shapes: the virtual world's own sense of touch for grasping and settling.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "planning/world/shape.h"

namespace longarm::virtual_robot {

/// Points of the surface in the shape's frame, at most about `step_m` apart (coarser on very large shapes).  Pure.
std::vector<Eigen::Vector3d> surfacePoints(const planning::Shape& shape, double step_m);

/// Distance from `origin` along the unit vector `direction` to the first point of the shape at `pose`; 0 when the
/// origin is inside (solids).  Same frame for all three.  Pure.
std::optional<double> rayDistance(const planning::Shape& shape, const Pose& pose, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction);

/// Radius of a sphere around the shape's origin that holds it [m].
double boundingRadius(const planning::Shape& shape);

/// How far `body` can fall straight down (-z) before it meets one of `others` or the plane z = ground; 0 when it
/// rests on something.  By rays from both surfaces, every 3 mm.  Pure.
double fallDistance(const planning::WorldObject& body, const std::vector<planning::WorldObject>& others,
                    double ground_z);

}  // namespace longarm::virtual_robot
