#include "session/controllers/drive_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace longarm::session {

DriveController::DriveController(QObject* parent) : DeadManSwitch(parent) {}

void DriveController::setRobot(Send send, Release release, const BaseLimits& limits) {
  setRelease(std::move(release));
  m_send = std::move(send);
  m_limits = limits;
}

void DriveController::setSpeed(double share) { m_speed = std::clamp(share, 0.05, 1.0); }

BaseTwist DriveController::wanted() const {
  const auto side = [this](Way plus, Way minus) {
    return (m_held.count(plus) != 0 ? 1 : 0) - (m_held.count(minus) != 0 ? 1 : 0);
  };
  const double forward = side(Way::kForward, Way::kBack), left = side(Way::kLeft, Way::kRight);
  const double cap = m_speed * m_limits.max_speed / std::max(1.0, std::hypot(forward, left));
  return {cap * forward, m_limits.sideways ? cap * left : 0,
          m_speed * m_limits.max_turn * side(Way::kTurnLeft, Way::kTurnRight)};
}

void DriveController::hold(Way way) {
  if (m_held.insert(way).second) repeat();
}

void DriveController::release(Way way) {
  if (m_held.count(way) == 0) return;
  if (m_held.size() == 1) return letGo();
  m_held.erase(way);
  Q_EMIT changed();
}

Status DriveController::send() {
  return m_send ? m_send(wanted()) : Status(ErrorCode::kDisconnected, "Drive: no robot is connected.");
}

}  // namespace longarm::session
