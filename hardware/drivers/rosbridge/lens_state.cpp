#include "hardware/drivers/rosbridge/lens_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/log.h"
#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr double kHolds_s = 1.0;         // Told at 5 Hz: what was told last still holds.
constexpr double kTravel_s = 10;         // No lens takes longer from end to end.
constexpr double kReached = 0.002;

}  // namespace

LensState::LensState(std::string camera, std::string what, std::string command_topic, std::string state_topic)
    : m_camera(std::move(camera)),
      m_what(std::move(what)),
      m_command_topic(std::move(command_topic)),
      m_state_topic(std::move(state_topic)) {}

void LensState::connect(Connection& link) {
  rosbridge::Subscribe wish;
  wish.topic = m_state_topic;
  wish.type = rosbridge::Float64Message::kType;
  m_subscription = link.subscribe(std::move(wish), [this](const auto& message, double received_s) {
    return take(message, received_s);
  });
}

void LensState::disconnect(Connection& link) {
  link.unsubscribe(std::exchange(m_subscription, 0));
  std::lock_guard<std::mutex> lock(m_mutex);
  m_history.clear();
  m_newest_s = -1;
}

Status LensState::take(const rosbridge::Publish& message, double received_s) {
  const auto read = rosbridge::readAs<rosbridge::Float64Message>(message.message);
  if (!read) return read.error();
  if (!(read->data >= 0 && read->data <= 1)) {
    return {ErrorCode::kInvalidInput, m_what + " " + formatNumber(read->data) + " is not within 0 ... 1"};
  }
  std::lock_guard<std::mutex> lock(m_mutex);
  m_newest = read->data;
  m_newest_s = received_s;
  (void)m_history.add({received_s, {m_what}, Eigen::VectorXd::Constant(1, read->data), {}});
  return {};
}

Status LensState::command(Connection& link, double wanted, double now_s) {
  if (!(wanted <= 1)) {
    return {ErrorCode::kOutOfLimits, m_camera + ": " + m_what + " " + formatNumber(wanted) + " is not within 0 ... 1"};
  }
  if (auto status = link.postMotion(rosbridge::publish(m_command_topic, rosbridge::Float64Message{wanted})); !status) return status;
  std::lock_guard<std::mutex> lock(m_mutex);
  m_wanted = wanted;
  m_commanded_s = now_s;
  return {};
}

Result<double> LensState::newest() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_newest_s < 0) return Error{ErrorCode::kStale, m_camera + " has not told its " + m_what + " yet"};
  return m_newest;
}

Result<double> LensState::at(double stamp_s) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_newest_s < 0) return Error{ErrorCode::kStale, m_camera + " has not told its " + m_what + " yet"};
  const double late_s = stamp_s - m_newest_s;
  if (late_s >= 0 && late_s <= kHolds_s) return m_newest;
  const auto then = m_history.at(stamp_s);
  if (!then) {
    return Error{ErrorCode::kStale, m_camera + " did not tell its " + m_what + " for the time of that picture; look at the link"};
  }
  return then->positions[0];
}

void LensState::halt(Connection& link, double now_s) {
  double here = 0;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    const bool moves = m_wanted >= 0 && now_s - m_commanded_s < kTravel_s && std::abs(m_wanted - m_newest) > kReached;
    if (!link.up() || m_newest_s < 0 || !moves) return;
    here = m_newest;
    m_wanted = here;
  }
  if (const auto sent = link.postUrgent(rosbridge::publish(m_command_topic, rosbridge::Float64Message{here})); !sent) {
    logLine(LogLevel::kWarning, "longarm.hardware.rosbridge", m_camera + ": stopping the " + m_what + ": " + sent.error().message);
  }
}

}  // namespace longarm::hardware
