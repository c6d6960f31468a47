#pragma once

/// @file
/// Corrections of a motion under way: the tool is moved off the path where it stands, and led back onto it.

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "planning/motion/plan.h"

namespace longarm::planning {

/// A small move of the tool.  The rotation is about the tool's origin; both are given in axes F.
struct Nudge {
  Eigen::Matrix3d R_RF = Eigen::Matrix3d::Identity();    ///< Axes of tool, base or camera in the root frame.
  Eigen::Vector3d way = Eigen::Vector3d::Zero();         ///< [m], in F
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();        ///< Rotation vector [rad], in F
};
Pose nudged(const Pose& X_RT, const Nudge& nudge);

/// The motion with a correction in it.
struct CorrectedPlan {
  Plan plan;                             ///< As played so far; "correction"; then back onto the path and to its end.
  double leave_s = 0;                    ///< Where the arm stands now, in the new trajectory [s].
  double reached_s = 0;                  ///< Where the corrected pose is reached; the arm can rest there [s].
};

/// Corrects `plan` where the arm rests on it after `tau` seconds.
///
/// What was played up to there is kept, to be backed up over.  From the corrected pose the tool follows the rest of the
/// stage with the offset eased out (smoothstep) over 50 mm or three times its size, as far as the stage has that much
/// left, and meets the planned joints again; the stages after it stay as they were.  At the very end of the plan
/// nothing follows: the corrected pose is the new end.  All of it is checked for collisions and limits.
/// @param context  As for the plan; its start is the full configuration now.
/// @returns kOutOfLimits: no finite nudge, or over 0.1 m or 0.35 rad; kNoSolution: the arm cannot follow it;
///   kCollision: something is in the way.  Thread-compatible.
Result<CorrectedPlan> correctPlan(const PlanContext& context, const Plan& plan, double tau, const Nudge& nudge);

}  // namespace longarm::planning
