#include "session/controllers/jog_controller.h"

#include <algorithm>
#include <utility>

namespace longarm::session {

JogController::JogController(QObject* parent) : DeadManSwitch(parent) {}

void JogController::setRobot(Send send, Release release) {
  setRelease(std::move(release));
  m_send = std::move(send);
}

void JogController::setFrame(planning::JogFrame frame, const QString& camera) {
  if (frame != m_frame || camera != m_camera) letGo();
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
  repeat();
}

Status JogController::send() {
  if (!m_send) return {ErrorCode::kDisconnected, "Jog: no robot is connected."};
  return m_send(commandOf(m_held->first, m_held->second));
}

}  // namespace longarm::session
