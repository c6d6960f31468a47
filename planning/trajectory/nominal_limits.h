#pragma once

/// @file
/// The part of an arm's limits that a planned motion may use at speed 1, so that 2x and a stop inside the horizon
/// stay legal.

#include <Eigen/Core>

#include "core/motion.h"

namespace longarm::planning {

/// What playing back a plan needs left over.
struct PlaybackReserve {
  double max_rate = 2;                   ///< Fastest playback factor.
  double stop_s = 0.22;                  ///< Longest braking time: the horizon (0.3 s) less a tick and a point.
};

/// Bounds of planned motion at speed 1.
struct NominalLimits {
  Eigen::VectorXd max_velocity;          ///< [rad/s or m/s]
  Eigen::VectorXd max_acceleration;      ///< [rad/s^2 or m/s^2]
};

/// Velocity <= min(v/2, 0.088 a [1/s] at the defaults) and acceleration <= a/8, with v and a the limits given.
///
/// Played at rate r = d tau/dt a joint accelerates by q'' r^2 + q' r' (primes by tau).  With |q''| <= a/8 the first
/// term takes at most a r^2/8 of the limit a, whatever its sign; braking may use the rest:
/// |r'| = (1 - r^2/8)/beta when |q'| <= beta a.  From r = 2 that rests after
/// beta sqrt(8) atanh(2/sqrt(8)) = 2.493 beta, so beta = stop_s / 2.493 stops inside stop_s on the path, from any
/// point of the trajectory, in either direction, with no joint above its acceleration limit.
NominalLimits nominalLimits(const MotionLimits& limits, const PlaybackReserve& reserve = {});

}  // namespace longarm::planning
