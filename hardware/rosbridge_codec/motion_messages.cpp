// Between the motion values of core and their messages.
#include <cmath>
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

TwistMessage toMessage(const BaseTwist& twist) {
  return {{twist.forward, twist.left, 0}, {0, 0, twist.turn}};
}

Result<BaseTwist> toTwist(const TwistMessage& message) {
  for (const auto* part : {&message.linear, &message.angular}) {
    for (const double value : *part) {
      if (!std::isfinite(value))
        return Error{ErrorCode::kInvalidInput, "twist: holds a number that is not finite"};
    }
  }
  return BaseTwist{message.linear[0], message.linear[1], message.angular[2]};
}

OdometryMessage toMessage(const BaseState& state, double stamp_s) {
  OdometryMessage out;
  out.header.stamp_s = stamp_s;
  out.header.frame_id = "odom";
  out.child_frame_id = "base_link";
  out.position = {state.x, state.y, 0};
  out.orientation = {0, 0, std::sin(state.yaw / 2), std::cos(state.yaw / 2)};
  out.twist = toMessage(state.twist);
  return out;
}

Result<BaseState> toBaseState(const OdometryMessage& message) {
  const auto twist = toTwist(message.twist);
  if (!twist) return twist.error();
  const auto& p = message.position;
  const auto& q = message.orientation;
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !(std::abs(norm - 1) < 0.01)) {
    return Error{ErrorCode::kInvalidInput,
                 "odometry: its pose is not finite, or its quaternion has length " + formatNumber(norm)};
  }
  const double yaw = std::atan2(2 * (q[3] * q[2] + q[0] * q[1]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
  return BaseState{message.header.stamp_s, p[0], p[1], yaw, *twist};
}

ImuMessage toMessage(const Attitude& attitude, double stamp_s, const std::string& frame) {
  ImuMessage out;
  out.header.stamp_s = stamp_s;
  out.header.frame_id = frame;
  const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(attitude.up, Eigen::Vector3d::UnitZ());
  out.orientation = {q.x(), q.y(), q.z(), q.w()};
  return out;
}

Result<Attitude> toAttitude(const ImuMessage& message) {
  if (message.orientation_covariance[0] == -1) {
    return Error{ErrorCode::kInvalidInput, "attitude: the sensor tells no orientation (its first covariance is -1)"};
  }
  const auto& q = message.orientation;
  const Eigen::Quaterniond orientation(q[3], q[0], q[1], q[2]);
  const double norm = orientation.norm();
  if (!(std::abs(norm - 1) < 0.01)) {
    return Error{ErrorCode::kInvalidInput, "attitude: its quaternion has length " + formatNumber(norm) + "; expected 1"};
  }
  return Attitude{message.header.stamp_s, orientation.normalized().conjugate() * Eigen::Vector3d::UnitZ()};
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
