#pragma once

/// @file
/// A plan as the verb `plan` prints it.

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "planning/motion/plan.h"

namespace longarm::planning {

/// status, reason, macro, advice, failed_stage, failed_waypoint, failed_pose, planning_seconds, min_clearance, clearance, duration,
/// max_velocity_ratio, max_acceleration_ratio, goal, go, accuracy_note, notes, figures, pan_tilt,
/// stages.
/// @param root  Name of the root link: parent of the poses.
nlohmann::json toJson(const Plan& plan, const std::string& root = "base_link");

}  // namespace longarm::planning
