#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/hardware/gate_rig.h"

namespace longarm::hardware::tests {
namespace {

constexpr int kJoints = 4;

using Random = std::mt19937_64;

double uniform(Random& rng, double low, double high) { return std::uniform_real_distribution<double>(low, high)(rng); }
std::size_t below(Random& rng, std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(rng); }

double strangeNumber(Random& rng) {
  const double values[] = {std::nan(""),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity(),
                           5e-324,
                           -5e-324,
                           -0.0,
                           1e308,
                           -1e308,
                           std::numeric_limits<double>::min(),
                           2.0000001,
                           -3.0,
                           uniform(rng, -2, 2)};
  return values[below(rng, std::size(values))];
}

void damage(Horizon& h, Random& rng) {
  if (h.points.empty()) return;
  auto& point = h.points[below(rng, h.points.size())];
  const auto joint = static_cast<Eigen::Index>(below(rng, kJoints));
  const auto put = [&](Eigen::VectorXd& v) {
    if (v.size() > joint) v[joint] = strangeNumber(rng);
  };
  switch (below(rng, 14)) {
    case 0: put(point.positions); break;
    case 1: put(point.velocities); break;
    case 2: put(point.accelerations); break;
    case 3: point.t = strangeNumber(rng); break;
    case 4: point.t = h.points[below(rng, h.points.size())].t; break;
    case 5: point.velocities.conservativeResize(static_cast<Eigen::Index>(below(rng, 6))); break;
    case 6: h.points.pop_back(); break;
    case 7: std::swap(point, h.points[below(rng, h.points.size())]); break;
    case 8: h.joint_names[below(rng, h.joint_names.size())] = "elbow"; break;
    case 9: h.owner = below(rng, 2) == 0 ? "" : "jog"; break;
    case 10: h.start_s += uniform(rng, -1, 1); break;
    case 11:
      for (auto& p : h.points) p.t *= uniform(rng, 0.2, 4);
      break;
    case 12:
      if (point.positions.size() > joint) point.positions[joint] += uniform(rng, -0.02, 0.02);
      break;
    default:
      if (point.velocities.size() > joint) point.velocities[joint] += uniform(rng, -0.2, 0.2);
  }
}

// What must hold for everything that passes, written without the gate's own code.
void expectHarmless(const Horizon& h, const MotionLimits& limits) {
  ASSERT_EQ(h.owner, "player");
  ASSERT_EQ(h.joint_names, jointNames(kJoints));
  ASSERT_GE(h.points.size(), 2u);
  ASSERT_EQ(h.points.front().t, 0);
  ASSERT_LE(h.points.back().t, 0.5);
  ASSERT_LE(h.points.back().velocities.lpNorm<Eigen::Infinity>(), 1e-4);
  for (std::size_t i = 0; i < h.points.size(); ++i) {
    const auto& p = h.points[i];
    ASSERT_TRUE(p.positions.allFinite() && p.velocities.allFinite() && p.accelerations.allFinite());
    for (int j = 0; j < kJoints; ++j) {
      ASSERT_LE(std::abs(p.positions[j]), std::max(2.0, std::abs(h.points.front().positions[j])) + 1e-5);
      ASSERT_LE(std::abs(p.velocities[j]), limits.max_velocity[j] * 1.011);
      if (i == 0) continue;
      const double dt = p.t - h.points[i - 1].t;
      ASSERT_GT(dt, 0);
      ASSERT_LE(std::abs(p.positions[j] - h.points[i - 1].positions[j]), limits.max_velocity[j] * dt * 1.02 + 1e-9);
      ASSERT_LE(std::abs(p.velocities[j] - h.points[i - 1].velocities[j]), limits.max_acceleration[j] * dt * 1.02 + 1e-9);
    }
  }
}

Horizon nextGood(GateRig& rig, Random& rng) {
  const auto now = rig.gate.commandedAt(rig.clock.now_s());
  const double speed = now->velocities.lpNorm<Eigen::Infinity>();
  if (speed > 0.01) {
    return brakingHorizon(now->positions, now->velocities / speed, speed, uniform(rng, 2.5, 3.9),
                          uniform(rng, 0, 0.08));
  }
  Eigen::VectorXd way(kJoints);
  for (int j = 0; j < kJoints; ++j) way[j] = uniform(rng, -0.03, 0.03);
  if (below(rng, 4) == 0) way = -0.02 * now->positions;   // back from the limits now and then
  return restToRest(now->positions, way, uniform(rng, 0.24, 0.5));
}

struct Outcome {
  int accepted = 0, refused = 0, stops = 0;
};

Outcome runRandomHorizons(int rounds, std::uint64_t seed) {
  Random rng(seed);
  GateRig rig(kJoints);
  rig.start();
  Outcome out;
  for (int i = 0; i < rounds && !testing::Test::HasFatalFailure(); ++i) {
    Horizon h = nextGood(rig, rng);
    h.sequence = ++rig.sequence;
    h.start_s = rig.clock.now_s();
    for (std::size_t k = below(rng, 4); k > 0; --k) damage(h, rng);
    const auto before = rig.gate.commandedAt(h.start_s);
    const auto received = rig.arm->horizonsReceived();
    if (rig.gate.submit(h).ok()) {
      ++out.accepted;
      expectHarmless(h, rig.limits);
      EXPECT_LT((h.points.front().positions - before->positions).lpNorm<Eigen::Infinity>(), 0.0201);
      EXPECT_LT((h.points.front().velocities - before->velocities).lpNorm<Eigen::Infinity>(), 0.0501);
    } else {
      ++out.refused;
      EXPECT_EQ(rig.arm->horizonsReceived(), received) << "what is refused is not sent";
    }
    rig.clock.advance(uniform(rng, 0, 0.1));
    if (below(rng, 50) != 0) continue;
    ++out.stops;
    rig.gate.stop("operator", "test");
    rig.clock.advance(0.1);              // speed <= 1 at deceleration 12
    EXPECT_EQ(rig.velocity().norm(), 0);
    rig.clock.advance(1);
    rig.start();
  }
  return out;
}

TEST(MotionGateProperty, NothingHarmfulPassesInAHundredThousandRandomHorizons) {
  const Outcome out = runRandomHorizons(100000, 11);
  EXPECT_GT(out.accepted, 20000) << "the gate must let good horizons through";
  EXPECT_GT(out.refused, 20000);
  EXPECT_GT(out.stops, 1000);
}

TEST(MotionGateProperty, EveryUndamagedHorizonPasses) {
  Random rng(5);
  GateRig rig(kJoints);
  rig.start();
  for (int i = 0; i < 5000; ++i) {
    const Status status = rig.submit(nextGood(rig, rng));
    ASSERT_TRUE(status.ok()) << status.error().message;
    rig.clock.advance(uniform(rng, 0, 0.1));
  }
}

TEST(MotionGatePropertyCampaign, NothingHarmfulPassesInAMillionRandomHorizons) { runRandomHorizons(1000000, 12); }

}  // namespace
}  // namespace longarm::hardware::tests
