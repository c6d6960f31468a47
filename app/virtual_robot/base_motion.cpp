#include "app/virtual_robot/base_motion.h"

#include <cmath>

namespace longarm::virtual_robot {
namespace {

// Along the arc of a constant velocity.
void advance(BaseState& state, const BaseTwist& twist, double now_s, double seconds) {
  const double half = state.yaw + 0.5 * seconds * twist.turn;
  state.x += seconds * (std::cos(half) * twist.forward - std::sin(half) * twist.left);
  state.y += seconds * (std::sin(half) * twist.forward + std::cos(half) * twist.left);
  state.yaw += seconds * twist.turn;
  state.twist = twist;
  state.stamp_s = now_s;
}

}  // namespace

BaseMotion::BaseMotion(const BaseLimits& limits, double forward_scale, double turn_scale)
    : m_limits(limits), m_forward_scale(forward_scale), m_turn_scale(turn_scale) {}

Status BaseMotion::command(const BaseTwist& twist, double now_s) {
  if (auto status = checkTwist(twist, m_limits); !status) return status;
  m_wanted = twist;
  m_commanded_s = now_s;
  return {};
}

void BaseMotion::step(double now_s, double seconds) {
  if (now_s - m_commanded_s > kDeadline_s) halt();
  const BaseTwist twist = rampTowards(m_truth.twist, m_wanted, m_limits, seconds);
  advance(m_truth, twist, now_s, seconds);
  advance(m_odometry,
          {m_forward_scale * twist.forward, m_forward_scale * twist.left, m_turn_scale * twist.turn}, now_s,
          seconds);
}

}  // namespace longarm::virtual_robot
