#include <random>

#include <gtest/gtest.h>

#include "app/virtual_robot/arm_motion.h"
#include "planning/player/player.h"
#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::VectorXd;

const std::vector<std::string> kJoints = {"a", "b"};

MotionLimits limits() {
  MotionLimits out;
  out.lower = VectorXd::Constant(2, -3);
  out.upper = VectorXd::Constant(2, 3);
  out.max_velocity = VectorXd::Constant(2, 1.5);
  out.max_acceleration = VectorXd::Constant(2, 4);
  out.stop_deceleration = VectorXd::Constant(2, 15);
  return out;
}

VectorXd pair(double a, double b) { return (VectorXd(2) << a, b).finished(); }

ArmMotion armAt(const VectorXd& start, double latency_s = 0) { return {kJoints, start, limits(), {latency_s}}; }

Trajectory pathOf(const Horizon& horizon) { return {horizon.joint_names, horizon.points}; }

TEST(VirtualArm, FollowsAHorizonToTheLastDigit) {
  ArmMotion arm = armAt(pair(0, 0));
  const Horizon horizon = quinticTo(kJoints, pair(0, 0), pair(0.5, -0.3), 1.0);
  ASSERT_TRUE(arm.accept(horizon, 2.0).ok());
  for (double t = 0; t <= 1.2; t += 0.013) {
    const auto wanted = pathOf(horizon).sample(t);
    const auto got = arm.commandedAt(2.0 + t);
    EXPECT_LT((got.positions - wanted.positions).norm(), 1e-12) << "at " << t;
    EXPECT_LT((got.velocities - wanted.velocities).norm(), 1e-10) << "at " << t;
  }
  EXPECT_FALSE(arm.moving(3.1));
}

TEST(VirtualArm, ActsAfterItsLatencyAndKeepsTheSchedule) {
  ArmMotion arm = armAt(pair(0, 0), 0.02);
  Horizon horizon = quinticTo(kJoints, pair(0, 0), pair(0.5, 0), 1.0);
  horizon.start_s = 5.0;
  ASSERT_TRUE(arm.accept(horizon, 5.001).ok());
  EXPECT_FALSE(arm.moving(5.015));
  const auto wanted = pathOf(horizon).sample(0.4);
  EXPECT_LT((arm.commandedAt(5.42).positions - wanted.positions).norm(), 1e-12);
}

TEST(VirtualArm, TakesTheJointsInAnyOrder) {
  ArmMotion arm = armAt(pair(0.1, 0.2));
  Horizon horizon = quinticTo({"b", "a"}, pair(0.2, 0.1), pair(0.3, 0.1), 0.5);
  ASSERT_TRUE(arm.accept(horizon, 0).ok());
  EXPECT_NEAR(arm.commandedAt(1).positions[1], 0.3, 1e-12);
  EXPECT_NEAR(arm.commandedAt(1).positions[0], 0.1, 1e-12);
}

struct Refusal {
  const char* name;
  std::function<void(Horizon&)> spoil;
  ErrorCode code;
  const char* says;
};

