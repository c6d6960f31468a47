#pragma once

/// @file
/// Random but valid trajectories and limits for the player's tests.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/motion.h"

namespace longarm::testing {

inline MotionLimits limitsOf(int joints, double velocity, double acceleration) {
  MotionLimits limits;
  limits.lower = Eigen::VectorXd::Constant(joints, -10);
  limits.upper = Eigen::VectorXd::Constant(joints, 10);
  limits.max_velocity = Eigen::VectorXd::Constant(joints, velocity);
  limits.max_acceleration = Eigen::VectorXd::Constant(joints, acceleration);
  limits.stop_deceleration = 2 * limits.max_acceleration;
  return limits;
}

/// Share of the limits that a made trajectory uses.
struct Shares {
  double velocity = 0.5, acceleration = 0.25;
};

/// A path of three sinusoids per joint, run rest to rest by a quintic time law, sampled every `dt` and slowed
/// until it keeps `shares` of the limits.
class SmoothMotion {
 public:
  SmoothMotion(const MotionLimits& limits, unsigned seed) : m_random(seed) {
    const Eigen::Index n = limits.max_velocity.size();
    for (Eigen::Index j = 0; j < n; ++j) {
      for (int k = 0; k < 3; ++k) {
        m_amplitude.push_back(uniform(-0.6, 0.6));
        m_frequency.push_back(uniform(0.5, 7));
        m_phase.push_back(uniform(0, 6.28));
      }
    }
  }

  Trajectory timed(const MotionLimits& limits, Shares shares, double dt = 0.02) const {
    double duration = 1;
    for (int pass = 0; pass < 2; ++pass) {
      double ratio = 0;
      for (const auto& p : sampled(limits, duration, duration / 500).points) {
        const double v =
            (p.velocities.cwiseAbs().cwiseQuotient(limits.max_velocity)).maxCoeff() / shares.velocity;
        const double a = (p.accelerations.cwiseAbs().cwiseQuotient(limits.max_acceleration)).maxCoeff() /
                         shares.acceleration;
        ratio = std::max({ratio, v, std::sqrt(a)});
      }
      duration *= ratio * 1.0005;
    }
    return sampled(limits, duration, dt);
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(m_random); }

  TrajectoryPoint pointAt(Eigen::Index n, double t, double duration) const {
    const double x = t / duration;
    const double s = x * x * x * (10 - 15 * x + 6 * x * x);
    const double ds = 30 * x * x * (1 - x) * (1 - x) / duration;
    const double dds = 60 * x * (1 - x) * (1 - 2 * x) / (duration * duration);
    TrajectoryPoint p{t, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
    for (Eigen::Index j = 0; j < n; ++j) {
      for (int k = 0; k < 3; ++k) {
        const auto i = static_cast<std::size_t>(3 * j + k);
        const double w = m_frequency[i], a = m_amplitude[i], phase = w * s + m_phase[i];
        p.positions[j] += a * std::sin(phase);
        p.velocities[j] += a * w * std::cos(phase) * ds;
        p.accelerations[j] += a * w * (std::cos(phase) * dds - w * std::sin(phase) * ds * ds);
      }
    }
    return p;
  }

  Trajectory sampled(const MotionLimits& limits, double duration, double dt) const {
    const Eigen::Index n = limits.max_velocity.size();
    Trajectory trajectory;
    for (Eigen::Index j = 0; j < n; ++j) trajectory.joint_names.push_back("joint_" + std::to_string(j + 1));
    const int count = std::max(2, static_cast<int>(std::ceil(duration / dt)));
    for (int i = 0; i <= count; ++i) trajectory.points.push_back(pointAt(n, duration * i / count, duration));
    trajectory.points.front().velocities.setZero();
    trajectory.points.back().velocities.setZero();
    return trajectory;
  }

  std::mt19937 m_random;
  std::vector<double> m_amplitude, m_frequency, m_phase;
};

/// One joint from 0 to `distance` with constant acceleration, cruise and deceleration: accelerations jump.
inline Trajectory trapezoid(double distance, double velocity, double acceleration, double dt = 0.02) {
  const double ramp = velocity / acceleration;
  const double cruise = distance / velocity - ramp;
  const double total = 2 * ramp + cruise;
  Trajectory trajectory;
  trajectory.joint_names = {"joint_1"};
  const int count = static_cast<int>(std::ceil(total / dt));
  for (int i = 0; i <= count; ++i) {
    const double t = total * i / count;
    double q = 0, v = 0, a = 0;
    if (t < ramp) {
      q = 0.5 * acceleration * t * t, v = acceleration * t, a = acceleration;
    } else if (t < ramp + cruise) {
      q = 0.5 * acceleration * ramp * ramp + velocity * (t - ramp), v = velocity;
    } else {
      const double left = total - t;
      q = distance - 0.5 * acceleration * left * left, v = acceleration * left, a = -acceleration;
    }
    const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
    trajectory.points.push_back({t, one(q), one(v), one(a)});
  }
  trajectory.points.front().velocities.setZero();
  trajectory.points.back().velocities.setZero();
  return trajectory;
}

/// State of a horizon at a time on the caller's clock, as a receiver interpolates it; at rest after its end.
inline TrajectoryPoint receiverAt(const Horizon& horizon, double now_s) {
  Trajectory piece{horizon.joint_names, horizon.points};
  TrajectoryPoint p = piece.sample(now_s - horizon.start_s);
  if (now_s - horizon.start_s >= horizon.duration()) p.accelerations.setZero();
  return p;
}

/// Distance of a configuration from the path near `tau`, by a coarse and a fine search.
inline double distanceToPath(const Trajectory& path, const Eigen::VectorXd& q, double tau, double window) {
  double best = 1e9, step = 5e-4, centre = tau;
  for (int pass = 0; pass < 3; ++pass) {
    const double middle = centre;
    for (double t = middle - window; t <= middle + window; t += step) {
      const double d = (path.sample(std::clamp(t, 0.0, path.duration())).positions - q).norm();
      if (d < best) best = d, centre = t;
    }
    window = step, step /= 40;
  }
  return best;
}

}  // namespace longarm::testing
