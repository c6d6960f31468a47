#pragma once

/// @file
/// BaseMotion: the virtual robot's tracks: where the base really is, and where it believes to be.

#include "core/base_motion.h"
#include "core/result.h"

namespace longarm::virtual_robot {

/// Follows the last velocity within its accelerations and brakes when none has come for kDeadline_s.
/// Thread-compatible.
class BaseMotion {
 public:
  static constexpr double kDeadline_s = 0.25;

  /// @param forward_scale, turn_scale  What the odometry makes of a metre and of a radian.
  BaseMotion(const BaseLimits& limits, double forward_scale, double turn_scale);

  /// @returns as checkTwist().
  Status command(const BaseTwist& twist, double now_s);
  void halt() { m_wanted = {}; }
  void step(double now_s, double seconds);

  const BaseState& truth() const { return m_truth; }
  const BaseState& odometry() const { return m_odometry; }
  bool moving() const { return !m_truth.twist.still(); }

 private:
  BaseLimits m_limits;
  double m_forward_scale, m_turn_scale;
  BaseTwist m_wanted;
  double m_commanded_s = -1e9;
  BaseState m_truth, m_odometry;
};

}  // namespace longarm::virtual_robot
