#include "hardware/sim/simulated_arm.h"

#include <algorithm>
#include <utility>

#include "core/require.h"
#include "core/text.h"
#include "hardware/stop_horizon.h"

namespace longarm::hardware {
namespace {

constexpr double kHistory = 5;           // [s]
constexpr std::size_t kMaxLegs = 1024;

}  // namespace

SimulatedArm::SimulatedArm(std::string name, std::vector<std::string> joints, Eigen::VectorXd start,
                           Eigen::VectorXd stop_deceleration, const Clock& clock)
    : RunnerDevice<RobotArm>(std::move(name)),
      m_joints(std::move(joints)),
      m_start(std::move(start)),
      m_stop_deceleration(std::move(stop_deceleration)),
      m_clock(clock),
      m_offset(Eigen::VectorXd::Zero(m_start.size())) {
  const auto n = static_cast<Eigen::Index>(m_joints.size());
  LONGARM_REQUIRE(n > 0 && m_start.size() == n && m_stop_deceleration.size() == n,
                  "SimulatedArm needs one start and one deceleration per joint");
}

SimulatedArm::~SimulatedArm() { close(); }

Status SimulatedArm::onOpen() {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_opened_s = m_clock.now_s();
  runner().opened();
  return {};
}

JointState SimulatedArm::stateAt(double now_s) const {
  JointState out{now_s, m_joints, m_start, Eigen::VectorXd::Zero(m_start.size())};
  for (auto it = m_legs.rbegin(); it != m_legs.rend(); ++it) {
    if (it->start_s > now_s && it + 1 != m_legs.rend()) continue;
    const TrajectoryPoint point = it->path.sample(now_s - it->start_s);
    out.positions = point.positions;
    out.velocities = point.velocities;
    if (now_s < it->start_s || now_s >= it->start_s + it->path.duration()) out.velocities.setZero();
    break;
  }
  out.positions += m_offset;
  return out;
}

std::shared_ptr<const JointState> SimulatedArm::jointState() const {
  if (state() == DeviceState::kClosed) return nullptr;
  std::lock_guard<std::mutex> lock(m_mutex);
  return std::make_shared<const JointState>(stateAt(m_frozen_s >= 0 ? m_frozen_s : m_clock.now_s()));
}

Result<JointState> SimulatedArm::jointStateAt(double stamp_s) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const double now_s = m_frozen_s >= 0 ? m_frozen_s : m_clock.now_s();
  const double oldest = std::max(m_opened_s, now_s - kHistory);
  if (state() == DeviceState::kClosed || !(stamp_s >= oldest && stamp_s <= now_s)) {
    return Error{ErrorCode::kStale, name() + ": no joint state for a time " + formatFixed(now_s - stamp_s, 3) +
                                        " s ago; the last " + formatFixed(now_s - oldest, 1) + " s are kept"};
  }
  return stateAt(stamp_s);
}

// The horizon with all joints of the arm; those it does not name stay where they are.
Result<Trajectory> SimulatedArm::completed(const Horizon& horizon, const JointState& at_start) const {
  Trajectory out{m_joints, {}};
  std::vector<Eigen::Index> places;
  for (const auto& joint : horizon.joint_names) {
    const auto it = std::find(m_joints.begin(), m_joints.end(), joint);
    if (it == m_joints.end()) return Error{ErrorCode::kNotFound, name() + ": has no joint \"" + joint + "\""};
    places.push_back(it - m_joints.begin());
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(m_start.size());
  for (const auto& p : horizon.points) {
    TrajectoryPoint full{p.t, at_start.positions - m_offset, zero, zero};
    for (std::size_t k = 0; k < places.size(); ++k) {
      const auto from = static_cast<Eigen::Index>(k);
      full.positions[places[k]] = p.positions[from];
      full.velocities[places[k]] = p.velocities[from];
      full.accelerations[places[k]] = p.accelerations[from];
    }
    out.points.push_back(std::move(full));
  }
  return out;
}

Status SimulatedArm::take(const Horizon& horizon) {
  if (horizon.points.empty()) return {ErrorCode::kInvalidInput, name() + ": a horizon without points"};
  std::lock_guard<std::mutex> lock(m_mutex);
  auto path = completed(horizon, stateAt(horizon.start_s));
  if (!path) return path.error();
  while (!m_legs.empty() && m_legs.back().start_s >= horizon.start_s) m_legs.pop_back();
  m_legs.push_back({std::move(*path), horizon.start_s});
  if (m_legs.size() > kMaxLegs) m_legs.pop_front();
  ++m_received;
  return {};
}

Status SimulatedArm::send(const Horizon& horizon) {
  return runner().command("motion", [&] { return take(horizon); });
}

Status SimulatedArm::onStop() {
  std::lock_guard<std::mutex> lock(m_mutex);
  const double now_s = m_clock.now_s();
  if (m_legs.empty()) return {};
  const Leg& last = m_legs.back();
  Horizon brake = brakeAlong(last.path, now_s - last.start_s, m_stop_deceleration);
  if (brake.points.empty()) return {};
  m_legs.push_back({{m_joints, std::move(brake.points)}, now_s});
  return {};
}

void SimulatedArm::injectFault(const std::string& why) {
  (void)onStop();
  runner().fault({ErrorCode::kInternal, why});
}

void SimulatedArm::setOffset(const Eigen::VectorXd& offset) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_offset = offset;
}

void SimulatedArm::freeze(bool frozen) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_frozen_s = frozen ? m_clock.now_s() : -1;
}

std::uint64_t SimulatedArm::horizonsReceived() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_received;
}

}  // namespace longarm::hardware
