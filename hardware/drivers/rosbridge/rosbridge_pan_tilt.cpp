#include "hardware/drivers/rosbridge/rosbridge_pan_tilt.h"

#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr double kStill = 0.01;          // Slower is standing still [rad/s].
constexpr double kReached = 0.002;       // [rad]
constexpr double kStart_s = 0.3;         // From a command to motion that can be measured.

}  // namespace

RosbridgePanTilt::RosbridgePanTilt(std::string name, RosbridgeRobot robot, PanTiltSettings settings,
                                   const TopicNames& topics)
    : LinkedDevice<PanTilt>(name, std::move(robot)),
      m_settings(std::move(settings)),
      m_topic(topics.panTiltCommand(name)) {
  link().advertise(m_topic, rosbridge::JointTrajectoryMessage::kType);
}

RosbridgePanTilt::~RosbridgePanTilt() { close(); }

rosbridge::Operation RosbridgePanTilt::command(double pan, double tilt) const {
  rosbridge::JointTrajectoryMessage message;
  message.joint_names = {m_settings.pan.joint, m_settings.tilt.joint};
  message.points.push_back({{pan, tilt}, {}, {}, 0});
  return rosbridge::publish(m_topic, message, link().dialect());
}

Status RosbridgePanTilt::moveTo(double pan, double tilt) {
  if (auto status = requireLinkAndActive("aiming"); !status) return status;
  return runner().command("aiming", [&]() -> Status {
    for (const auto& [axis, angle] : {std::pair(&m_settings.pan, pan), std::pair(&m_settings.tilt, tilt)}) {
      if (angle >= axis->lower && angle <= axis->upper) continue;
      return {ErrorCode::kOutOfLimits, name() + ": " + formatNumber(angle) + " rad for " + axis->joint +
                                           " is not within " + formatNumber(axis->lower) + " ... " +
                                           formatNumber(axis->upper) + " rad"};
    }
    if (auto status = link().postMotion(command(pan, tilt)); !status) return status;
    std::lock_guard<std::mutex> lock(m_mutex);
    m_wanted_pan = pan;
    m_wanted_tilt = tilt;
    m_commanded_s = robot().clock->now_s();
    return {};
  });
}

bool RosbridgePanTilt::turns() const {
  return std::abs(joints().velocity(m_settings.pan.joint)) > kStill ||
         std::abs(joints().velocity(m_settings.tilt.joint)) > kStill;
}

bool RosbridgePanTilt::moving() const {
  if (turns()) return true;
  const double now_s = robot().clock->now_s();
  const double here_pan = pan(), here_tilt = tilt();
  std::lock_guard<std::mutex> lock(m_mutex);
  return now_s - m_commanded_s < kStart_s && (std::abs(m_wanted_pan - here_pan) > kReached ||
                                              std::abs(m_wanted_tilt - here_tilt) > kReached);
}

// There is no stop for it on the link: it is sent to where it is.
Status RosbridgePanTilt::onStop() {
  if (!link().up() || !moving()) return {};
  const auto here_pan = joints().position(m_settings.pan.joint);
  const auto here_tilt = joints().position(m_settings.tilt.joint);
  if (!here_pan || !here_tilt) return {};
  return link().postUrgent(command(*here_pan, *here_tilt));
}

}  // namespace longarm::hardware
