#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "planning/trajectory/nominal_limits.h"
#include "planning/trajectory/time_law.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

Eigen::VectorXd vec(std::initializer_list<double> values) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double v : values) out[i++] = v;
  return out;
}

TimeLaw straightLaw(double distance, double v, double a, int cells) {
  std::vector<double> s;
  std::vector<PathConstraint> constraints;
  for (int i = 0; i <= cells; ++i) {
    s.push_back(distance * i / cells);
    constraints.push_back({vec({1}), vec({0}), 1e9});
  }
  return fastestTimeLaw(s, constraints, vec({v}), vec({a}));
}

std::vector<Eigen::VectorXd> randomCorners(unsigned seed, int count) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> joint(-2, 2);
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; i < count; ++i) {
    Eigen::VectorXd q(6);
    for (int j = 0; j < 6; ++j) q[j] = joint(engine);
    out.push_back(q);
  }
  return out;
}

const std::vector<std::string> kSix{"a", "b", "c", "d", "e", "f"};
const NominalLimits kLimits{Eigen::VectorXd::Constant(6, 0.5), Eigen::VectorXd::Constant(6, 0.6)};

TEST(TimeLaw, LastsExactlyAsLongAsTheTrapezoidOfTheTextbook) {
  EXPECT_NEAR(straightLaw(1, 0.5, 1, 200).duration(), 2.5, 1e-9);
  EXPECT_NEAR(straightLaw(0.1, 0.5, 1, 200).duration(), 2 * std::sqrt(0.1), 1e-6);
}

TEST(TimeLaw, KeepsTheAxisLimitsOnACircle) {
  // Three turns of radius 0.2 m at 1 m/s^2 per axis: a full-speed circle needs v^2 / r <= a.
  const int cells = 2000;
  const double r = 0.2, w = 6 * M_PI;
  std::vector<double> s;
  std::vector<PathConstraint> constraints;
  for (int i = 0; i <= cells; ++i) {
    const double u = static_cast<double>(i) / cells, c = std::cos(w * u), d = std::sin(w * u);
    s.push_back(u);
    constraints.push_back({vec({-r * w * d, r * w * c}), vec({-r * w * w * c, -r * w * w * d}), 1e9});
  }
  const TimeLaw law = fastestTimeLaw(s, constraints, vec({9, 9}), vec({1, 1}));
  const auto& x = law.squaredSpeeds();
  double worst = 0, fastest = 0;
  for (int i = 0; i < cells; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double u = (x[k + 1] - x[k]) * cells / 2;
    worst = std::max(worst, (constraints[k].dq * u + constraints[k].ddq * x[k]).cwiseAbs().maxCoeff());
    worst = std::max(worst, (constraints[k + 1].dq * u + constraints[k + 1].ddq * x[k + 1]).cwiseAbs().maxCoeff());
    fastest = std::max(fastest, std::sqrt(x[k]) * r * w);
  }
  EXPECT_LT(worst, 1 + 1e-6);
  EXPECT_GT(fastest, std::sqrt(r));   // between axes the limit is a square: faster than on a circle of accelerations
}

TEST(TimeLaw, SmoothingKeepsBothEndsAndTheDerivatives) {
  const TimeLaw law = straightLaw(1, 0.5, 1, 200);
  const double window = 0.1, h = 1e-5;
  EXPECT_NEAR(law.smoothedAt(0, window).s, 0, 1e-12);
  EXPECT_NEAR(law.smoothedAt(0, window).dds, 0, 1e-9);
  EXPECT_NEAR(law.smoothedAt(law.duration() + window, window).s, 1, 1e-9);
  EXPECT_NEAR(law.smoothedAt(law.duration() + window, window).ds, 0, 1e-9);
  for (double t = 0.05; t < 2.5; t += 0.137) {
    const auto now = law.smoothedAt(t, window), next = law.smoothedAt(t + h, window);
    EXPECT_NEAR((next.s - now.s) / h, now.ds, 2e-5) << t;   // h times half the acceleration
    EXPECT_LE(std::abs(now.dds), 1 + 1e-9) << t;
    EXPECT_LE(now.ds, 0.5 + 1e-9) << t;
  }
}

