#include "hardware/stop_horizon.h"

#include <algorithm>
#include <cmath>

namespace longarm::hardware {
namespace {

constexpr double kStep = 0.004;          // between two points [s]
constexpr double kShortestStep = 0.001;  // of the last one [s]
constexpr double kMargin = 0.98;         // for what changes within one step
constexpr int kMaxPoints = 2000;

// Most negative dr/dt that keeps |q'' r^2 + q' dr/dt| within the limits of all joints; never positive.
double hardestBraking(const TrajectoryPoint& at, double rate, const Eigen::VectorXd& limit) {
  double lowest = -1e6;
  for (Eigen::Index j = 0; j < limit.size(); ++j) {
    const double speed = std::abs(at.velocities[j]);
    if (speed < 1e-9) continue;
    const double along = at.velocities[j] > 0 ? at.accelerations[j] : -at.accelerations[j];
    lowest = std::max(lowest, -(kMargin * limit[j] + along * rate * rate) / speed);
  }
  return std::min(lowest, 0.0);
}

TrajectoryPoint scaled(const TrajectoryPoint& at, double t, double rate, double braking) {
  return {t, at.positions, at.velocities * rate, at.accelerations * rate * rate + at.velocities * braking};
}

}  // namespace

Horizon brakeAlong(const Trajectory& path, double elapsed_s, const Eigen::VectorXd& stop_deceleration) {
  Horizon out;
  out.is_stop = true;
  out.joint_names = path.joint_names;
  if (path.empty() || !(elapsed_s < path.duration())) return out;
  double s = std::max(0.0, elapsed_s), rate = 1, t = 0;
  TrajectoryPoint here = path.sample(s);
  for (int i = 0; i < kMaxPoints && rate > 0; ++i) {
    double braking = hardestBraking(here, rate, stop_deceleration);
    // The path bends within the step: respect the limit at its far end, too.
    const double ahead = s + std::max(0.0, rate * kStep + 0.5 * braking * kStep * kStep);
    braking = std::max(braking, hardestBraking(path.sample(ahead), rate, stop_deceleration));
    double step = kStep;
    if (rate + braking * step < 1e-9) {
      step = std::clamp(-rate / braking, kShortestStep, kStep);
      braking = -rate / step;
    }
    out.points.push_back(scaled(here, t, rate, braking));
    s += rate * step + 0.5 * braking * step * step;
    rate = std::max(0.0, rate + braking * step);
    if (rate < 1e-9 || s >= path.duration()) rate = 0;
    t += step;
    here = path.sample(s);
  }
  TrajectoryPoint rest = scaled(here, t, 0, 0);
  rest.velocities.setZero();
  rest.accelerations.setZero();
  out.points.push_back(std::move(rest));
  return out;
}

}  // namespace longarm::hardware
