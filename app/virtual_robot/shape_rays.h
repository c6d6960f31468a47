#pragma once

/// @file
/// Points on shapes and falls of bodies: the virtual world's own sense of touch for grasping and settling.

#include <vector>

#include <Eigen/Core>

#include "planning/world/shape_rays.h"

namespace longarm::virtual_robot {

/// Points of the surface in the shape's frame, at most about `step_m` apart (coarser on very large shapes).  Pure.
std::vector<Eigen::Vector3d> surfacePoints(const planning::Shape& shape, double step_m);

/// How far `body` can fall straight down (-z) before it meets one of `others` or the plane z = ground; 0 when it
/// rests on something.  By rays from both surfaces, every 3 mm.  Pure.
double fallDistance(const planning::WorldObject& body, const std::vector<planning::WorldObject>& others,
                    double ground_z);

}  // namespace longarm::virtual_robot
