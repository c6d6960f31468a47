#include <gtest/gtest.h>

#include <random>

#include "hardware/horizon_checks.h"
#include "hardware/stop_horizon.h"
#include "tests/hardware/gate_rig.h"

namespace longarm::hardware::tests {
namespace {

// A curved path through random points, within the limits of testLimits(): sums of sines.
Trajectory curvedPath(std::mt19937& rng, int n, double duration) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Trajectory path{jointNames(n), {}};
  Eigen::VectorXd size(n), rate(n), phase(n);
  for (int j = 0; j < n; ++j) {
    rate[j] = 2 + 2 * unit(rng);
    phase[j] = 3 * unit(rng);
    size[j] = unit(rng) * std::min(0.9 / std::max(rate[j], 0.1), 3.6 / std::max(rate[j] * rate[j], 0.01));
    size[j] = std::clamp(size[j], -1.0, 1.0);
  }
  const int steps = static_cast<int>(duration / 0.02);
  for (int i = 0; i <= steps; ++i) {
    const double t = duration * i / steps;
    const Eigen::ArrayXd angle = rate.array() * t + phase.array();
    path.points.push_back({t, size.array() * angle.sin(), size.array() * rate.array() * angle.cos(),
                           -size.array() * rate.array().square() * angle.sin()});
  }
  return path;
}

double distanceToPath(const Trajectory& path, const Eigen::VectorXd& q) {
  double best = 1e9;
  for (double t = 0; t <= path.duration(); t += 0.0005) {
    best = std::min(best, (path.sample(t).positions - q).lpNorm<Eigen::Infinity>());
  }
  return best;
}

TEST(StopHorizon, BrakesWithinAHundredMillisecondsOnThePathAtTheStopDeceleration) {
  std::mt19937 rng(7);
  const MotionLimits limits = testLimits(6);
  for (int round = 0; round < 200; ++round) {
    const Trajectory path = curvedPath(rng, 6, 0.5);
    const double elapsed = std::uniform_real_distribution<double>(0, 0.35)(rng);
    const Horizon stop = brakeAlong(path, elapsed, limits.stop_deceleration);
    ASSERT_GE(stop.points.size(), 2u);
    EXPECT_EQ(stop.points.back().velocities.norm(), 0);
    EXPECT_LE(stop.duration(), 0.1);     // speed <= 0.9, deceleration 12
    const TrajectoryPoint start = path.sample(elapsed);
    EXPECT_LT((stop.points.front().positions - start.positions).norm(), 1e-12);
    EXPECT_LT((stop.points.front().velocities - start.velocities).norm(), 1e-12);
    for (std::size_t i = 0; i < stop.points.size(); ++i) {
      const auto& p = stop.points[i];
      // 2e-4: half the sampling of the path search at speed 0.9.
      EXPECT_LT(distanceToPath(path, p.positions), 3e-4);
      EXPECT_LE((p.accelerations.cwiseAbs() - 1.01 * limits.stop_deceleration).maxCoeff(), 0);
      if (i == 0) continue;
      const auto& before = stop.points[i - 1];
      const Eigen::VectorXd a = (p.velocities - before.velocities) / (p.t - before.t);
      EXPECT_LE((a.cwiseAbs() - 1.05 * limits.stop_deceleration).maxCoeff(), 0) << a.transpose();
    }
  }
}

TEST(StopHorizon, IsEmptyWhenThePathIsOver) {
  const Horizon done = restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.01, 0, 0), 0.3);
  const Trajectory path{done.joint_names, done.points};
  EXPECT_TRUE(brakeAlong(path, 0.3, testLimits(3).stop_deceleration).points.empty());
  EXPECT_TRUE(brakeAlong({}, 0, testLimits(3).stop_deceleration).points.empty());
}

TEST(StopHorizon, NeverLastsLongerThanThePathItself) {
  const Horizon slow = restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(1e-5, 0, 0), 0.3);
  const Trajectory path{slow.joint_names, slow.points};
  for (double t = 0; t < 0.3; t += 0.01) {
    const Horizon stop = brakeAlong(path, t, testLimits(3).stop_deceleration);
    EXPECT_LE(stop.duration(), 0.3 - t + 0.004);
  }
}

TEST(StopHorizon, WeakBrakesTakeLongerButStayOnThePath) {
  std::mt19937 rng(3);
  const Trajectory path = curvedPath(rng, 3, 2.0);
  const Eigen::Vector3d weak(4, 4, 4);   // no more than planned motion uses
  const Horizon stop = brakeAlong(path, 0.2, weak);
  EXPECT_EQ(stop.points.back().velocities.norm(), 0);
  for (const auto& p : stop.points) EXPECT_LT(distanceToPath(path, p.positions), 3e-4);
}

}  // namespace
}  // namespace longarm::hardware::tests
