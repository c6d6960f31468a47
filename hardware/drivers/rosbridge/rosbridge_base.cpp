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
  rosbridge::Subscribe what;
  what.topic = m_odometry_topic;
  what.type = rosbridge::OdometryMessage::kType;
  m_subscription = link().subscribe(std::move(what), [this](const auto& message, double received_s) {
    if (auto status = take(message, received_s); !status)
      runner().trouble(status.error());  // no other device's matter
    return Status();
  });
  return LinkedDevice<MobileBase>::onOpen();
}

Status RosbridgeBase::onClose() {
  link().unsubscribe(m_subscription);
  return LinkedDevice<MobileBase>::onClose();
}

// Its stamps are on the robot's clock, whose offset the joint states tell; before the first of them arrival
// counts.
Status RosbridgeBase::take(const rosbridge::Publish& message, double received_s) {
  const auto read = rosbridge::readAs<rosbridge::OdometryMessage>(message.message);
  if (!read) return read.error();
  auto state = rosbridge::toBaseState(*read);
  if (!state) return state.error();
  const auto offset = joints().offset();
  state->stamp_s = offset ? state->stamp_s + *offset : received_s;
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
