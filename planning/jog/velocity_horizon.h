#pragma once

/// @file
/// A horizon that changes the joints' velocities towards wanted ones and then brakes to rest.

#include <vector>

#include <Eigen/Core>

#include "core/motion.h"

namespace longarm::planning {

struct VelocityHorizonOptions {
  double commit_s = 0.04;          ///< Keeps to the motion in force for so long: it may arrive that late.
  double change_s = 0.06;          ///< Then the velocities change for so long ...
  double longest_braking_s = 0.24; ///< ... and at most so long they fall to zero.
  double spacing_s = 0.02;         ///< Of the points.
  double share = 0.8;              ///< Of velocity and acceleration limits that is used.
};

/// The fastest velocities along `wanted` [rad/s or m/s] from which every joint can brake in time.  Pure function.
Eigen::VectorXd brakeable(const Eigen::VectorXd& wanted, const MotionLimits& limits, const VelocityHorizonOptions& options);

/// What follows `in_force` (points sampled at t = 0 ... commit_s, ending at the state to go on from): velocities run
/// towards `wanted` as far as the accelerations allow, all joints in proportion, then to zero.  Velocities are cubics
/// of time, so the points' quintic interpolation is exact.  Positions are not checked against limits.
/// @pre in_force is not empty, wanted is brakeable().  Pure function.
std::vector<TrajectoryPoint> velocityHorizon(const std::vector<TrajectoryPoint>& in_force, const Eigen::VectorXd& wanted,
                                             const MotionLimits& limits, const VelocityHorizonOptions& options);

}  // namespace longarm::planning
