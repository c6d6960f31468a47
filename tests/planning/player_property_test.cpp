#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "planning/player/player.h"
#include "tests/planning/player_fixture.h"

namespace longarm::planning {
namespace {

using testing::distanceToPath;
using testing::limitsOf;
using testing::receiverAt;
using testing::Shares;
using testing::SmoothMotion;

// Largest shares of what was promised, over everything that was sent.
struct Worst {
  double velocity = 0, acceleration = 0;            // Of the limits, at the points.
  double seen_velocity = 0, seen_acceleration = 0;  // Of the limits, as a receiver interpolates, every 2 ms.
  double position_jump = 0, velocity_jump = 0;      // Between two horizons while they must agree.
  double off_path = 0, duration = 0;

  void merge(const Worst& other) {
    velocity = std::max(velocity, other.velocity);
    acceleration = std::max(acceleration, other.acceleration);
    seen_velocity = std::max(seen_velocity, other.seen_velocity);
    seen_acceleration = std::max(seen_acceleration, other.seen_acceleration);
    position_jump = std::max(position_jump, other.position_jump);
    velocity_jump = std::max(velocity_jump, other.velocity_jump);
    off_path = std::max(off_path, other.off_path);
    duration = std::max(duration, other.duration);
  }
};

// An operator who presses anything at any time, and a motion thread that is not always on time.
class RandomOperator {
 public:
  RandomOperator(unsigned seed, Shares shares)
      : m_random(seed),
        m_limits(limitsOf(static_cast<int>(1 + seed % 6), uniform(0.3, 2), uniform(0.3, 10))),
        m_path(SmoothMotion(m_limits, seed).timed(m_limits, shares, uniform(0.01, 0.04))),
        m_player(m_limits) {
    EXPECT_TRUE(m_player.load(m_path).ok());
  }

  Worst run(int inputs) {
    for (int i = 0; i < inputs; ++i) {
      press();
      const int ticks = static_cast<int>(uniform(1, 25));
      for (int k = 0; k < ticks; ++k) tick();
    }
    return m_worst;
  }

 private:
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(m_random); }

  void press() {
    const double which = uniform(0, 1);
    if (which < 0.27) return m_player.play();
    if (which < 0.30) {
      (void)m_player.playUntil(m_player.speed() > 0 ? m_path.duration() : 0).ok();
      return;
    }
    if (which < 0.45) return m_player.pause();
    if (which < 0.85) return m_player.setSpeed(uniform(-2.2, 2.2));
    if (which < 0.92) {
      const bool scrubbed = m_player.scrub(uniform(-1, 1.2 * m_path.duration())).ok();
      EXPECT_EQ(scrubbed,
                m_player.state() != PlayerState::kPlaying && m_player.state() != PlayerState::kPausing);
      return;
    }
    if (which < 0.96) {
      m_player.halt();
      m_last = {};
      return;
    }
    resume();
  }

  void resume() {
    if (m_player.state() != PlayerState::kHalted) return;
    Eigen::VectorXd measured = m_path.sample(m_player.cursor() + uniform(0, 0.1)).positions;
    for (auto& q : measured) q += uniform(-0.005, 0.005);
    EXPECT_TRUE(m_player.resumeFrom(measured).ok());
  }

  void tick() {
    m_now += uniform(0, 1) < 0.03 ? uniform(0.03, 0.5) : uniform(0.015, 0.025);
    const Horizon next = m_player.tick(m_now);
    if (next.points.empty()) {
      m_last = {};
      return;
    }
    ASSERT_NE(m_player.state(), PlayerState::kHalted);
    checkLimits(next);
    checkJoin(next);
    checkEnds(next);
    m_last = next;
  }

  void checkLimits(const Horizon& next) {
    for (const auto& p : next.points) {
      m_worst.velocity = std::max(m_worst.velocity, share(p.velocities, m_limits.max_velocity));
      m_worst.acceleration =
          std::max(m_worst.acceleration, share(p.accelerations, m_limits.max_acceleration));
    }
    for (double t = 0; t < next.duration(); t += 0.002) {
      const auto p = receiverAt(next, m_now + t);
      m_worst.seen_velocity = std::max(m_worst.seen_velocity, share(p.velocities, m_limits.max_velocity));
      m_worst.seen_acceleration =
          std::max(m_worst.seen_acceleration, share(p.accelerations, m_limits.max_acceleration));
    }
  }

