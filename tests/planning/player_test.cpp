#include "planning/player/player.h"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "planning/trajectory/nominal_limits.h"
#include "tests/planning/player_fixture.h"

namespace longarm::planning {
namespace {

using testing::limitsOf;
using testing::receiverAt;
using testing::Shares;
using testing::SmoothMotion;
using testing::trapezoid;

// What the planner leaves at speed 1 (planning/trajectory/nominal_limits.h).
constexpr Shares kPlanned{0.44, 0.125};
constexpr double kTick_s = 0.02;

class PlayerTest : public ::testing::Test {
 protected:
  void load(unsigned seed = 1, Shares shares = kPlanned) {
    m_path = SmoothMotion(m_limits, seed).timed(m_limits, shares);
    ASSERT_TRUE(m_player.load(m_path).ok());
  }
  // Ticks until `seconds` have passed or nothing is sent any more.
  void run(double seconds) {
    for (double end = m_now + seconds; m_now < end; m_now += kTick_s) {
      const Horizon next = m_player.tick(m_now);
      if (next.points.empty()) continue;
      m_sent.push_back(next);
    }
  }
  void runToRest(double at_most = 100) {
    for (double end = m_now + at_most; m_now < end; m_now += kTick_s) {
      const Horizon next = m_player.tick(m_now);
      if (next.points.empty()) return;
      m_sent.push_back(next);
    }
    FAIL() << "still moving after " << at_most << " s";
  }

  MotionLimits m_limits = limitsOf(6, 1.0, 5.0);
  Player m_player{m_limits};
  Trajectory m_path;
  double m_now = 100;
  std::vector<Horizon> m_sent;
};

TEST_F(PlayerTest, PlaysToTheEndAndStopsExactlyThere) {
  load();
  m_player.play();
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kDone);
  const auto& last = m_sent.back().points.back();
  EXPECT_LT((last.positions - m_path.points.back().positions).norm(), 1e-9);
  EXPECT_EQ(last.velocities.norm(), 0);
  EXPECT_DOUBLE_EQ(m_player.cursor(), m_path.duration());
}

// Twice as fast but where a stop from there would take longer than a horizon has.
TEST_F(PlayerTest, PlannedMotionRunsAtTwiceItsSpeed) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    load(seed);
    m_player.setSpeed(2);
    m_player.play();
    const double start = m_now;
    double fastest = 0;
    while (m_player.state() == PlayerState::kPlaying && m_now < start + 100) {
      run(kTick_s);
      fastest = std::max(fastest, m_player.rate());
    }
    EXPECT_LT(m_now - start, 1.15 * 0.5 * m_path.duration() + 0.4) << "seed " << seed;
    EXPECT_NEAR(fastest, 2, 1e-6) << "seed " << seed;
  }
}

TEST_F(PlayerTest, SpeedOneKeepsToThePlansOwnTiming) {
  load();
  m_player.play();
  const double start = m_now;
  runToRest();
  EXPECT_LT(m_now - start, m_path.duration() + 0.25);
}

TEST_F(PlayerTest, PausingComesToRestOnThePathWithinTheHorizon) {
  load();
  m_player.play();
  run(2);
  m_player.pause();
  EXPECT_EQ(m_player.state(), PlayerState::kPausing);
  const double start = m_now;
  runToRest();
  EXPECT_LE(m_now - start, 0.19 + kTick_s + 1e-9);
  EXPECT_EQ(m_player.state(), PlayerState::kPaused);
  EXPECT_EQ(m_player.rate(), 0);
  const auto& rest = m_sent.back().points.back();
  EXPECT_LT((rest.positions - m_path.sample(m_player.cursor()).positions).norm(), 1e-12);
}

