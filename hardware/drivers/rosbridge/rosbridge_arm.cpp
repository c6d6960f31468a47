#include "hardware/drivers/rosbridge/rosbridge_arm.h"

#include <utility>

namespace longarm::hardware {

RosbridgeArm::RosbridgeArm(std::string name, RosbridgeRobot robot, const TopicNames& topics)
    : LinkedDevice<RobotArm>(std::move(name), std::move(robot)),
      m_trajectory_topic(topics.trajectory()),
      m_stop_topic(topics.stop()) {
  link().advertise(m_trajectory_topic, rosbridge::JointTrajectoryMessage::kType);
  link().advertise(m_stop_topic, rosbridge::EmptyMessage::kType);
}

RosbridgeArm::~RosbridgeArm() { close(); }

std::shared_ptr<const JointState> RosbridgeArm::jointState() const {
  return state() == DeviceState::kClosed ? nullptr : joints().newest();
}

Result<JointState> RosbridgeArm::jointStateAt(double stamp_s) const {
  if (state() == DeviceState::kClosed) return Error{ErrorCode::kStale, name() + ": is closed"};
  auto found = joints().at(stamp_s);
  if (!found) return Error{found.error().code, name() + ": " + found.error().message};
  return found;
}

Status RosbridgeArm::send(const Horizon& horizon) {
  if (auto status = requireLinkAndActive("motion"); !status) return status;
  return runner().command("motion", [&]() -> Status {
    const auto offset = joints().offset();
    if (!offset) return {ErrorCode::kStale, name() + ": the robot's clock is not known before its first joint state"};
    if (horizon.points.empty()) return {ErrorCode::kInvalidInput, name() + ": a horizon without points"};
    const auto message = rosbridge::toMessage(horizon, horizon.start_s - *offset);
    const auto operation = rosbridge::publish(m_trajectory_topic, message, link().dialect());
    return horizon.is_stop ? link().postUrgent(operation) : link().postMotion(operation);
  });
}

Status RosbridgeArm::onActivate() {
  if (auto status = link().requireUp(); !status) return status;
  runner().recovered();
  return {};
}

// Whatever the state: a robot that somebody left moving stops, too.
Status RosbridgeArm::onStop() {
  if (!link().up()) return {};
  return link().postUrgent(rosbridge::publish(m_stop_topic, rosbridge::EmptyMessage{}));
}

void RosbridgeArm::onLinkLost() { runner().stop({}); }

}  // namespace longarm::hardware
