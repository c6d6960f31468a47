#pragma once

/// @file
/// The straight lift after a grasp.

#include <string>

#include <Eigen/Core>

#include "core/motion.h"
#include "core/result.h"
#include "planning/world/workcell.h"

namespace longarm::session {

/// Raises the tool with what was grasped in its fingers, past everything the console knows of: straight up, or where
/// the arm cannot, along a line that leans up to 80 mm to one side.
/// @param q        Full configuration: the arm holds it.
/// @param grasped  Where it was measured, in the root frame.
/// @param height   [m]
/// @returns for the straight way: kNoSolution when the arm cannot go so far, kCollision when something is in the way.
Result<Trajectory> planLift(const planning::Workcell& workcell, const Eigen::VectorXd& q, const planning::WorldObject& grasped,
                            double height);

}  // namespace longarm::session
