// Between the motion values of core and their messages.
#include <set>

#include "core/text.h"
#include "hardware/rosbridge_codec/messages.h"

namespace longarm::rosbridge {
namespace {

std::vector<double> listOf(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

// n numbers as a vector; an empty list stands for zeros.
Result<Eigen::VectorXd> vectorOf(const std::vector<double>& list, std::size_t n, const std::string& what) {
  if (list.empty()) return Eigen::VectorXd(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n)));
  if (list.size() != n) {
    return Error{ErrorCode::kInvalidInput, what + ": has " + std::to_string(list.size()) + " numbers for " +
                                               std::to_string(n) + " joints"};
  }
  Eigen::VectorXd out = Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(n));
  if (!out.allFinite()) return Error{ErrorCode::kInvalidInput, what + ": holds a number that is not finite"};
  return out;
}

Status checkNames(const std::vector<std::string>& names, const std::string& what) {
  std::set<std::string> seen;
  for (const auto& name : names) {
    if (name.empty() || !seen.insert(name).second) {
      return {ErrorCode::kInvalidInput, what + ": joint name \"" + name + "\" is empty or given twice"};
    }
  }
  return {};
}

Result<TrajectoryPoint> toPoint(const JointTrajectoryPointMessage& m, std::size_t n, const std::string& what) {
  if (m.positions.empty() && n > 0) return Error{ErrorCode::kInvalidInput, what + ": has no positions"};
  const auto positions = vectorOf(m.positions, n, what + " positions");
  if (!positions) return positions.error();
  const auto velocities = vectorOf(m.velocities, n, what + " velocities");
  if (!velocities) return velocities.error();
  const auto accelerations = vectorOf(m.accelerations, n, what + " accelerations");
  if (!accelerations) return accelerations.error();
  return TrajectoryPoint{m.time_from_start_s, *positions, *velocities, *accelerations};
}

}  // namespace

JointTrajectoryMessage toMessage(const Horizon& horizon, double start_s) {
  JointTrajectoryMessage out;
  out.header.seq = static_cast<std::uint32_t>(horizon.sequence);
  out.header.stamp_s = start_s;
  out.joint_names = horizon.joint_names;
  out.points.reserve(horizon.points.size());
  for (const auto& p : horizon.points) {
    out.points.push_back({listOf(p.positions), listOf(p.velocities), listOf(p.accelerations), p.t});
  }
  return out;
}

Result<Horizon> toHorizon(const JointTrajectoryMessage& message) {
  if (auto status = checkNames(message.joint_names, "joint trajectory"); !status) return status.error();
  Horizon out;
  out.sequence = message.header.seq;
  out.start_s = message.header.stamp_s;
  out.joint_names = message.joint_names;
  for (std::size_t i = 0; i < message.points.size(); ++i) {
    auto point = toPoint(message.points[i], out.joint_names.size(), "joint trajectory point " + std::to_string(i));
    if (!point) return point.error();
    if (point->t < 0 || (i > 0 && point->t <= out.points.back().t)) {
      return Error{ErrorCode::kInvalidInput, "joint trajectory point " + std::to_string(i) + ": time " +
                                                 formatNumber(point->t) + " s does not increase"};
    }
    out.points.push_back(std::move(*point));
  }
  return out;
}

JointStateMessage toMessage(const JointState& state, double stamp_s) {
  JointStateMessage out;
  out.header.stamp_s = stamp_s;
  out.name = state.names;
  out.position = listOf(state.positions);
  out.velocity = listOf(state.velocities);
  return out;
}

Result<JointState> toJointState(const JointStateMessage& message) {
  if (auto status = checkNames(message.name, "joint state"); !status) return status.error();
  const std::size_t n = message.name.size();
  if (message.position.size() != n) {
    return Error{ErrorCode::kInvalidInput, "joint state: has " + std::to_string(message.position.size()) +
                                               " positions for " + std::to_string(n) + " joints"};
  }
  const auto positions = vectorOf(message.position, n, "joint state positions");
  if (!positions) return positions.error();
  const auto velocities = vectorOf(message.velocity, n, "joint state velocities");
  if (!velocities) return velocities.error();
  JointState out{message.header.stamp_s, message.name, *positions, {}};
  if (!message.velocity.empty()) out.velocities = *velocities;
  return out;
}

}  // namespace longarm::rosbridge