TEST(VirtualArm, RefusesWhatItMustAndKeepsWhatItHad) {
  const std::vector<Refusal> cases = {
      {"wrong joint", [](Horizon& h) { h.joint_names[1] = "c"; }, ErrorCode::kInvalidInput, "not the 2 of the arm"},
      {"no points", [](Horizon& h) { h.points.clear(); }, ErrorCode::kInvalidInput, "0 points"},
      {"not a number", [](Horizon& h) { h.points[3].positions[1] = std::nan(""); }, ErrorCode::kInvalidInput, "point 3"},
      {"infinite", [](Horizon& h) { h.points[3].velocities[0] = INFINITY; }, ErrorCode::kInvalidInput, "not finite"},
      {"times fall", [](Horizon& h) { h.points[4].t = 0.1; }, ErrorCode::kInvalidInput, "times increase"},
      {"moving end", [](Horizon& h) { h.points.pop_back(); }, ErrorCode::kInvalidInput, "ends at rest"},
      {"beyond limits", [](Horizon& h) { h.points[5].positions[0] = 3.2; }, ErrorCode::kOutOfLimits, "3.2"},
      {"too fast", [](Horizon& h) { h.points[5].velocities[0] = 1.7; }, ErrorCode::kOutOfLimits, "1.7"},
      {"too hard", [](Horizon& h) { h.points[5].accelerations[0] = 99; }, ErrorCode::kOutOfLimits, "99"},
      {"a jump", [](Horizon& h) { for (auto& p : h.points) p.positions[0] += 0.1; }, ErrorCode::kRefused, "jump"},
      {"over", [](Horizon& h) { h.start_s = 7; }, ErrorCode::kStale, "over"},
      {"far ahead", [](Horizon& h) { h.start_s = 20; }, ErrorCode::kStale, "ahead"},
  };
  for (const auto& c : cases) {
    ArmMotion arm = armAt(pair(0, 0));
    const Horizon first = quinticTo(kJoints, pair(0, 0), pair(0.5, 0.5), 2.0);
    ASSERT_TRUE(arm.accept(first, 9).ok());
    const auto here = arm.commandedAt(10).positions;
    Horizon next = quinticTo(kJoints, here, here + pair(0.1, 0.1), 0.5, 10);
    c.spoil(next);
    const auto status = arm.accept(next, 10);
    ASSERT_FALSE(status.ok()) << c.name;
    EXPECT_EQ(status.error().code, c.code) << c.name << ": " << status.error().message;
    EXPECT_NE(status.error().message.find(c.says), std::string::npos) << c.name << ": " << status.error().message;
    EXPECT_LT((arm.commandedAt(10.5).positions - pathOf(first).sample(1.5).positions).norm(), 1e-12) << c.name;
  }
}

TEST(VirtualArm, JoinsAHorizonThatDoesNotQuiteContinueTheMotionWithinItsLimits) {
  ArmMotion arm = armAt(pair(0, 0));
  ASSERT_TRUE(arm.accept(quinticTo(kJoints, pair(0, 0), pair(0.6, 0), 1.0), 0).ok());
  Horizon next = quinticTo(kJoints, pair(0.004, 0.003), pair(0.6, 0), 1.0);   // the same, 4 mrad off
  ASSERT_TRUE(arm.accept(next, 0.4).error().code == ErrorCode::kRefused);     // it would have to go back to its start
  next.start_s = 0.001;
  ASSERT_TRUE(arm.accept(next, 0.4).ok());
  for (double t = 0.4; t < 1.1; t += 0.001) {
    const auto p = arm.commandedAt(t);
    EXPECT_LE(p.velocities.cwiseAbs().maxCoeff(), 1.5 * 1.02) << "at " << t;
    EXPECT_LE(p.accelerations.cwiseAbs().maxCoeff(), 15 * 1.15) << "at " << t;
    EXPECT_LT((arm.commandedAt(t + 0.001).positions - p.positions).norm(), 0.0025) << "at " << t;
  }
  EXPECT_LT((arm.commandedAt(1.2).positions - pair(0.6, 0)).norm(), 1e-12);
}

TEST(VirtualArm, StopBrakesAlongThePathAtItsDeceleration) {
  ArmMotion arm = armAt(pair(0, 0), 0.02);
  const Horizon horizon = quinticTo(kJoints, pair(0, 0), pair(1.2, -0.6), 2.0);
  ASSERT_TRUE(arm.accept(horizon, 0).ok());
  arm.stop(1.0);
  double rest_s = 1.0;
  for (double t = 1.0; t < 2.5; t += 0.001) {
    const auto p = arm.commandedAt(t);
    if (arm.moving(t)) rest_s = t;
    EXPECT_NEAR(p.positions[1], -0.5 * p.positions[0], 1e-9) << "left the path at " << t;
    EXPECT_LE(p.accelerations.cwiseAbs().maxCoeff(), 15 * 1.12) << "at " << t;   // between points of 4 ms
  }
  EXPECT_LT(rest_s - 1.0, 0.12);
  EXPECT_GT(arm.commandedAt(2.5).positions[0], pathOf(horizon).sample(1.0).positions[0]);
}