  // A receiver may get the new horizon up to 40 ms late: until then both must say the same.
  void checkJoin(const Horizon& next) {
    if (m_last.points.empty()) return;
    for (double late = 0; late <= 0.04; late += 0.01) {
      const auto before = receiverAt(m_last, m_now + late), after = receiverAt(next, m_now + late);
      m_worst.position_jump = std::max(m_worst.position_jump, (before.positions - after.positions).norm());
      m_worst.velocity_jump = std::max(m_worst.velocity_jump, (before.velocities - after.velocities).norm());
    }
  }

  void checkEnds(const Horizon& next) {
    ASSERT_GE(next.points.size(), 2u);
    EXPECT_EQ(next.points.back().velocities.norm(), 0);
    EXPECT_LT((next.points.front().positions - m_path.sample(m_player.cursor()).positions).norm(), 1e-12);
    EXPECT_GT(next.sequence, m_last.sequence);
    m_worst.duration = std::max(m_worst.duration, next.duration());
    for (std::size_t i = 1; i < next.points.size(); ++i) {
      EXPECT_GE(next.points[i].t - next.points[i - 1].t, 0.001 - 1e-12);
      EXPECT_LE(next.points[i].t - next.points[i - 1].t, 0.022);
    }
    if (next.sequence % 50 == 0) {
      const double at = uniform(0, next.duration());
      const auto p = receiverAt(next, m_now + at);
      m_worst.off_path =
          std::max(m_worst.off_path, distanceToPath(m_path, p.positions, m_player.cursor(), 0.7));
    }
  }

  static double share(const Eigen::VectorXd& values, const Eigen::VectorXd& limits) {
    return values.cwiseAbs().cwiseQuotient(limits).maxCoeff();
  }

  std::mt19937 m_random;
  MotionLimits m_limits;
  Trajectory m_path;
  Player m_player;
  double m_now = 10;
  Horizon m_last;
  Worst m_worst;
};

Worst press(int operators, int inputs, Shares shares, unsigned first_seed) {
  Worst worst;
  for (int i = 0; i < operators; ++i) {
    worst.merge(RandomOperator(first_seed + static_cast<unsigned>(i), shares).run(inputs));
  }
  return worst;
}

void expectKept(const Worst& worst) {
  EXPECT_LE(worst.velocity, 1 + 1e-6);
  EXPECT_LE(worst.acceleration, 1 + 1e-6);
  EXPECT_LE(worst.seen_velocity, 1 + 1e-6);
  EXPECT_LE(worst.seen_acceleration, 1 + 1e-6);  // Of the receiver's own polynomial between exact points.
  EXPECT_LT(worst.position_jump, 1e-5);          // Two polynomials through different points of one motion.
  EXPECT_LT(worst.velocity_jump, 2e-3);
  EXPECT_LT(worst.off_path, 1e-4);
  EXPECT_LE(worst.duration, 0.19 + 1e-9);
  if (std::getenv("LONGARM_PRINT_FIGURES")) {
    std::printf("velocity %.6f acceleration %.6f seen %.6f %.6f jump %.2e %.2e off path %.2e\n",
                worst.velocity, worst.acceleration, worst.seen_velocity, worst.seen_acceleration,
                worst.position_jump, worst.velocity_jump, worst.off_path);
  }
}

TEST(PlayerProperty, PlannedMotionsKeepEveryPromiseUnderTenThousandRandomInputs) {
  const Worst worst = press(100, 100, {0.44, 0.125}, 1);
  expectKept(worst);
}

TEST(PlayerProperty, MotionsUpToTheLimitsKeepEveryPromiseToo) {
  const Worst worst = press(30, 60, {1, 1}, 1000);
  expectKept(worst);
}

TEST(PlayerPropertyCampaign, AnyMotionKeepsEveryPromiseUnderManyMoreInputs) {
  for (const Shares shares :
       {Shares{0.44, 0.125}, Shares{0.5, 0.25}, Shares{1, 0.5}, Shares{0.7, 1}, Shares{1, 1}}) {
    expectKept(press(100, 150, shares, 5000));
  }
}

}  // namespace
}  // namespace longarm::planning
