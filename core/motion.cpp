#include "core/motion.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/require.h"
#include "core/text.h"

namespace longarm {
namespace {

// Quintic Hermite on [0, h] through position, velocity and acceleration at both ends.
void quintic(double h, double t, const double (&a)[3], const double (&b)[3], double (&out)[3]) {
  const double h2 = h * h;
  const double d = b[0] - a[0] - a[1] * h - 0.5 * a[2] * h2;
  const double dv = (b[1] - a[1] - a[2] * h) * h;
  const double da = (b[2] - a[2]) * h2;
  const double c3 = 10 * d - 4 * dv + 0.5 * da;
  const double c4 = -15 * d + 7 * dv - da;
  const double c5 = 6 * d - 3 * dv + 0.5 * da;
  const double s = t / h;
  const double s2 = s * s, s3 = s2 * s, s4 = s3 * s, s5 = s4 * s;
  out[0] = a[0] + a[1] * t + 0.5 * a[2] * t * t + c3 * s3 + c4 * s4 + c5 * s5;
  out[1] = a[1] + a[2] * t + (3 * c3 * s2 + 4 * c4 * s3 + 5 * c5 * s4) / h;
  out[2] = a[2] + (6 * c3 * s + 12 * c4 * s2 + 20 * c5 * s3) / h2;
}

Error pointError(const Trajectory& trajectory, std::size_t i, const std::string& what) {
  return {ErrorCode::kInvalidInput, "trajectory point " + std::to_string(i) + " of " +
                                        std::to_string(trajectory.points.size()) + ": " + what};
}

Status checkRest(const Trajectory& trajectory, std::size_t i) {
  const auto& v = trajectory.points[i].velocities;
  for (Eigen::Index j = 0; j < v.size(); ++j) {
    if (std::abs(v[j]) > 1e-6) {
      return pointError(trajectory, i, "joint " + trajectory.joint_names[static_cast<std::size_t>(j)] +
                                           " moves at " + formatNumber(v[j]) +
                                           "; a trajectory begins and ends at rest");
    }
  }
  return {};
}

}  // namespace

Result<double> JointState::position(const std::string& name) const {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return positions[static_cast<Eigen::Index>(i)];
  }
  return Error{ErrorCode::kNotFound, "joint \"" + name + "\" is not in the measured joint state"};
}

Result<Eigen::VectorXd> JointState::positionsOf(const std::vector<std::string>& wanted) const {
  Eigen::VectorXd q(static_cast<Eigen::Index>(wanted.size()));
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto value = position(wanted[i]);
    if (!value) return value.error();
    q[static_cast<Eigen::Index>(i)] = *value;
  }
  return q;
}

TrajectoryPoint Trajectory::sample(double t) const {
  LONGARM_REQUIRE(!points.empty(), "sample() of an empty trajectory");
  if (t <= points.front().t || points.size() == 1) return points.front();
  if (t >= points.back().t) return points.back();
  const auto next = std::upper_bound(points.begin(), points.end(), t,
                                     [](double value, const TrajectoryPoint& p) { return value < p.t; });
  const TrajectoryPoint& b = *next;
  const TrajectoryPoint& a = *(next - 1);
  TrajectoryPoint out = a;
  out.t = t;
  for (Eigen::Index j = 0; j < a.positions.size(); ++j) {
    double state[3];
    quintic(b.t - a.t, t - a.t, {a.positions[j], a.velocities[j], a.accelerations[j]},
            {b.positions[j], b.velocities[j], b.accelerations[j]}, state);
    out.positions[j] = state[0];
    out.velocities[j] = state[1];
    out.accelerations[j] = state[2];
  }
  return out;
}

Status validate(const Trajectory& trajectory) {
  const auto n = static_cast<Eigen::Index>(trajectory.joint_names.size());
  const std::set<std::string> unique(trajectory.joint_names.begin(), trajectory.joint_names.end());
  if (n == 0 || unique.size() != trajectory.joint_names.size()) {
    return {ErrorCode::kInvalidInput, "trajectory: joint names are missing or repeated"};
  }
  if (trajectory.points.empty()) return {ErrorCode::kInvalidInput, "trajectory: has no points"};
  for (std::size_t i = 0; i < trajectory.points.size(); ++i) {
    const auto& p = trajectory.points[i];
    if (p.positions.size() != n || p.velocities.size() != n || p.accelerations.size() != n) {
      return pointError(trajectory, i, "needs " + std::to_string(n) +
                                           " positions, velocities and accelerations");
    }
    if (!std::isfinite(p.t) || !p.positions.allFinite() || !p.velocities.allFinite() ||
        !p.accelerations.allFinite()) {
      return pointError(trajectory, i, "holds a number that is not finite");
    }
    if (i == 0 ? p.t != 0 : p.t <= trajectory.points[i - 1].t) {
      return pointError(trajectory, i, "t = " + formatNumber(p.t) +
                                           "; times start at 0 and increase strictly");
    }
  }
  if (auto status = checkRest(trajectory, 0); !status) return status;
  return checkRest(trajectory, trajectory.points.size() - 1);
}

}  // namespace longarm
