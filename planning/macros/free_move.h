#pragma once

/// @file
/// A free motion to one configuration as a stage of a plan.

#include <string>

#include <Eigen/Core>

#include "planning/macros/planning_run.h"
#include "planning/motion/arm_space.h"

namespace longarm::planning {

/// Searches a way from the run's start to `goal`, times it, and appends it as stage `stage`; measures
/// clearance and ratios.
/// @param where  For the sentence of a failure: "\"home\"".
/// @returns whether it was found; else the run has failed and its plan says why.
bool appendFreeMove(PlanningRun& run, const ArmSpace& space, const Eigen::VectorXd& goal,
                    const std::string& where, const std::string& stage);

}  // namespace longarm::planning
