#include "app/virtual_robot/arm_motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/require.h"
#include "core/text.h"
#include "hardware/stop_horizon.h"

namespace longarm::virtual_robot {
namespace {

constexpr std::size_t kMaxPoints = 2000;
constexpr double kRestSpeed = 1e-4;      // [rad/s or m/s]
constexpr double kSlack = 1.01;          // rounding of a planner that works at the limit
constexpr double kBridgeSlack = 1.1;     // of accelerations on the way onto a horizon
constexpr double kShortestBridge = 0.002;  // [s]
constexpr int kBridgeSamples = 12;

Error refusal(ErrorCode code, const std::string& what) { return {code, "the arm refuses a horizon: " + what}; }

std::string atPoint(std::size_t index) { return "point " + std::to_string(index) + ": "; }

}  // namespace

ArmMotion::ArmMotion(std::vector<std::string> joints, const Eigen::VectorXd& start, MotionLimits limits,
                     const ArmMotionOptions& options)
    : m_joints(std::move(joints)), m_limits(std::move(limits)), m_options(options) {
  const auto n = static_cast<Eigen::Index>(m_joints.size());
  LONGARM_REQUIRE(n > 0 && start.size() == n && m_limits.max_velocity.size() == n,
                  "ArmMotion needs one start and one limit per joint");
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  m_legs.push_back({Trajectory{m_joints, {TrajectoryPoint{0, start, zero, zero}}}, 0});
}

Status ArmMotion::checkPoint(const TrajectoryPoint& p, std::size_t index) const {
  for (Eigen::Index j = 0; j < p.positions.size(); ++j) {
    const std::string joint = atPoint(index) + "joint " + m_joints[static_cast<std::size_t>(j)];
    if (!std::isfinite(p.positions[j]) || !std::isfinite(p.velocities[j]) || !std::isfinite(p.accelerations[j])) {
      return refusal(ErrorCode::kInvalidInput, joint + " has a number that is not finite");
    }
    if (p.positions[j] < m_limits.lower[j] - 1e-6 || p.positions[j] > m_limits.upper[j] + 1e-6) {
      return refusal(ErrorCode::kOutOfLimits, joint + " at " + formatNumber(p.positions[j]) + "; its limits are " +
                                                  formatNumber(m_limits.lower[j]) + " and " +
                                                  formatNumber(m_limits.upper[j]));
    }
    if (std::abs(p.velocities[j]) > kSlack * m_limits.max_velocity[j]) {
      return refusal(ErrorCode::kOutOfLimits, joint + " moves at " + formatNumber(p.velocities[j]) +
                                                  "; its limit is " + formatNumber(m_limits.max_velocity[j]));
    }
    if (std::abs(p.accelerations[j]) > kBridgeSlack * m_limits.stop_deceleration[j]) {
      return refusal(ErrorCode::kOutOfLimits, joint + " accelerates at " + formatNumber(p.accelerations[j]) +
                                                  "; its limit is " + formatNumber(m_limits.stop_deceleration[j]));
    }
  }
  return {};
}

// The horizon with the joints in the arm's order, checked by itself.
Result<Trajectory> ArmMotion::ordered(const Horizon& horizon) const {
  const std::size_t n = m_joints.size();
  std::vector<Eigen::Index> places;
  for (const auto& joint : m_joints) {
    const auto it = std::find(horizon.joint_names.begin(), horizon.joint_names.end(), joint);
    if (it != horizon.joint_names.end()) places.push_back(it - horizon.joint_names.begin());
  }
  if (places.size() != n || horizon.joint_names.size() != n) {
    return refusal(ErrorCode::kInvalidInput, "it names " + std::to_string(horizon.joint_names.size()) +
                                                 " joints that are not the " + std::to_string(n) + " of the arm");
  }
  if (horizon.points.empty() || horizon.points.size() > kMaxPoints) {
    return refusal(ErrorCode::kInvalidInput, "it has " + std::to_string(horizon.points.size()) +
                                                 " points; expected 1 ... " + std::to_string(kMaxPoints));
  }
  Trajectory out{m_joints, {}};
  for (std::size_t i = 0; i < horizon.points.size(); ++i) {
    const TrajectoryPoint& p = horizon.points[i];
    const auto size = static_cast<Eigen::Index>(n);
    if (p.positions.size() != size || p.velocities.size() != size || p.accelerations.size() != size) {
      return refusal(ErrorCode::kInvalidInput, atPoint(i) + "needs " + std::to_string(n) + " numbers of each kind");
    }
    if (!std::isfinite(p.t) || p.t < 0 || p.t > m_options.max_horizon_s || (i > 0 && p.t <= out.points.back().t)) {
      return refusal(ErrorCode::kInvalidInput, atPoint(i) + "time " + formatNumber(p.t) +
                                                   " s; times increase and end within " +
                                                   formatNumber(m_options.max_horizon_s) + " s");
    }
    TrajectoryPoint sorted{p.t, Eigen::VectorXd(size), Eigen::VectorXd(size), Eigen::VectorXd(size)};
    for (Eigen::Index j = 0; j < size; ++j) {
      const Eigen::Index from = places[static_cast<std::size_t>(j)];
      sorted.positions[j] = p.positions[from];
      sorted.velocities[j] = p.velocities[from];
      sorted.accelerations[j] = p.accelerations[from];
    }
    if (auto status = checkPoint(sorted, i); !status) return status.error();
    out.points.push_back(std::move(sorted));
  }
  const double speed = out.points.back().velocities.cwiseAbs().maxCoeff();
  if (speed > kRestSpeed) {
    return refusal(ErrorCode::kInvalidInput, "its last point still moves at " + formatNumber(speed) +
                                                 "; every horizon ends at rest");
  }
  out.points.back().velocities.setZero();
  out.points.back().accelerations.setZero();
  return out;
}

bool ArmMotion::withinLimits(const Trajectory& bridge) const {
  for (int i = 0; i <= kBridgeSamples; ++i) {
    const TrajectoryPoint p = bridge.sample(bridge.duration() * i / kBridgeSamples);
    if (((p.velocities.cwiseAbs() - kSlack * m_limits.max_velocity).array() > 0).any()) return false;
    if (((p.accelerations.cwiseAbs() - kBridgeSlack * m_limits.stop_deceleration).array() > 0).any()) return false;
  }
  return true;
}

// From the arm's own state onto the horizon at the first of its points that can be reached within the limits.
Result<Trajectory> ArmMotion::joined(const TrajectoryPoint& from, const Trajectory& path, double elapsed_s) const {
  Trajectory out{m_joints, {from}};
  out.points.front().t = 0;
  for (std::size_t k = 0; k < path.points.size(); ++k) {
    const double h = path.points[k].t - elapsed_s;
    const bool last = k + 1 == path.points.size();
    if (h < (last ? 1e-6 : kShortestBridge)) continue;
    if (h > m_options.max_bridge_s && out.points.size() > 1) break;   // at least one point is tried
    out.points.resize(1);
    out.points.push_back(path.points[k]);
    out.points.back().t = h;
    if (!withinLimits(out)) continue;
    for (std::size_t i = k + 1; i < path.points.size(); ++i) {
      out.points.push_back(path.points[i]);
      out.points.back().t -= elapsed_s;
    }
    return out;
  }
  return refusal(ErrorCode::kRefused, "it cannot be reached from the arm's motion within " +
                                          formatNumber(m_options.max_bridge_s) + " s and the joints' limits");
}

void ArmMotion::put(Leg leg, double now_s) {
  while (m_legs.size() > 1 && m_legs.back().start_s >= leg.start_s) m_legs.pop_back();
  m_legs.push_back(std::move(leg));
  while (m_legs.size() > 1 && m_legs[1].start_s <= now_s) m_legs.pop_front();
}

Status ArmMotion::accept(const Horizon& horizon, double now_s) {
  const auto path = ordered(horizon);
  if (!path) return path.error();
  const double stamp_s = horizon.start_s == 0 ? now_s : horizon.start_s;
  if (!std::isfinite(stamp_s) || stamp_s > now_s + m_options.max_wait_s) {
    return refusal(ErrorCode::kStale, "it starts " + formatNumber(stamp_s - now_s) + " s ahead; the limit is " +
                                          formatNumber(m_options.max_wait_s) + " s");
  }
  const double start_s = stamp_s + m_options.latency_s;
  const double takes_over_s = std::max(start_s, now_s);
  const double elapsed_s = takes_over_s - start_s;
  if (elapsed_s > 0 && elapsed_s >= path->duration()) {
    return refusal(ErrorCode::kStale, "it was over " + formatNumber(elapsed_s - path->duration()) +
                                          " s before it arrived");
  }
  const TrajectoryPoint from = commandedAt(takes_over_s);
  Eigen::Index worst = 0;
  const double jump = (path->sample(elapsed_s).positions - from.positions).cwiseAbs().maxCoeff(&worst);
  if (jump > m_options.max_jump) {
    return refusal(ErrorCode::kRefused, "joint " + m_joints[static_cast<std::size_t>(worst)] + " would jump by " +
                                            formatNumber(jump) + "; the limit is " + formatNumber(m_options.max_jump));
  }
  auto leg = joined(from, *path, elapsed_s);
  if (!leg) return leg.error();
  put({std::move(*leg), takes_over_s}, now_s);
  return {};
}

void ArmMotion::stop(double now_s) { brakeFrom(now_s + m_options.latency_s, now_s); }

void ArmMotion::brake(double now_s) { brakeFrom(now_s, now_s); }

void ArmMotion::brakeFrom(double at_s, double now_s) {
  while (m_legs.size() > 1 && m_legs.back().start_s > at_s) m_legs.pop_back();
  const Leg& last = m_legs.back();
  Horizon braking = hardware::brakeAlong(last.path, at_s - last.start_s, m_limits.stop_deceleration);
  if (braking.points.empty()) return;
  put({Trajectory{m_joints, std::move(braking.points)}, at_s}, now_s);
}

TrajectoryPoint ArmMotion::commandedAt(double now_s) const {
  auto leg = m_legs.rbegin();
  while (leg + 1 != m_legs.rend() && leg->start_s > now_s) ++leg;
  TrajectoryPoint out = leg->path.sample(now_s - leg->start_s);
  out.t = now_s;
  return out;
}

bool ArmMotion::moving(double now_s) const {
  return commandedAt(now_s).velocities.cwiseAbs().maxCoeff() > 1e-9;
}

}  // namespace longarm::virtual_robot
