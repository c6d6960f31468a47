#include "planning/trajectory/time_parameterization.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/require.h"
#include "core/text.h"
#include "planning/trajectory/time_law.h"

namespace longarm::planning {
namespace {

constexpr double kSample = 0.5e-3;       // [s]
constexpr double kPeakMargin = 1e-4;     // what can rise above the samples

Status checkInput(const JointPath& path, std::size_t joints, const NominalLimits& limits) {
  const auto n = static_cast<Eigen::Index>(joints);
  const PathState start = path.at(0), end = path.at(path.length());
  if (start.q.size() != n || limits.max_velocity.size() != n || limits.max_acceleration.size() != n) {
    return {ErrorCode::kDegenerate, "path of " + std::to_string(start.q.size()) + " joints, limits of " +
                                        std::to_string(limits.max_velocity.size()) + ", names of " +
                                        std::to_string(joints)};
  }
  if (!(path.length() > 1e-12) || !start.q.allFinite() || !end.q.allFinite()) {
    return {ErrorCode::kDegenerate, "path has length " + formatNumber(path.length()) + "; needs one above 0"};
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    if (!(limits.max_velocity[j] > 0) || !(limits.max_acceleration[j] > 0)) {
      return {ErrorCode::kDegenerate, "joint " + std::to_string(j) + " has velocity limit " +
                                          formatNumber(limits.max_velocity[j]) + " and acceleration limit " +
                                          formatNumber(limits.max_acceleration[j]) + "; both must be above 0"};
    }
  }
  return {};
}

bool stopped(const TimingOptions& options) { return options.stop && options.stop(); }

// Nothing when it was stopped.
std::optional<TimeLaw> lawFor(const JointPath& path, const NominalLimits& limits, const TimingOptions& options) {
  const std::vector<double> grid = path.grid();
  std::vector<PathConstraint> constraints;
  constraints.reserve(grid.size());
  for (const double s : grid) {
    if (stopped(options)) return std::nullopt;
    PathState state = path.at(s);
    PathConstraint c;
    if (options.tool_way) {
      const double way = options.tool_way(state);
      if (way > 1e-12) c.max_speed = options.max_tool_speed / way;
    }
    c.dq = std::move(state.dq);
    c.ddq = std::move(state.ddq);
    constraints.push_back(std::move(c));
  }
  return fastestTimeLaw(grid, constraints, limits.max_velocity, limits.max_acceleration);
}

TrajectoryPoint pointAt(const JointPath& path, const TimeLaw& law, double t, double window) {
  const TimeLaw::State s = law.smoothedAt(t, window);
  const PathState p = path.at(s.s);
  return {t, p.q, p.dq * s.ds, p.dq * s.dds + p.ddq * s.ds * s.ds};
}

void slowDown(Trajectory& trajectory, double factor) {
  for (auto& point : trajectory.points) {
    point.t *= factor;
    point.velocities /= factor;
    point.accelerations /= factor * factor;
  }
}

}  // namespace

LimitRatios limitRatios(const Trajectory& trajectory, const Eigen::VectorXd& max_velocity,
                        const Eigen::VectorXd& max_acceleration, const std::function<bool()>& stop) {
  LimitRatios ratios;
  const auto look = [&](double t) {
    const TrajectoryPoint p = trajectory.sample(t);
    ratios.velocity = std::max(ratios.velocity, (p.velocities.cwiseAbs().array() / max_velocity.array()).maxCoeff());
    ratios.acceleration =
        std::max(ratios.acceleration, (p.accelerations.cwiseAbs().array() / max_acceleration.array()).maxCoeff());
  };
  for (std::size_t i = 1; i < trajectory.points.size(); ++i) {
    if (stop && stop()) break;
    const double from = trajectory.points[i - 1].t, h = trajectory.points[i].t - from;
    const int samples = std::max(8, static_cast<int>(std::ceil(h / kSample)));
    for (int k = 0; k <= samples; ++k) look(from + h * k / samples);
  }
  return ratios;
}

Result<Trajectory> parameterize(const JointPath& path, const std::vector<std::string>& joint_names,
                                const NominalLimits& limits, const TimingOptions& options) {
  if (auto status = checkInput(path, joint_names.size(), limits); !status) return status.error();
  const Error cancelled{ErrorCode::kCancelled, "timing the motion was cancelled"};
  const auto found = lawFor(path, limits, options);
  if (!found || stopped(options)) return cancelled;
  const TimeLaw& law = *found;
  const double window = std::max(options.smoothing_s, 0.0);
  const double duration = law.duration() + window;
  if (!std::isfinite(duration) || duration > 3600) {
    return Error{ErrorCode::kDegenerate, "the motion would last " + formatNumber(duration) + " s (limit 3600 s)"};
  }
  Trajectory out;
  out.joint_names = joint_names;
  const int cells = std::max(2, static_cast<int>(std::ceil(duration / (0.98 * options.point_spacing_s))));
  double tool_ratio = 0;
  for (int i = 0; i <= cells; ++i) {
    if (stopped(options)) return cancelled;
    const double t = i == cells ? duration : duration * i / cells;
    out.points.push_back(pointAt(path, law, t, window));
    if (!options.tool_way) continue;
    const TimeLaw::State s = law.smoothedAt(t, window);
    tool_ratio = std::max(tool_ratio, options.tool_way(path.at(s.s)) * s.ds / options.max_tool_speed);
  }
  out.points.front().velocities.setZero();
  out.points.back().velocities.setZero();
  const LimitRatios ratios = limitRatios(out, limits.max_velocity, limits.max_acceleration, options.stop);
  if (stopped(options)) return cancelled;
  const double slower = std::max({ratios.velocity, std::sqrt(ratios.acceleration), tool_ratio}) * (1 + kPeakMargin);
  if (slower > 1) slowDown(out, slower);
  return out;
}

void append(Trajectory& a, const Trajectory& b) {
  LONGARM_REQUIRE(a.empty() || a.joint_names == b.joint_names, "trajectories of different joints");
  if (a.empty()) {
    a = b;
    return;
  }
  const double start = a.duration();
  for (std::size_t i = 1; i < b.points.size(); ++i) {
    a.points.push_back(b.points[i]);
    a.points.back().t += start;
  }
}

Trajectory standStill(const std::vector<std::string>& joint_names, const Eigen::VectorXd& positions, double seconds) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(positions.size());
  return {joint_names, {{0, positions, zero, zero}, {seconds, positions, zero, zero}}};
}

}  // namespace longarm::planning