TEST(Parameterize, KeepsEveryLimitAsSampledAtOneKilohertz) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto corners = randomCorners(seed, 5);
    const BlendedPolyline path(corners, {0.3, 0.3, 0.3});
    const auto trajectory = parameterize(path, kSix, kLimits);
    ASSERT_TRUE(trajectory.ok());
    ASSERT_TRUE(validate(*trajectory).ok()) << validate(*trajectory).error().message;
    const LimitRatios ratios = limitRatios(*trajectory, kLimits.max_velocity, kLimits.max_acceleration);
    EXPECT_LT(ratios.velocity, 1 + 1e-6);
    EXPECT_LT(ratios.acceleration, 1 + 1e-6);
    EXPECT_GT(std::max(ratios.velocity, ratios.acceleration), 0.9);   // and is not needlessly slow
    for (std::size_t i = 1; i < trajectory->points.size(); ++i) {
      ASSERT_LE(trajectory->points[i].t - trajectory->points[i - 1].t, 0.02 + 1e-9);
    }
  }
}

TEST(Parameterize, StaysOnThePathBetweenItsPoints) {
  const auto corners = randomCorners(3, 4);
  const BlendedPolyline path(corners, {0.2, 0.2});
  const auto trajectory = parameterize(path, kSix, kLimits);
  ASSERT_TRUE(trajectory.ok());
  std::vector<Eigen::VectorXd> dense;
  for (int i = 0; i <= 40000; ++i) dense.push_back(path.at(path.length() * i / 40000).q);
  std::size_t near = 0;
  for (double t = 0; t < trajectory->duration(); t += 0.0037) {
    const Eigen::VectorXd q = trajectory->sample(t).positions;
    while (near + 1 < dense.size() && (dense[near + 1] - q).norm() <= (dense[near] - q).norm()) ++near;
    EXPECT_LT((dense[near] - q).norm(), 2e-4) << t;   // [rad]; a 1 m arm: 0.2 mm
  }
}

TEST(Parameterize, ObeysTheToolSpeed) {
  const BlendedPolyline path({vec({0, 0}), vec({1, 0.5})}, {});
  TimingOptions options;
  options.max_tool_speed = 0.1;
  options.tool_way = [](const PathState& state) { return std::abs(state.dq[0]) * 0.8; };
  const auto trajectory = parameterize(path, {"a", "b"}, {vec({1, 1}), vec({1, 1})}, options);
  ASSERT_TRUE(trajectory.ok());
  for (const auto& p : trajectory->points) EXPECT_LE(std::abs(p.velocities[0]) * 0.8, 0.1 + 1e-9);
  EXPECT_NEAR(trajectory->duration(), 8.2, 0.2);
}

TEST(Parameterize, RefusesWhatDoesNotFit) {
  const BlendedPolyline path({vec({0, 0}), vec({1, 0.5})}, {});
  EXPECT_NE(parameterize(path, {"a"}, {vec({1}), vec({1})}).error().message.find("path of 2 joints"), std::string::npos);
  EXPECT_NE(parameterize(path, {"a", "b"}, {vec({1, 0}), vec({1, 1})}).error().message.find("velocity limit 0"),
            std::string::npos);
}

TEST(Parameterize, EndsWhereverItIsStopped) {
  const BlendedPolyline path(randomCorners(4, 5), {0.1, 0.1, 0.1});
  int asked = 0;
  TimingOptions options;
  options.stop = [&] { return ++asked < 0; };
  ASSERT_TRUE(parameterize(path, kSix, kLimits, options).ok());
  const int all = asked;
  ASSERT_GT(all, 100);
  for (const int at : {1, all / 4, all / 2, 3 * all / 4, all}) {
    asked = 0;
    options.stop = [&, at] { return ++asked >= at; };
    const auto stopped = parameterize(path, kSix, kLimits, options);
    ASSERT_FALSE(stopped.ok()) << at << " of " << all;
    EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
    EXPECT_LE(asked, at + 1);
  }
}

