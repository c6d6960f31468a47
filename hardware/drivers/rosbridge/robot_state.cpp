#include "hardware/drivers/rosbridge/robot_state.h"

#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr double kSpeedSpan_s = 0.1;

}  // namespace

RobotState::RobotState(std::shared_ptr<Connection> link, const std::string& topic) : m_link(std::move(link)) {
  rosbridge::Subscribe what;
  what.topic = topic;
  what.type = rosbridge::JointStateMessage::kType;
  m_subscription = m_link->subscribe(std::move(what), [this](const auto& message, double received_s) {
    return take(message, received_s);
  });
}

RobotState::~RobotState() { m_link->unsubscribe(m_subscription); }

Status RobotState::take(const rosbridge::Publish& message, double received_s) {
  const auto read = rosbridge::readAs<rosbridge::JointStateMessage>(message.message);
  if (!read) return read.error();
  auto state = rosbridge::toJointState(*read);
  if (!state) return state.error();
  if (state->names.empty()) return {ErrorCode::kInvalidInput, "names no joint"};
  std::lock_guard<std::mutex> lock(m_mutex);
  const auto before = m_history.newest();
  const bool set_back = before && state->stamp_s < before->stamp_s - 1;
  if (set_back) m_offset.reset();        // the robot started anew
  m_offset.add(state->stamp_s, received_s);
  JointState ours = *state;
  if (!m_history.add(std::move(*state))) return {};
  ours.stamp_s += *m_offset.offset();
  m_newest.publish(std::move(ours));
  return {};
}

Result<JointState> RobotState::at(double stamp_s) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const auto offset = m_offset.offset();
  auto state = m_history.at(stamp_s - offset.value_or(0));
  if (state) state->stamp_s = stamp_s;
  return state;
}

std::optional<double> RobotState::offset() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_offset.offset();
}

Result<double> RobotState::position(const std::string& joint) const {
  const auto state = newest();
  if (!state) return Error{ErrorCode::kStale, "no joint state has come from the robot yet"};
  return state->position(joint);
}

double RobotState::velocity(const std::string& joint) const {
  const auto state = newest();
  if (!state) return 0;
  for (std::size_t i = 0; i < state->names.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (state->names[i] != joint) continue;
    if (k < state->velocities.size()) return state->velocities[k];
    const auto before = at(state->stamp_s - kSpeedSpan_s);
    const auto then = before ? before->position(joint) : Result<double>(before.error());
    return then ? (state->positions[k] - *then) / kSpeedSpan_s : 0.0;
  }
  return 0;
}

}  // namespace longarm::hardware
