#pragma once

/// @file
/// JointServo: one joint that goes where it is told at a limited rate.

namespace longarm::virtual_robot {

/// Accelerates, runs and brakes so that it arrives at rest.  Thread-compatible.
class JointServo {
 public:
  /// @param max_velocity, max_acceleration  > 0 [rad/s, rad/s^2 or m/s, m/s^2]
  JointServo(double start, double lower, double upper, double max_velocity, double max_acceleration);

  /// The target is kept within the limits.
  void moveTo(double target);
  /// One tick.  The velocity never passes max_velocity.
  void step(double seconds);
  /// Stands still here, whatever the target was.
  void holdAt(double position);

  double position() const { return m_position; }
  double velocity() const { return m_velocity; }
  double target() const { return m_target; }

 private:
  double m_position, m_velocity = 0, m_target;
  double m_lower, m_upper, m_max_velocity, m_max_acceleration;
};

}  // namespace longarm::virtual_robot
