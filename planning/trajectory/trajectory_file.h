#pragma once

/// @file
/// Trajectories as JSON: {"joint_names": [...], "points": [{"t", "positions", "velocities", "accelerations"}, ...]}.

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "core/motion.h"
#include "core/result.h"

namespace longarm::planning {

nlohmann::json toJson(const Trajectory& trajectory);
/// @returns kInvalidInput naming the key, point and value; the trajectory is well formed (core/motion.h validate()).
Result<Trajectory> trajectoryFromJson(const nlohmann::json& json);

/// Reads a trajectory file of at most 64 MB, 200,000 points and 64 joints.
/// @returns kNotFound / kInvalidInput naming file, place and value.
Result<Trajectory> readTrajectory(const std::string& path);
/// Writes beside, then renames.
Status writeTrajectory(const std::string& path, const Trajectory& trajectory);

}  // namespace longarm::planning
