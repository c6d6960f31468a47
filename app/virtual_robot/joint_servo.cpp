#include "app/virtual_robot/joint_servo.h"

#include <algorithm>
#include <cmath>

namespace longarm::virtual_robot {

JointServo::JointServo(double start, double lower, double upper, double max_velocity, double max_acceleration)
    : m_position(start),
      m_target(start),
      m_lower(lower),
      m_upper(upper),
      m_max_velocity(max_velocity),
      m_max_acceleration(max_acceleration) {}

void JointServo::moveTo(double target) { m_target = std::clamp(target, m_lower, m_upper); }

void JointServo::holdAt(double position) {
  m_position = m_target = position;
  m_velocity = 0;
}

void JointServo::step(double seconds) {
  const double way = m_target - m_position;
  // Fastest speed from which the rest of the way is enough to brake, seen one tick ahead.
  const double half = 0.5 * m_max_acceleration * seconds;
  const double braking = std::sqrt(half * half + 2 * m_max_acceleration * std::abs(way)) - half;
  const double wanted = std::copysign(std::min({braking, m_max_velocity, std::abs(way) / seconds}), way);
  const double change = m_max_acceleration * seconds;
  m_velocity = std::clamp(wanted, m_velocity - change, m_velocity + change);
  m_velocity = std::clamp(m_velocity, -m_max_velocity, m_max_velocity);
  m_position = std::clamp(m_position + m_velocity * seconds, m_lower, m_upper);
  if (std::abs(m_target - m_position) < 1e-9) m_position = m_target;
  if (m_position == m_target && std::abs(m_velocity) <= change) m_velocity = 0;
}

}  // namespace longarm::virtual_robot
