#pragma once

/// @file
/// Motion of a mobile base on the ground: velocity commands, odometry, and how far it has gone.

#include "core/pose.h"
#include "core/result.h"

namespace longarm {

/// Velocity of the base in its own frame.
struct BaseTwist {
  double forward = 0, left = 0;  ///< [m/s]
  double turn = 0;               ///< About up, left positive [rad/s].

  bool still() const { return forward == 0 && left == 0 && turn == 0; }
  /// Slower than odometry can tell from standing: 5 mm/s and 0.01 rad/s.
  bool standing() const;
};

/// What a base may be told; every value > 0 where it can move at all.
struct BaseLimits {
  double max_speed = 0.3;              ///< [m/s]
  double max_turn = 0.5;               ///< [rad/s]
  double max_acceleration = 0.5;       ///< [m/s^2]
  double max_turn_acceleration = 1.0;  ///< [rad/s^2]
  bool sideways = false;               ///< Whether it can move to its left and right.
};

/// Odometry: where the base is in its odometry frame, which is the base's own frame where it started.
struct BaseState {
  double stamp_s = 0;   ///< On the console's monotonic clock [s].
  double x = 0, y = 0;  ///< [m]
  double yaw = 0;       ///< [rad]
  BaseTwist twist;
};
/// X_OB, base in odometry frame.
Pose poseOf(const BaseState& state);

/// How far apart two places of the base are.
struct BaseShift {
  double way = 0;   ///< [m]
  double turn = 0;  ///< 0 ... pi [rad]
};
BaseShift shiftBetween(const BaseState& a, const BaseState& b);
/// Whether what was measured at `a` still holds at `b`: at most 10 mm and 0.5 degrees apart.
bool samePlace(const BaseState& a, const BaseState& b);

/// @returns kInvalidInput for numbers that are not finite, kOutOfLimits naming value and limit; a base that
/// cannot go
///   sideways refuses `left`.
Status checkTwist(const BaseTwist& twist, const BaseLimits& limits);
/// The twist nearer to `wanted` that the accelerations allow after `seconds`.
BaseTwist rampTowards(const BaseTwist& now, const BaseTwist& wanted, const BaseLimits& limits,
                      double seconds);

}  // namespace longarm
