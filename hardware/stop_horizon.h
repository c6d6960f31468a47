#pragma once

/// @file
/// Braking along the path: the stop horizon of MotionGate, also used by the simulated arm.

#include <Eigen/Core>

#include "core/motion.h"

namespace longarm::hardware {

/// The horizon that brings motion along `path` to rest as fast as `stop_deceleration` (n, [rad/s^2 or m/s^2])
/// allows, starting at path time `elapsed_s` with the path's own speed.  It follows the path exactly: with
/// q(s), ds/dt = r, each joint's acceleration is q'' r^2 + q' dr/dt, and dr/dt is the most negative value that
/// keeps all joints within their deceleration.  Points every 4 ms, t from 0, last velocity zero.
/// Empty points when the path is over at `elapsed_s`.  Sequence, owner and start_s are the caller's.
/// Pure function.  @pre path is well formed (sizes, increasing t)
Horizon brakeAlong(const Trajectory& path, double elapsed_s, const Eigen::VectorXd& stop_deceleration);

}  // namespace longarm::hardware
