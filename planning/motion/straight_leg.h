#pragma once

/// @file
/// Straight legs, and other paths of the tool: the joint waypoints that carry it along them.

#include <functional>
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
  double even_step = 0;                  ///< Steps up to this need not be even [rad].
};

struct StraightLeg {
  bool ok = false;
  double fraction = 0;                   ///< Of the way that was reached.
  std::string why;                       ///< A sentence; empty when ok.
  std::string next;                      ///< What is wrong with the next piece, as a verb and what follows.
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

/// The same along any path of the tool.
/// @param X_RT      Pose of the tool after a way of s [m]; at 0 it is where `start` holds the tool.
/// @param stations  Increasing from 0: where waypoints are wanted; `step` of the options does not count.
StraightLeg followPath(const ArmSpace& space, const Eigen::VectorXd& start, const std::function<Pose(double)>& X_RT,
                       const std::vector<double>& stations, const LegOptions& options = {});

/// How far the tool leaves the path between the waypoints when they are joined by a cubic spline, as timing does it.
struct LegDeviation {
  double position = 0, angle = 0;        ///< [m], [rad]
};
/// Ends early when the space is cancelled.
LegDeviation splineDeviation(const ArmSpace& space, const StraightLeg& leg, const std::function<Pose(double)>& X_RT);

/// Newton steps from `start` to the pose, within the limits; false if they do not arrive (1e-7 m, 1e-7 rad).
bool solveNear(const ArmSpace& space, const Pose& X, Eigen::VectorXd& arm, int iterations = 12);

}  // namespace longarm::planning