TEST(BlendedPolyline, HasContinuousFirstAndSecondDerivatives) {
  const BlendedPolyline path({vec({0, 0}), vec({1, 0}), vec({1, 2}), vec({0, 2.5})}, {0.3, 0.1});
  const double h = 1e-6;
  for (double s = 0.01; s < path.length(); s += 0.0173) {
    const PathState before = path.at(s - h), here = path.at(s), after = path.at(s + h);
    EXPECT_LT(((after.q - before.q) / (2 * h) - here.dq).norm(), 1e-4) << s;
    EXPECT_LT(((after.dq - before.dq) / (2 * h) - here.ddq).norm(), 2e-3) << s;
  }
  EXPECT_LT((path.at(0).q - vec({0, 0})).norm(), 1e-12);
  EXPECT_LT((path.at(path.length()).q - vec({0, 2.5})).norm(), 1e-9);
}

TEST(SplinePath, PassesThroughItsWaypointsSmoothly) {
  std::vector<double> s;
  std::vector<Eigen::VectorXd> q;
  for (int i = 0; i <= 20; ++i) {
    s.push_back(0.1 * i);
    q.push_back(vec({std::sin(0.1 * i), std::cos(0.1 * i)}));
  }
  const SplinePath path(s, q);
  for (int i = 0; i <= 20; ++i) EXPECT_LT((path.at(s[static_cast<std::size_t>(i)]).q - q[static_cast<std::size_t>(i)]).norm(), 1e-12);
  EXPECT_NEAR(path.at(1.05).q[0], std::sin(1.05), 1e-5);
  EXPECT_NEAR(path.at(1.05).dq[0], std::cos(1.05), 1e-4);
  EXPECT_NEAR(path.at(1.05).ddq[0], -std::sin(1.05), 1e-2);
}

// The promise of nominal_limits.h, by integrating the braking law at every instant of random trajectories.
TEST(NominalLimits, LeaveRoomToStopInsideTheHorizon) {
  MotionLimits limits;
  limits.max_velocity = Eigen::VectorXd::Constant(6, 1.5);
  limits.max_acceleration = Eigen::VectorXd::Constant(6, 4.0);
  const PlaybackReserve reserve;
  const NominalLimits nominal = nominalLimits(limits, reserve);
  EXPECT_LE(nominal.max_velocity[0], 0.75);
  EXPECT_LE(nominal.max_acceleration[0], 1.0);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const BlendedPolyline path(randomCorners(seed, 4), {0.3, 0.3});
    const auto trajectory = parameterize(path, kSix, nominal);
    ASSERT_TRUE(trajectory.ok());
    for (double start = 0; start < trajectory->duration(); start += 0.05) {
      for (const double sign : {1.0, -1.0}) {
        double tau = start, rate = reserve.stop_rate * sign, t = 0;
        const double beta = (nominal.max_velocity.array() / limits.max_acceleration.array()).maxCoeff();
        const double h = 1e-3;
        while (std::abs(rate) > 1e-9 && t < 1) {
          const TrajectoryPoint p = trajectory->sample(tau);
          double brake = (1 - rate * rate / 8) / beta;
          brake = std::min(brake, std::abs(rate) / h);
          const Eigen::VectorXd a = p.accelerations * rate * rate - p.velocities * (brake * sign);
          ASSERT_LE(a.cwiseAbs().maxCoeff(), limits.max_acceleration[0] + 1e-6) << start;
          rate -= sign * brake * h;
          tau += rate * h;
          t += h;
        }
        ASSERT_LE(t, reserve.stop_s + 0.003) << start;   // Euler steps of 1 ms
      }
    }
  }
}

}  // namespace
}  // namespace longarm::planning
