#include "session/controllers/drive_controller.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace longarm::session {

namespace {

constexpr int kRepeat_ms = 50;  // a command lives for 200 ms

}  // namespace

DriveController::DriveController(QObject* parent) : QObject(parent) {
  m_timer.setInterval(kRepeat_ms);
  m_timer.setTimerType(Qt::PreciseTimer);
  connect(&m_timer, &QTimer::timeout, this, &DriveController::send);
}

void DriveController::setRobot(Send send, Release release, const BaseLimits& limits) {
  releaseAll();
  m_send = std::move(send);
  m_release = std::move(release);
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
  if (!m_held.insert(way).second) return;
  m_timer.start();
  Q_EMIT changed();
  send();
}

void DriveController::release(Way way) {
  if (m_held.erase(way) == 0) return;
  if (m_held.empty()) {
    m_timer.stop();
    if (m_release) m_release();
  }
  Q_EMIT changed();
}

void DriveController::releaseAll() {
  m_timer.stop();
  if (m_held.empty()) return;
  m_held.clear();
  if (m_release) m_release();
  Q_EMIT changed();
}

void DriveController::send() {
  if (m_held.empty()) return;
  const Status status =
      m_send ? m_send(wanted()) : Status(ErrorCode::kDisconnected, "Drive: no robot is connected.");
  if (status) return;
  releaseAll();
  Q_EMIT refused(QString::fromStdString(status.error().message));
}

}  // namespace longarm::session