// At any instant, whatever the motion and its speed: rest on the path within 200 ms of the command, limits kept.  The command
// comes between two ticks, at any time of the 20 ms.
TEST_F(PlayerTest, PausingAtAnyInstantOfAPlannedMotionRestsWithinTwoTenthsOfASecond) {
  double slowest = 0;
  int paused = 0;
  for (unsigned seed = 1; seed <= 240; ++seed) {
    std::mt19937 random(seed);
    const auto uniform = [&random](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    const double most_velocity = uniform(0.3, 2), most_acceleration = uniform(0.5, 10);
    const MotionLimits limits = limitsOf(6, most_velocity, most_acceleration);
    const NominalLimits nominal = nominalLimits(limits);
    const Trajectory path = SmoothMotion(limits, seed)
                                .timed(limits, {nominal.max_velocity[0] / most_velocity, nominal.max_acceleration[0] / most_acceleration});
    Player player(limits);
    ASSERT_TRUE(player.load(path).ok());
    const bool back = seed % 3 == 0;
    ASSERT_TRUE(player.standAt(back ? path.duration() : 0).ok());
    const double speed = seed % 4 == 0 ? uniform(0.1, 2) : 2;
    player.setSpeed(back ? -speed : speed);
    player.play();
    double now = 10;
    for (double t = 0, end = uniform(0.02, 0.95) * path.duration() / speed; t < end; t += kTick_s) player.tick(now += kTick_s);
    const double commanded = now + uniform(0, 1) * kTick_s;
    player.pause();
    double rest = commanded;
    while (player.state() == PlayerState::kPausing) {
      const Horizon sent = player.tick(now += kTick_s);
      if (sent.points.empty()) continue;
      std::size_t last = sent.points.size() - 1;           // it may stand for a while at its end
      while (last > 0 && sent.points[last - 1].positions == sent.points[last].positions) --last;
      rest = sent.start_s + sent.points[last].t;
      for (double at = 0; at <= sent.duration(); at += 0.002) {
        const auto p = receiverAt(sent, sent.start_s + at);
        EXPECT_LE(p.velocities.cwiseAbs().maxCoeff(), most_velocity * (1 + 1e-6));
        EXPECT_LE(p.accelerations.cwiseAbs().maxCoeff(), most_acceleration * (1 + 1e-6));
      }
      EXPECT_LT((sent.points.front().positions - path.sample(player.armCursor()).positions).norm(), 1e-9);
      EXPECT_EQ(sent.points.back().velocities.norm(), 0);
    }
    if (player.state() != PlayerState::kPaused) continue;  // it had reached the end by then
    ++paused;
    EXPECT_LT(rest - commanded, 0.2) << "seed " << seed << " at " << player.speed() << "x";
    slowest = std::max(slowest, rest - commanded);
  }
  EXPECT_GT(paused, 150);
  EXPECT_GT(slowest, 0.15) << "or these motions are too easy to stop";
}

TEST_F(PlayerTest, AStepRestsAtTheEndOfAStageAndGoesOnFromThere) {
  load();
  Trajectory two = m_path;
  const double border = two.duration();
  for (std::size_t i = 1; i < m_path.points.size(); ++i) {  // and back the way it came
    auto p = m_path.points[m_path.points.size() - 1 - i];
    p.t = border + (border - p.t);
    p.velocities = -p.velocities;
    two.points.push_back(p);
  }
  two.points[m_path.points.size() - 1].accelerations.setZero();
  ASSERT_TRUE(m_player.load(two).ok());
  EXPECT_EQ(m_player.playUntil(0.5 * border).error().code, ErrorCode::kInvalidInput)
      << "the arm would not rest there";
  ASSERT_TRUE(m_player.playUntil(border).ok());
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kPaused);
  EXPECT_EQ(m_player.armCursor(), border);
  EXPECT_EQ(m_player.playUntil(border).error().code, ErrorCode::kRefused);
  m_player.play();
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kDone);
  m_player.setSpeed(-2);
  ASSERT_TRUE(m_player.playUntil(border).ok());
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kPaused);
  EXPECT_EQ(m_player.armCursor(), border);
  ASSERT_TRUE(m_player.playUntil(0).ok());
  run(1);
  m_player.halt();
  ASSERT_TRUE(m_player.resumeFrom(two.sample(m_player.armCursor()).positions).ok());
  m_player.play();
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kReady);
}

