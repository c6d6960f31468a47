#pragma once

/// @file
/// An independent look at a finished trajectory: limits, continuity, collisions.  Shares no checking code with
/// the planner: plain FCL collide() at fine fixed steps, limits by resampling at 1 kHz.

#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "core/motion.h"
#include "core/result.h"
#include "planning/world/shape.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// An object that some links may touch during a part of the trajectory.
struct AllowedContact {
  std::string object;
  std::vector<std::string> links;
  double from_s = 0, to_s = 0;           ///< Interval of the trajectory.
};

struct CheckOptions {
  double joint_step = 0.2 * 3.14159265358979323846 / 180;   ///< Largest joint move between two looks [rad or m].
  double limit_tolerance = 1e-6;         ///< Limits may be passed by this.
  std::vector<WorldObject> objects;      ///< Beyond the workcell's own.
  std::vector<AllowedContact> allowed;
  std::size_t max_violations = 50;       ///< The list ends there; `ok` is false all the same.
};

struct Violation {
  std::string kind;                      ///< "malformed", "position", "velocity", "acceleration", "continuity", "rest", "collision"
  double t = 0;                          ///< [s]
  std::string first, second;             ///< Joint (second empty), or the touching pair.
  double value = 0, limit = 0;
  std::string sentence;
};

struct CheckReport {
  bool ok = false;
  double duration = 0;                   ///< [s]
  double max_velocity_ratio = 0, max_acceleration_ratio = 0;   ///< Of the workcell's limits.
  double max_tool_speed = 0;             ///< [m/s]
  int states = 0;                        ///< Configurations checked for collision.
  std::vector<Violation> violations;
};

/// @param q  Full configuration that gives the joints the trajectory does not name (gripper open, head, torso).
/// @returns kInvalidInput when joints of the trajectory are not the arm's, or q has the wrong size.
Result<CheckReport> checkTrajectory(const Workcell& workcell, const Trajectory& trajectory, const Eigen::VectorXd& q,
                                    const CheckOptions& options = {});

/// {"ok", "duration", "max_velocity_ratio", "max_acceleration_ratio", "max_tool_speed", "states", "violations": [...]}
nlohmann::json toJson(const CheckReport& report);

}  // namespace longarm::planning
