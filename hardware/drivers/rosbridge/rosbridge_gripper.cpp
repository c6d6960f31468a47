#include "hardware/drivers/rosbridge/rosbridge_gripper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr double kStill = 0.001;         // Slower is standing still [m/s or rad/s].

}  // namespace

RosbridgeGripper::RosbridgeGripper(std::string name, RosbridgeRobot robot, GripperSettings settings,
                                   const TopicNames& topics)
    : LinkedDevice<Gripper>(std::move(name), std::move(robot)),
      m_settings(std::move(settings)),
      m_command_topic(topics.gripperCommand()),
      m_holding_topic(topics.gripperHolding()) {
  link().advertise(m_command_topic, rosbridge::Float64Message::kType);
}

RosbridgeGripper::~RosbridgeGripper() { close(); }

Status RosbridgeGripper::onOpen() {
  m_subscription = listen<rosbridge::BoolMessage>(m_holding_topic, [this](const auto& message, double) {
    m_holding = message.data;
    return Status();
  });
  return LinkedDevice<Gripper>::onOpen();
}

Status RosbridgeGripper::onClose() {
  link().unsubscribe(m_subscription);
  m_holding = false;
  return LinkedDevice<Gripper>::onClose();
}

Status RosbridgeGripper::setOpening(double position) {
  if (auto status = requireLinkAndActive("moving the fingers"); !status) return status;
  return runner().command("moving the fingers", [&]() -> Status {
    const auto [low, high] = std::minmax(m_settings.closed, m_settings.open);
    if (!(position >= low && position <= high)) {
      return {ErrorCode::kOutOfLimits, name() + ": opening " + formatNumber(position) + " is not within " +
                                           formatNumber(low) + " ... " + formatNumber(high)};
    }
    return link().postMotion(rosbridge::publish(m_command_topic, rosbridge::Float64Message{position}));
  });
}

double RosbridgeGripper::position() const { return joints().position(m_settings.joint).valueOr(0); }

Status RosbridgeGripper::onStop() {
  const auto here = joints().position(m_settings.joint);
  const bool moves = std::abs(joints().velocity(m_settings.joint)) > kStill;
  if (!link().up() || !here || m_holding || !moves) return {};
  return link().postUrgent(rosbridge::publish(m_command_topic, rosbridge::Float64Message{*here}));
}

}  // namespace longarm::hardware