TEST_F(PlayerTest, APausedMotionGoesOnToTheEnd) {
  load();
  m_player.play();
  run(1);
  m_player.pause();
  runToRest();
  m_player.play();
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kDone);
}

TEST_F(PlayerTest, ReversingPassesThroughRestAndReturnsToTheStart) {
  load();
  m_player.play();
  run(2);
  m_player.setSpeed(-1);
  double slowest = 1, last_rate = m_player.rate();
  while (m_player.rate() > -0.99) {
    run(kTick_s);
    EXPECT_LE(m_player.rate(), last_rate + 1e-9);
    last_rate = m_player.rate();
    slowest = std::min(slowest, std::abs(last_rate));
  }
  EXPECT_LT(slowest, 0.2);
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kReady);
  EXPECT_EQ(m_player.cursor(), 0);
  EXPECT_LT((m_sent.back().points.back().positions - m_path.points.front().positions).norm(), 1e-9);
}

TEST_F(PlayerTest, SpeedZeroStandsStillWithoutSendingAnything) {
  load();
  m_player.play();
  run(1);
  m_player.setSpeed(0);
  runToRest(2);
  EXPECT_EQ(m_player.state(), PlayerState::kPlaying);
  EXPECT_EQ(m_player.rate(), 0);
  m_player.setSpeed(0.5);
  run(1);
  EXPECT_NEAR(m_player.rate(), 0.5, 1e-6);
}

TEST_F(PlayerTest, SpeedsBeyondTwoAreClampedAndNonsenseIsIgnored) {
  m_player.setSpeed(5);
  EXPECT_EQ(m_player.speed(), 2);
  m_player.setSpeed(-5);
  EXPECT_EQ(m_player.speed(), -2);
  m_player.setSpeed(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(m_player.speed(), -2);
}

TEST_F(PlayerTest, ScrubbingMovesOnlyTheCursor) {
  load();
  m_player.play();
  run(1);
  EXPECT_EQ(m_player.scrub(2).error().code, ErrorCode::kRefused);
  m_player.pause();
  runToRest();
  const double stands = m_player.cursor();
  ASSERT_TRUE(m_player.scrub(m_path.duration()).ok());
  EXPECT_EQ(m_player.cursor(), m_path.duration());
  EXPECT_TRUE(m_player.tick(m_now).points.empty());
  m_player.play();
  const Horizon next = m_player.tick(m_now);
  ASSERT_FALSE(next.points.empty());
  EXPECT_LT((next.points.front().positions - m_path.sample(stands).positions).norm(), 1e-12);
}

TEST_F(PlayerTest, AHaltedPlayerSendsNothingUntilItIsResumedFromThePath) {
  load();
  m_player.play();
  run(2);
  m_player.halt();
  EXPECT_EQ(m_player.state(), PlayerState::kHalted);
  EXPECT_EQ(m_player.rate(), 0);
  m_player.play();
  run(0.2);
  EXPECT_TRUE(m_player.tick(m_now).points.empty());

  const double stopped = m_player.cursor() + 0.08;
  Eigen::VectorXd measured = m_path.sample(stopped).positions;
  measured[2] += 0.2;
  const auto refused = m_player.resumeFrom(measured);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kStale);
  measured[2] -= 0.2;
  measured[0] += 0.004;
  ASSERT_TRUE(m_player.resumeFrom(measured).ok());
  EXPECT_EQ(m_player.state(), PlayerState::kPaused);
  const Eigen::VectorXd there = m_path.sample(m_player.cursor()).positions;
  EXPECT_LE((there - measured).cwiseAbs().maxCoeff(), 0.004 + 1e-9);
  EXPECT_NEAR(m_player.cursor(), stopped, 0.2);
  m_player.play();
  runToRest();
  EXPECT_EQ(m_player.state(), PlayerState::kDone);
}

