#pragma once

/// @file
/// From waypoints to a timed, re-checked trajectory in stages.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/motion.h"
#include "core/result.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/plan.h"
#include "planning/motion/straight_leg.h"

namespace longarm::planning {

/// Speeds of one stage; both caps hold at playback speed 1.
struct StageSpeed {
  double max_tool_speed = 0.25;          ///< [m/s]
};

/// A free joint path, its corners rounded, with times.
///
/// Corners are rounded as far as the rounding stays free (each curve is checked in chords that it leaves by less than
/// 0.2 mrad); the finished trajectory is then checked once more, point to point and continuously.
/// @param waypoints  Every straight piece free in the space's collision world.
/// @returns kCollision when the finished trajectory cannot be certified (or the space was cancelled), kDegenerate and kCancelled
///   as parameterize().
Result<Trajectory> timedPath(const Workcell& workcell, const ArmSpace& space, const std::vector<Eigen::VectorXd>& waypoints,
                             const StageSpeed& speed);

/// A straight leg with times.  @returns as timedPath(), kCollision when the leg is not free.
Result<Trajectory> timedLeg(const Workcell& workcell, const ArmSpace& space, const StraightLeg& leg,
                            const StageSpeed& speed);

/// Whether the whole trajectory is free, continuously from point to point, at 40 % of the world's paddings: the
/// pieces were found at the full padding and certified at half of it.
bool certified(const ArmSpace& space, const Trajectory& trajectory, Contact* contact);

/// Appends a stage to a plan.
void appendStage(Plan& plan, const std::string& name, bool straight, const Trajectory& trajectory);

/// Fills in max_velocity_ratio and max_acceleration_ratio, of the workcell's limits; worth nothing when it was cancelled.
void measureRatios(const Workcell& workcell, Plan& plan, const CancelToken& cancel);

/// Looks along [from_s, to_s] of the plan's trajectory: adds to its clearance profile, which ends there or before, and lowers
/// min_clearance (an empty profile: begins with it; at most 0.5 m).  Ends early when the space is cancelled.
void measureClearance(const ArmSpace& space, Plan& plan, double from_s, double to_s);

}  // namespace longarm::planning
