#include "session/controllers/jog_controller.h"

#include <algorithm>
#include <utility>

namespace longarm::session {

namespace {

constexpr int kRepeat_ms = 50;         // a command lives for 200 ms

}  // namespace

JogController::JogController(QObject* parent) : QObject(parent) {
  m_timer.setInterval(kRepeat_ms);
  m_timer.setTimerType(Qt::PreciseTimer);
  connect(&m_timer, &QTimer::timeout, this, &JogController::send);
}

void JogController::setRobot(Send send, Release release) {
  this->release();
  m_send = std::move(send);
  m_release = std::move(release);
}

void JogController::setFrame(planning::JogFrame frame, const QString& camera) {
  if (frame != m_frame || camera != m_camera) release();
  m_frame = frame;
  m_camera = camera;
}

void JogController::setSpeed(double share) { m_speed = std::clamp(share, 0.02, 1.0); }

planning::JogCommand JogController::commandOf(int axis, int way) const {
  planning::JogCommand command;
  command.frame = m_frame;
  command.camera = m_camera.toStdString();
  command.speed = m_speed;
  command.through_contact = m_through_contact;
  if (m_frame == planning::JogFrame::kJoint) {
    command.joint = axis;
    command.turn = way;
  } else {
    (axis < 3 ? command.linear : command.angular)[axis % 3] = way;
  }
  return command;
}

void JogController::hold(int axis, int way) {
  if (axis < 0 || (m_frame != planning::JogFrame::kJoint && axis > 5)) return;
  m_held = {axis, way > 0 ? 1 : -1};
  m_timer.start();
  Q_EMIT changed();
  send();
}

void JogController::release() {
  m_timer.stop();
  if (!m_held) return;
  m_held.reset();
  if (m_release) m_release();
  Q_EMIT changed();
}

void JogController::send() {
  if (!m_held) return;
  const Status status = m_send ? m_send(commandOf(m_held->first, m_held->second))
                               : Status(ErrorCode::kDisconnected, "Jog: no robot is connected.");
  if (status) return;
  release();
  Q_EMIT refused(QString::fromStdString(status.error().message));
}

}  // namespace longarm::session
