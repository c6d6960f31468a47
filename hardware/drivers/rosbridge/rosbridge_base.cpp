#include "hardware/drivers/rosbridge/rosbridge_base.h"

#include <utility>

namespace longarm::hardware {

RosbridgeBase::RosbridgeBase(std::string name, RosbridgeRobot robot, BaseLimits limits,
                             const TopicNames& topics)
    : LinkedDevice<MobileBase>(std::move(name), std::move(robot)),
      m_limits(limits),
      m_command_topic(topics.driveCommand()),
      m_odometry_topic(topics.odometry()) {
  link().advertise(m_command_topic, rosbridge::TwistMessage::kType);
}

RosbridgeBase::~RosbridgeBase() { close(); }

Status RosbridgeBase::onOpen() {
  m_subscription = listen<rosbridge::OdometryMessage>(
      m_odometry_topic, [this](const auto& message, double received_s) { return take(message, received_s); });
  return LinkedDevice<MobileBase>::onOpen();
}

Status RosbridgeBase::onClose() {
  link().unsubscribe(m_subscription);
  return LinkedDevice<MobileBase>::onClose();
}

Status RosbridgeBase::take(const rosbridge::OdometryMessage& message, double received_s) {
  auto state = rosbridge::toBaseState(message);
  if (!state) return state.error();
  state->stamp_s = onOurClock(state->stamp_s, received_s);
  m_newest.publish(std::move(*state));
  return {};
}

Status RosbridgeBase::drive(const BaseTwist& twist) {
  if (auto status = requireLinkAndActive("driving"); !status) return status;
  return runner().command("driving", [&]() -> Status {
    if (auto status = checkTwist(twist, m_limits); !status) return status;
    const auto operation = rosbridge::publish(m_command_topic, rosbridge::toMessage(twist), link().dialect());
    // Zero must not be dropped as too late.
    return twist.still() ? link().postUrgent(operation) : link().postMotion(operation);
  });
}

Status RosbridgeBase::onStop() {
  if (!link().up()) return {};
  return link().postUrgent(rosbridge::publish(m_command_topic, rosbridge::TwistMessage{}, link().dialect()));
}

}  // namespace longarm::hardware
