// How near a plan comes to things: told over its whole time, never more than there is.
#include <cmath>

#include <gtest/gtest.h>

#include "planning/collision/collision_world.h"
#include "planning/macros/correction.h"
#include "planning/motion/clearance.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;

const Workcell& cell() { return tests::builtIn(); }

TEST(ClearanceProfile, TakesTheSmallerOfTwoNeighbours) {
  const ClearanceProfile profile{{0, 0.08}, {1, 0.03}, {2, 0.06}, {2, 0.01}, {3, 0.2}};
  EXPECT_EQ(clearanceAt(profile, -1), 0.08);
  EXPECT_EQ(clearanceAt(profile, 0), 0.08);
  EXPECT_EQ(clearanceAt(profile, 0.2), 0.03);
  EXPECT_EQ(clearanceAt(profile, 1.5), 0.03);
  EXPECT_EQ(clearanceAt(profile, 2), 0.01) << "two stages meet there";
  EXPECT_EQ(clearanceAt(profile, 2.5), 0.01);
  EXPECT_EQ(clearanceAt(profile, 9), 0.2);
  EXPECT_EQ(leastClearance(profile).t_s, 2);
}

TEST(ClearanceProfile, HasTwoLimits) {
  EXPECT_EQ(bandOf(0), ClearanceBand::kTight);
  EXPECT_EQ(bandOf(0.0199), ClearanceBand::kTight);
  EXPECT_EQ(bandOf(0.02), ClearanceBand::kNear);
  EXPECT_EQ(bandOf(0.05), ClearanceBand::kFree);
}

class PlanClearance : public ::testing::Test {
 protected:
  // Past a post that stands beside the way to a point.
  Plan planned() {
    m_context = tests::contextOf(cell(), "home");
    m_context.budget_s = 60;
    m_context.objects = {tests::boxObject("post", {0.05, 0.05, 0.6}, {0.62, 0.22, 0.3})};
    const auto point = tests::featureOf(vision::FeatureKind::kPoint, {{0.7, 0.05, 0.5}});
    return tests::macroOf("touch").plan(m_context, &point);
  }
  // How far the robot and the post are apart at an instant, by a world of its own.
  double apart(const Plan& plan, double t) const {
    CollisionOptions options;
    options.moving = movingIndices(*cell().model, cell().arm);
    return CollisionWorld(cell().model, m_context.objects, allowedPairs(cell()), options).clearances(tests::planAt(cell(), plan, t)).first;
  }
  PlanContext m_context;
};

TEST_F(PlanClearance, CoversTheWholeMotionAndIsWhatTheBodiesAreApart) {
  const Plan plan = planned();
  ASSERT_TRUE(plan.ok()) << plan.reason;
  ASSERT_FALSE(plan.clearance.empty());
  EXPECT_EQ(plan.clearance.front().t_s, 0);
  EXPECT_NEAR(plan.clearance.back().t_s, plan.trajectory.duration(), 1e-9);
  double before = 0;
  for (const auto& sample : plan.clearance) {
    EXPECT_GE(sample.t_s, before);
    EXPECT_LE(sample.t_s - before, 0.0801) << "looked at every 80 ms";
    before = sample.t_s;
    const double truly = apart(plan, sample.t_s);
    if (sample.distance < kClearanceTold) EXPECT_NEAR(sample.distance, truly, 1e-6) << sample.t_s;
    else EXPECT_GE(truly, kClearanceTold - 1e-9) << sample.t_s;
  }
  EXPECT_LT(leastClearance(plan.clearance).distance, kClearanceTold) << "the post is passed";
  EXPECT_LE(plan.min_clearance, leastClearance(plan.clearance).distance) << "that of the arm's own links too";
}

TEST_F(PlanClearance, OfAMotionThatFailedIsEmpty) {
  PlanContext context = tests::contextOf(cell(), "home");
  const auto far = tests::featureOf(vision::FeatureKind::kPoint, {{5, 0, 0.5}});
  EXPECT_TRUE(tests::macroOf("touch").plan(context, &far).clearance.empty());
}

TEST_F(PlanClearance, GoesWithACorrection) {
  const Plan plan = planned();
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const double tau = plan.stages.front().start_s + 0.5 * (plan.stages.front().end_s - plan.stages.front().start_s);
  PlanContext context = m_context;
  context.start = tests::planAt(cell(), plan, tau);
  const auto corrected = correctPlan(context, plan, tau, {Eigen::Matrix3d::Identity(), {0, 0, 0.005}, Vector3d::Zero()});
  ASSERT_TRUE(corrected.ok()) << corrected.error().message;
  const Plan& now = corrected->plan;
  EXPECT_NEAR(now.clearance.back().t_s, now.trajectory.duration(), 1e-6);
  for (std::size_t i = 1; i < now.clearance.size(); ++i) EXPECT_GE(now.clearance[i].t_s, now.clearance[i - 1].t_s - 1e-9);
  const double there = now.clearance[now.clearance.size() / 2].t_s;
  EXPECT_LE(clearanceAt(now.clearance, there), apart(now, there) + 1e-6);
}

}  // namespace
}  // namespace longarm::planning
