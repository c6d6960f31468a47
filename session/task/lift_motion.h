#pragma once

/// @file
/// The straight lift after a grasp.

#include <string>

#include <Eigen/Core>

#include "core/motion.h"
#include "core/result.h"
#include "planning/world/workcell.h"
#include "vision/sketch/feature.h"

namespace longarm::session {

/// Raises the tool with the measured pipe in its fingers, past everything the console knows of: straight up, or where
/// the arm cannot, along a line that leans up to 80 mm to one side.
/// @param q       Full configuration: the arm holds the pipe.
/// @param height  [m]
/// @returns for the straight way: kNoSolution when the arm cannot go so far, kCollision when something is in the way.
Result<Trajectory> planLift(const planning::Workcell& workcell, const Eigen::VectorXd& q, const vision::Feature& pipe,
                            double radius, double height);

}  // namespace longarm::session