TEST_F(PlayerTest, ALateTickGoesOnFromWhereTheLastHorizonLeads) {
  load();
  m_player.play();
  run(2);
  const Horizon before = m_sent.back();
  m_now = before.start_s + 0.11;
  const auto expected = receiverAt(before, m_now);
  const Horizon next = m_player.tick(m_now);
  ASSERT_FALSE(next.points.empty());
  EXPECT_LT((next.points.front().positions - expected.positions).norm(), 1e-5);
  m_now += 5;  // The console stood still for longer than the horizon.
  const auto rest = m_player.tick(m_now);
  ASSERT_FALSE(rest.points.empty());
  EXPECT_EQ(rest.points.front().velocities.norm(), 0);
}

TEST_F(PlayerTest, AMotionWithJumpsInItsAccelerationIsPlayedToTheEnd) {
  Player player{limitsOf(1, 1, 5)};
  const auto path = trapezoid(2, 0.4, 0.6);
  ASSERT_TRUE(player.load(path).ok());
  player.setSpeed(2);
  player.play();
  for (int i = 0; i < 1000 && player.state() == PlayerState::kPlaying; ++i, m_now += kTick_s) {
    const auto h = player.tick(m_now);
    for (const auto& p : h.points) {
      EXPECT_LE(std::abs(p.velocities[0]), 1 + 1e-6);
      EXPECT_LE(std::abs(p.accelerations[0]), 5 + 1e-6);
    }
  }
  EXPECT_EQ(player.state(), PlayerState::kDone);
}

TEST_F(PlayerTest, RefusesTrajectoriesThatBreakALimitNamingTheJoint) {
  load();
  Trajectory fast = m_path;
  fast.points[5].velocities[3] = 1.5;
  auto refused = m_player.load(fast);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kOutOfLimits);
  EXPECT_NE(refused.error().message.find("joint_4"), std::string::npos) << refused.error().message;

  Trajectory far = m_path;
  for (auto& p : far.points) p.positions[1] += 20;
  refused = m_player.load(far);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kOutOfLimits);

  Trajectory hard = m_path;
  hard.points[5].accelerations[0] = -6;
  EXPECT_EQ(m_player.load(hard).error().code, ErrorCode::kOutOfLimits);
}

