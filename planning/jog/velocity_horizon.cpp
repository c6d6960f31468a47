#include "planning/jog/velocity_horizon.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning {

namespace {

using Eigen::VectorXd;

constexpr double kPeak = 1.5;            // a cubic from rest to rest accelerates 1.5 times its mean
constexpr int kTrials = 24;              // halvings of the change of velocity: beyond that it is none

// Velocity v(s) of one leg, s in [0, h]: a cubic from (v0, a0) to (v1, no acceleration).
struct Leg {
  VectorXd v0, a0, v1;
  double h = 0;

  VectorXd acceleration(double s) const {
    const double x = s / h;
    return (v1 - v0) * (6 * x * (1 - x) / h) + a0 * ((1 - x) * (1 - 3 * x));
  }
  VectorXd velocity(double s) const {
    const double x = s / h;
    return v0 + (v1 - v0) * (x * x * (3 - 2 * x)) + a0 * (h * x * (1 - x) * (1 - x));
  }
  VectorXd way(double s) const {
    const double x = s / h;
    return v0 * s + (v1 - v0) * (h * x * x * x * (1 - x / 2)) + a0 * (h * h * x * x * (0.5 - 2 * x / 3 + x * x / 4));
  }
  bool keeps(const VectorXd& limit) const {
    for (int i = 0; i <= 8; ++i) {
      const VectorXd a = acceleration(h * i / 8).cwiseAbs();
      if (((a - limit).array() > 1e-9).any()) return false;
    }
    return true;
  }
};

void append(const Leg& leg, int pieces, std::vector<TrajectoryPoint>& points) {
  const TrajectoryPoint from = points.back();
  for (int i = 1; i <= pieces; ++i) {
    const double s = leg.h * i / pieces;
    points.push_back({from.t + s, from.positions + leg.way(s), leg.velocity(s), leg.acceleration(s)});
  }
}

// Long enough for every joint, in whole points.
int brakingPieces(const Leg& braking, const VectorXd& limit, const VelocityHorizonOptions& options) {
  const int most = static_cast<int>(std::lround(options.longest_braking_s / options.spacing_s));
  for (int pieces = 2; pieces < most; ++pieces) {
    Leg trial = braking;
    trial.h = pieces * options.spacing_s;
    if (trial.keeps(limit)) return pieces;
  }
  return most;
}

}  // namespace

VectorXd brakeable(const VectorXd& wanted, const MotionLimits& limits, const VelocityHorizonOptions& options) {
  double scale = 1;
  for (Eigen::Index j = 0; j < wanted.size(); ++j) {
    const double by_braking = options.share * limits.max_acceleration[j] * options.longest_braking_s / kPeak;
    const double limit = std::min(options.share * limits.max_velocity[j], by_braking);
    if (std::abs(wanted[j]) > limit) scale = std::min(scale, limit / std::abs(wanted[j]));
  }
  return wanted * scale;
}

std::vector<TrajectoryPoint> velocityHorizon(const std::vector<TrajectoryPoint>& in_force, const VectorXd& wanted,
                                             const MotionLimits& limits, const VelocityHorizonOptions& options) {
  std::vector<TrajectoryPoint> points = in_force;
  const TrajectoryPoint from = points.back();
  const VectorXd limit = options.share * limits.max_acceleration;
  Leg change{from.velocities, from.accelerations, wanted, options.change_s};
  double part = 1;
  for (int i = 0; i < kTrials && !change.keeps(limit); ++i) {
    part *= i + 1 < kTrials ? 0.8 : 0;
    change.v1 = from.velocities + part * (wanted - from.velocities);
  }
  append(change, static_cast<int>(std::lround(options.change_s / options.spacing_s)), points);
  const VectorXd zero = VectorXd::Zero(wanted.size());
  Leg braking{points.back().velocities, zero, zero, 0};
  const int pieces = brakingPieces(braking, limit, options);
  braking.h = pieces * options.spacing_s;
  append(braking, pieces, points);
  points.back().velocities = points.back().accelerations = zero;
  return points;
}

}  // namespace longarm::planning
