#include "hardware/drivers/rosbridge/rosbridge_imu.h"

#include <utility>

namespace longarm::hardware {

RosbridgeImu::RosbridgeImu(std::string name, RosbridgeRobot robot, std::string topic)
    : LinkedDevice<Imu>(std::move(name), std::move(robot)), m_topic(std::move(topic)) {}

RosbridgeImu::~RosbridgeImu() { close(); }

Status RosbridgeImu::onOpen() {
  m_subscription = listen<rosbridge::ImuMessage>(m_topic, [this](const auto& message, double received_s) { return take(message, received_s); });
  return LinkedDevice<Imu>::onOpen();
}

Status RosbridgeImu::onClose() {
  link().unsubscribe(m_subscription);
  return LinkedDevice<Imu>::onClose();
}

Status RosbridgeImu::take(const rosbridge::ImuMessage& message, double received_s) {
  auto attitude = rosbridge::toAttitude(message);
  if (!attitude) return attitude.error();
  attitude->stamp_s = onOurClock(attitude->stamp_s, received_s);
  m_newest.publish(std::move(*attitude));
  return {};
}

}  // namespace longarm::hardware
