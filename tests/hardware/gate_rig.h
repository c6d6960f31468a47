#pragma once

/// @file
/// A gate on a simulated arm with a manual clock, and horizons to feed it.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hardware/motion_gate.h"
#include "hardware/sim/simulated_arm.h"

namespace longarm::hardware::tests {

inline std::vector<std::string> jointNames(int n) {
  std::vector<std::string> out;
  for (int i = 0; i < n; ++i) out.push_back("joint_" + std::to_string(i + 1));
  return out;
}

inline MotionLimits testLimits(int n) {
  MotionLimits l;
  l.lower = Eigen::VectorXd::Constant(n, -2);
  l.upper = Eigen::VectorXd::Constant(n, 2);
  l.max_velocity = Eigen::VectorXd::Constant(n, 1.0);
  l.max_acceleration = Eigen::VectorXd::Constant(n, 4.0);
  l.stop_deceleration = Eigen::VectorXd::Constant(n, 12.0);
  return l;
}

/// A horizon along direction `d` (|d|_inf <= 1): speeds up from `speed` by `acceleration` for a third of its
/// time, cruises, and brakes to rest at `braking`; sampled every 20 ms.
inline Horizon brakingHorizon(const Eigen::VectorXd& start, const Eigen::VectorXd& d, double speed, double braking,
                              double cruise_s = 0.05) {
  Horizon out;
  out.owner = "player";
  out.joint_names = jointNames(static_cast<int>(start.size()));
  const double stop_s = speed / braking;
  const double total = cruise_s + stop_s;
  const int steps = std::max(1, static_cast<int>(std::ceil(total / 0.02)));
  for (int i = 0; i <= steps; ++i) {
    const double t = total * i / steps;
    const double late = std::max(0.0, t - cruise_s);
    const double s = speed * std::min(t, cruise_s) + speed * late - 0.5 * braking * late * late;
    const double v = i == steps ? 0.0 : speed - braking * late;
    const double a = late > 0 ? -braking : 0.0;
    out.points.push_back({t, start + d * s, d * v, d * a});
  }
  return out;
}

/// From rest to rest over `way` by a quintic in `duration` seconds.
inline Horizon restToRest(const Eigen::VectorXd& start, const Eigen::VectorXd& way, double duration) {
  Horizon out;
  out.owner = "player";
  out.joint_names = jointNames(static_cast<int>(start.size()));
  const int steps = std::max(2, static_cast<int>(std::lround(duration / 0.02)));
  for (int i = 0; i <= steps; ++i) {
    const double u = static_cast<double>(i) / steps;
    const double s = u * u * u * (10 - 15 * u + 6 * u * u);
    const double v = i == steps ? 0.0 : 30 * u * u * (1 - 2 * u + u * u) / duration;
    const double a = i == steps ? 0.0 : 60 * u * (1 - 3 * u + 2 * u * u) / (duration * duration);
    out.points.push_back({duration * u, start + way * s, way * v, way * a});
  }
  return out;
}

class GateRig {
 public:
  explicit GateRig(int n = 3, GateOptions options = {}, GateChecks checks = {})
      : limits(testLimits(n)),
        arm(std::make_shared<SimulatedArm>("arm", jointNames(n), Eigen::VectorXd::Zero(n), limits.stop_deceleration,
                                           clock)),
        gate(arm, jointNames(n), limits, clock, options, std::move(checks)) {
    EXPECT_TRUE(arm->open().ok());
  }

  /// Releases STOP and takes the arm for "player".
  void start() {
    const auto reset = gate.reset();
    EXPECT_TRUE(reset.ok()) << reset.error().message;
    EXPECT_TRUE(gate.acquire("player").ok());
  }

  Status submit(Horizon horizon) {
    horizon.sequence = ++sequence;
    horizon.start_s = clock.now_s();
    return gate.submit(horizon);
  }

  Eigen::VectorXd position() const { return arm->jointState()->positions; }
  Eigen::VectorXd velocity() const { return arm->jointState()->velocities; }

  ManualClock clock{100};
  MotionLimits limits;
  std::shared_ptr<SimulatedArm> arm;
  MotionGate gate;
  std::uint64_t sequence = 0;
};

}  // namespace longarm::hardware::tests