TEST_F(PlayerTest, RefusesMalformedTrajectoriesAndTheWrongNumberOfJoints) {
  EXPECT_EQ(m_player.load({}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(m_player.load(trapezoid(1, 0.4, 0.6)).error().code, ErrorCode::kInvalidInput);
  load();
  Trajectory broken = m_path;
  broken.points[3].t = broken.points[2].t;
  EXPECT_EQ(m_player.load(broken).error().code, ErrorCode::kInvalidInput);
}

TEST_F(PlayerTest, WithNothingLoadedNothingMoves) {
  m_player.play();
  EXPECT_EQ(m_player.state(), PlayerState::kEmpty);
  EXPECT_TRUE(m_player.tick(1).points.empty());
  EXPECT_EQ(m_player.scrub(1).error().code, ErrorCode::kRefused);
  EXPECT_EQ(m_player.resumeFrom(Eigen::VectorXd::Zero(6)).error().code, ErrorCode::kRefused);
  m_player.halt();
  EXPECT_EQ(m_player.state(), PlayerState::kEmpty);
  load();
  m_player.clear();
  EXPECT_EQ(m_player.state(), PlayerState::kEmpty);
  EXPECT_EQ(m_player.duration(), 0);
}

TEST_F(PlayerTest, ATimeThatGoesBackwardsIsTakenAsStandingStill) {
  load();
  m_player.play();
  run(1);
  const double cursor = m_player.cursor();
  m_player.tick(m_now - 10);
  EXPECT_EQ(m_player.cursor(), cursor);
}

// Two motions one after the other, at rest between them: played no further than the border until it is opened.
class ConfinedPlayer : public ::testing::Test {
 protected:
  void SetUp() override {
    const Trajectory half = trapezoid(0.5, 0.4, 1);
    m_path = half;
    m_border = half.duration();
    for (std::size_t i = 1; i < half.points.size(); ++i) {
      TrajectoryPoint point = half.points[i];
      point.t += m_border;
      point.positions[0] += 0.5;
      m_path.points.push_back(point);
    }
    ASSERT_TRUE(m_player.load(m_path).ok());
  }
  double run(double seconds) {
    double furthest = 0, nearest = 1e9;
    for (double end = m_now + seconds; m_now < end;) {
      const Horizon horizon = m_player.tick(m_now += kTick_s);
      for (const auto& point : horizon.points) {
        furthest = std::max(furthest, point.positions[0]);
        nearest = std::min(nearest, point.positions[0]);
      }
    }
    m_least = nearest;
    return furthest;
  }
  Player m_player{limitsOf(1, 0.8, 4)};
  Trajectory m_path;
  double m_border = 0, m_now = 10, m_least = 0;
};

TEST_F(ConfinedPlayer, RestsAtTheBorderWhateverIsOrderedUntilItIsOpened) {
  ASSERT_TRUE(m_player.confine(0, m_border).ok());
  m_player.setSpeed(2);
  m_player.play();
  EXPECT_LE(run(2 * m_path.duration()), 0.5 + 1e-9) << "no horizon reaches beyond";
  EXPECT_EQ(m_player.state(), PlayerState::kPaused);
  EXPECT_NEAR(m_player.armCursor(), m_border, 1e-9);
  m_player.play();
  EXPECT_LE(run(1), 0.5 + 1e-9) << "another Play changes nothing";
  EXPECT_EQ(m_player.playUntil(m_path.duration()).error().code, ErrorCode::kRefused);
  ASSERT_TRUE(m_player.confine(m_border, m_path.duration()).ok());
  m_player.play();
  run(2 * m_path.duration());
  EXPECT_EQ(m_player.state(), PlayerState::kDone);
  m_player.setSpeed(-1);
  m_player.play();
  run(2 * m_path.duration());
  EXPECT_EQ(m_player.state(), PlayerState::kPaused);
  EXPECT_NEAR(m_player.armCursor(), m_border, 1e-9) << "and no way back over it";
  EXPECT_GE(m_least, 0.5 - 1e-6);
}

TEST_F(ConfinedPlayer, RefusesWhatIsNoRestingPartOfThePathAroundTheArm) {
  EXPECT_EQ(m_player.confine(0, m_border / 2).error().code, ErrorCode::kInvalidInput) << "not at rest there";
  EXPECT_EQ(m_player.confine(m_border, m_path.duration()).error().code, ErrorCode::kInvalidInput) << "the arm stands before it";
  EXPECT_EQ(m_player.confine(0, std::nan("")).error().code, ErrorCode::kInvalidInput);
  m_player.play();
  run(0.5);
  EXPECT_EQ(m_player.confine(0, m_border).error().code, ErrorCode::kRefused) << "it moves";
}

TEST_F(ConfinedPlayer, ALoadOpensThePathAndAStopKeepsTheBorder) {
  ASSERT_TRUE(m_player.confine(0, m_border).ok());
  m_player.play();
  run(0.8);
  m_player.halt();
  ASSERT_TRUE(m_player.resumeFrom(m_path.sample(m_player.armCursor()).positions).ok());
  m_player.play();
  EXPECT_LE(run(m_path.duration()), 0.5 + 1e-9);
  m_player.halt();
  EXPECT_EQ(m_player.resumeFrom(m_path.sample(m_border + 1).positions).error().code, ErrorCode::kStale) << "beyond it";
  ASSERT_TRUE(m_player.load(m_path).ok());
  m_player.play();
  EXPECT_NEAR(run(2 * m_path.duration()), 1.0, 1e-9);
}

}  // namespace
}  // namespace longarm::planning
