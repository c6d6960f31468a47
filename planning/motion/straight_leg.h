#pragma once

/// @file
/// Straight legs: joint waypoints that carry the tool along a line.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "planning/motion/arm_space.h"

namespace longarm::planning {

struct LegOptions {
  double step = 0.005;                   ///< Largest way of the tool between waypoints [m].
  double position_tolerance = 1e-3;      ///< Of the tool between waypoints [m].
  double angle_tolerance = 0.01;         ///< [rad]
  double max_joint_step = 0.1745;        ///< Between waypoints: more is a change of branch [rad].
};

struct StraightLeg {
  bool ok = false;
  double fraction = 0;                   ///< Of the way that was reached.
  std::string why;                       ///< A sentence; empty when ok.
  std::vector<Eigen::VectorXd> waypoints;        ///< Arm joints, start to end.
  std::vector<double> way;               ///< Way of the tool at each [m] (or [rad], if it only turns).
};

/// Follows the line from the tool's pose at `start` to `X_end` (orientation along the shortest turn), each waypoint
/// solved from the one before it (damped Newton steps on the pose error).
///
/// Between waypoints the tool is tested at the middle of the joint motion, and the step is halved until it stays
/// within the tolerances; a joint step over `max_joint_step`, or over three times the median, ends the leg: the arm
/// would have to change its branch.  Collisions are not looked at.
StraightLeg followLine(const ArmSpace& space, const Eigen::VectorXd& start, const Pose& X_end,
                       const LegOptions& options = {});

/// Newton steps from `start` to the pose, within the limits; false if they do not arrive (1e-7 m, 1e-7 rad).
bool solveNear(const ArmSpace& space, const Pose& X, Eigen::VectorXd& arm, int iterations = 12);

}  // namespace longarm::planning
