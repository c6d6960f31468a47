#pragma once

/// @file
/// How far a body can move per joint: the motion bounds of continuous collision checking.

#include <utility>
#include <vector>

#include "planning/collision/bounds.h"
#include "planning/robot/robot_model.h"

namespace longarm::planning {

/// (entry of q, longest way any point of the body moves per unit of it) [m/rad or 1].
using MotionBound = std::vector<std::pair<int, double>>;

/// Bound of a body on `link` against link `ancestor` (on the way from `link` to the root; -1: the root), over all
/// configurations within the limits: the largest distance of its points from each joint's axis; 1 for a sliding joint.
/// @param X_LS  Pose of the body's bounds in the link.
MotionBound motionBound(const RobotModel& model, int link, int ancestor, const ShapeBounds& bounds, const Pose& X_LS);

/// Nearest link that both hang from.
int commonAncestor(const RobotModel& model, int a, int b);

}  // namespace longarm::planning
