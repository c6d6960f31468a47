#pragma once

/// @file
/// The part of an arm's limits that a planned motion may use at speed 1, so that faster playback and a stop inside the
/// horizon stay legal.

#include <Eigen/Core>

#include "core/motion.h"

namespace longarm::planning {

/// What playing back a plan needs left over.
struct PlaybackReserve {
  double max_rate = 2;                   ///< Playback factor that keeps the velocity limits.
  double stop_s = 0.12;                  ///< Braking time: the horizon (0.19 s) less a tick, a point and the ramps.
  double stop_rate = 1.25;               ///< Playback factor from which a stop takes no longer, wherever the arm is.
};

/// Bounds of planned motion at speed 1.
struct NominalLimits {
  Eigen::VectorXd max_velocity;          ///< [rad/s or m/s]
  Eigen::VectorXd max_acceleration;      ///< [rad/s^2 or m/s^2]
};

/// Velocity <= min(v/2, 0.089 a [1/s] at the defaults) and acceleration <= a/8, with v and a the limits given.
///
/// Played at rate r = d tau/dt a joint accelerates by q'' r^2 + q' r' (primes by tau).  With |q''| <= a/8 the first
/// term takes at most a r^2/8 of the limit a, whatever its sign; braking may use the rest:
/// |r'| = (1 - r^2/8)/beta when |q'| <= beta a.  From r = 1.25 that rests after
/// beta sqrt(8) atanh(1.25/sqrt(8)) = 1.342 beta, so beta = stop_s / 1.342 stops inside stop_s on the path, from any
/// point of the trajectory, in either direction, with no joint above its acceleration limit.  The player goes faster where
/// the joints are slower than that.
NominalLimits nominalLimits(const MotionLimits& limits, const PlaybackReserve& reserve = {});

}  // namespace longarm::planning
