#include "hardware/sim/simulated_base.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace longarm::hardware {

SimulatedBase::SimulatedBase(std::string name, BaseLimits limits, const Clock& clock)
    : RunnerDevice<MobileBase>(std::move(name)), m_limits(limits), m_clock(clock) {
  m_state.stamp_s = clock.now_s();
}

SimulatedBase::~SimulatedBase() { close(); }

// Along the arc of the velocity in force; `m_mutex` is held.
void SimulatedBase::advance() const {
  const double now_s = m_clock.now_s();
  const double until = std::min(now_s, m_commanded_s + kDeadline_s), h = until - m_state.stamp_s;
  if (h > 0 && !m_state.twist.still()) {
    const double half = m_state.yaw + 0.5 * h * m_state.twist.turn;
    m_state.x += h * (std::cos(half) * m_state.twist.forward - std::sin(half) * m_state.twist.left);
    m_state.y += h * (std::sin(half) * m_state.twist.forward + std::cos(half) * m_state.twist.left);
    m_state.yaw += h * m_state.twist.turn;
  }
  if (now_s > m_commanded_s + kDeadline_s) m_state.twist = {};
  m_state.stamp_s = now_s;
}

std::shared_ptr<const BaseState> SimulatedBase::odometry() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_frozen) return m_frozen;
  advance();
  return std::make_shared<const BaseState>(m_state);
}

Status SimulatedBase::drive(const BaseTwist& twist) {
  return runner().command("driving", [&]() -> Status {
    if (auto status = checkTwist(twist, m_limits); !status) return status;
    std::lock_guard<std::mutex> lock(m_mutex);
    advance();
    m_state.twist = twist;
    m_commanded_s = m_clock.now_s();
    return {};
  });
}

void SimulatedBase::freeze(bool on) {
  const auto now = on ? odometry() : nullptr;
  std::lock_guard<std::mutex> lock(m_mutex);
  m_frozen = now;
}

void SimulatedBase::place(double x, double y, double yaw) {
  std::lock_guard<std::mutex> lock(m_mutex);
  advance();
  m_state.x = x;
  m_state.y = y;
  m_state.yaw = yaw;
}

void SimulatedBase::injectFault(const std::string& why) {
  (void)onStop();
  runner().fault({ErrorCode::kInternal, why});
}

Status SimulatedBase::onStop() {
  std::lock_guard<std::mutex> lock(m_mutex);
  advance();
  m_state.twist = {};
  return {};
}

}  // namespace longarm::hardware