TEST(VirtualArm, BrakesAtOnceAndForgetsWhatWasToCome) {
  ArmMotion arm = armAt(pair(0, 0), 0.05);
  ASSERT_TRUE(arm.accept(quinticTo(kJoints, pair(0, 0), pair(1, 0), 1.5), 0).ok());
  arm.brake(0.02);                       // before the latency is over
  EXPECT_LT(arm.commandedAt(2).positions.norm(), 1e-12);
}

// The console's own player streams to the arm over a link that delays each horizon differently.
class Streaming {
 public:
  explicit Streaming(unsigned seed) : m_random(seed) {}

  void run(ArmMotion& arm, planning::Player& player, double seconds) {
    const Trajectory& path = player.trajectory();
    std::vector<std::pair<double, Horizon>> travelling;
    std::uniform_real_distribution<double> delay(0.0005, 0.015);
    VectorXd before = arm.commandedAt(0).positions;
    double next_s = 0;
    for (double t = 0.005; t < seconds; t += 0.005) {
      while (!travelling.empty() && travelling.front().first <= t) {
        const auto status = arm.accept(travelling.front().second, travelling.front().first);
        EXPECT_TRUE(status.ok()) << status.error().message;
        travelling.erase(travelling.begin());
      }
      if (t >= next_s) {
        change(player);
        Horizon horizon = player.tick(t);
        if (!horizon.points.empty()) {
          const double arrival = t + delay(m_random);
          travelling.emplace_back(travelling.empty() ? arrival : std::max(arrival, travelling.back().first), horizon);
        }
        next_s = t + 0.02;
      }
      const VectorXd now = arm.commandedAt(t).positions;
      EXPECT_LE(((now - before) / 0.005).cwiseAbs().maxCoeff(), 1.5 * 1.01) << "too fast at " << t;
      m_worst = std::max(m_worst, offPath(path, now));
      before = now;
    }
  }
  double worst() const { return m_worst; }

 private:
  void change(planning::Player& player) {
    const unsigned dice = m_random() % 40;
    if (dice == 0) player.setSpeed(std::uniform_real_distribution<double>(-2, 2)(m_random));
    if (dice == 1) player.pause();
    if (dice <= 3) player.play();
  }
  static double offPath(const Trajectory& path, const VectorXd& q) {
    double best = 1e9;
    for (double t = 0; t <= path.duration(); t += 0.001) {
      best = std::min(best, (path.sample(t).positions - q).cwiseAbs().maxCoeff());
    }
    return best;
  }
  std::mt19937 m_random;
  double m_worst = 0;
};

TEST(VirtualArm, StaysOnThePathUnderAPlayerThatPlaysPausesAndReverses) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const VectorXd zero = VectorXd::Zero(2);
    const Trajectory path{kJoints, {{0, pair(0, 0), zero, zero}, {1.5, pair(0.4, 0.3), pair(0.2, -0.1), zero},
                                    {3.0, pair(0.5, -0.1), zero, zero}}};
    planning::Player player(limits());
    ASSERT_TRUE(player.load(path).ok());
    player.play();
    ArmMotion arm = armAt(pair(0, 0), seed % 2 == 0 ? 0.02 : 0.0);
    Streaming link(seed);
    link.run(arm, player, 6);
    EXPECT_LT(link.worst(), 0.0015) << "seed " << seed;   // 1 ms of motion between samples of the path
  }
}

}  // namespace
}  // namespace longarm::virtual_robot
