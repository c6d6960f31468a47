// Corrections of a motion: off the path by exactly what was asked, back onto it within its stage, free and within limits.
#include <gtest/gtest.h>

#include "planning/macros/correction.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::contextOf;
using tests::featureOf;
using tests::toolAt;

const Workcell& cell() { return tests::builtIn(); }

class CorrectionTest : public ::testing::Test {
 protected:
  CorrectionTest() {
    m_context = contextOf(cell(), "ready");
    m_context.arguments = {{"stand_off", 0.15}};
    m_context.budget_s = 60;
    const vision::Feature point = featureOf(vision::FeatureKind::kPoint, {{0.8, 0.1, 0.5}});
    m_plan = tests::macroOf("touch").plan(m_context, &point);
    m_context.arguments.clear();
  }
  void SetUp() override {
    ASSERT_TRUE(m_plan.ok()) << m_plan.reason;
    for (double s = 0; s <= m_plan.trajectory.duration(); s += 0.005) m_path.push_back(toolAt(cell(), m_plan, s).translation());
  }

  // The distance of the corrected tool path from the planned one, from a place on.
  double farthestFromPath(const Plan& corrected, double from, double to) const {
    double worst = 0;
    for (double t = from; t <= to; t += 0.02) {
      const Vector3d p = toolAt(cell(), corrected, t).translation();
      double nearest = 1;
      for (const auto& planned : m_path) nearest = std::min(nearest, (planned - p).norm());
      worst = std::max(worst, nearest);
    }
    return worst;
  }

  PlanContext m_context;
  Plan m_plan;
  std::vector<Vector3d> m_path;            // of the tool, 5 ms apart
};

TEST_F(CorrectionTest, GoesWhereItIsAskedAndMeetsThePathAgain) {
  for (const std::size_t stage : {std::size_t{0}, m_plan.stages.size() - 1}) {
    const double tau = 0.5 * (m_plan.stages[stage].start_s + m_plan.stages[stage].end_s);
    for (const Nudge& nudge : {Nudge{Eigen::Matrix3d::Identity(), {0, 0, 0.005}, {0, 0, 0}}, Nudge{toolAt(cell(), m_plan, tau).linear(), {0.005, 0, 0}, {0, 0, 0.0873}}}) {
      const auto corrected = correctPlan(m_context, m_plan, tau, nudge);
      ASSERT_TRUE(corrected.ok()) << m_plan.stages[stage].name << ": " << corrected.error().message;
      const Plan& plan = corrected->plan;
      EXPECT_LT((toolAt(cell(), plan, corrected->leave_s).translation() - toolAt(cell(), m_plan, tau).translation()).norm(), 1e-6);
      const Pose wanted = nudged(toolAt(cell(), m_plan, tau), nudge), there = toolAt(cell(), plan, corrected->reached_s);
      EXPECT_LT((there.translation() - wanted.translation()).norm(), 1e-5);
      EXPECT_LT(angleBetween(there.linear(), wanted.linear()), 1e-5);
      EXPECT_LT(plan.trajectory.sample(corrected->reached_s).velocities.norm(), 1e-9) << "the arm can rest there";
      const Pose end = toolAt(cell(), plan, plan.trajectory.duration()), planned = toolAt(cell(), m_plan, m_plan.trajectory.duration());
      EXPECT_LT((end.translation() - planned.translation()).norm(), 1e-6) << "the plan's own end";
      EXPECT_LT(farthestFromPath(plan, 0, corrected->leave_s), 1e-3) << "what was played is kept, to be backed up over";
      EXPECT_LT(farthestFromPath(plan, plan.trajectory.duration() - 0.5, plan.trajectory.duration()), 1e-3);
      const CheckReport report = tests::sweepOf(cell(), plan, {});
      for (const auto& v : report.violations) ADD_FAILURE() << v.sentence;
      EXPECT_LE(plan.max_velocity_ratio, 0.5 + 1e-6);
      EXPECT_LE(plan.max_acceleration_ratio, 0.25 + 1e-6);
    }
  }
}

TEST_F(CorrectionTest, AtTheEndIsTheNewEnd) {
  const double end = m_plan.trajectory.duration();
  const auto corrected = correctPlan(m_context, m_plan, end, {Eigen::Matrix3d::Identity(), {0, 0.02, 0}, {0, 0, 0}});
  ASSERT_TRUE(corrected.ok()) << corrected.error().message;
  EXPECT_NEAR(corrected->leave_s, end, 1e-9);
  EXPECT_EQ(corrected->reached_s, corrected->plan.trajectory.duration());
  EXPECT_LT((corrected->plan.goal.translation() - m_plan.goal.translation() - Vector3d(0, 0.02, 0)).norm(), 1e-5);
}

TEST_F(CorrectionTest, OneAfterAnotherAddUp) {
  const double tau = 0.5 * (m_plan.stages.back().start_s + m_plan.stages.back().end_s);
  const Nudge up{Eigen::Matrix3d::Identity(), {0, 0, 0.005}, {0, 0, 0}};
  const auto once = correctPlan(m_context, m_plan, tau, up);
  ASSERT_TRUE(once.ok()) << once.error().message;
  const auto twice = correctPlan(m_context, once->plan, once->reached_s, up);
  ASSERT_TRUE(twice.ok()) << twice.error().message;
  const Vector3d way = toolAt(cell(), twice->plan, twice->reached_s).translation() - toolAt(cell(), m_plan, tau).translation();
  EXPECT_LT((way - Vector3d(0, 0, 0.01)).norm(), 1e-5);
  EXPECT_LT((twice->plan.goal.translation() - m_plan.goal.translation()).norm(), 1e-6);
}

TEST_F(CorrectionTest, IsRefusedIntoABodyAndBeyondItsLimits) {
  const double end = m_plan.trajectory.duration();
  const Vector3d p = m_plan.goal.translation();
  PlanContext walled = m_context;
  walled.objects = {tests::boxObject("wall", {0.4, 0.02, 0.4}, {p.x(), p.y() + 0.10, p.z()})};
  const auto blocked = correctPlan(walled, m_plan, end, {Eigen::Matrix3d::Identity(), {0, 0.1, 0}, {0, 0, 0}});
  ASSERT_FALSE(blocked.ok());
  EXPECT_EQ(blocked.error().code, ErrorCode::kCollision) << blocked.error().message;
  EXPECT_NE(blocked.error().message.find("wall"), std::string::npos) << blocked.error().message;
  EXPECT_EQ(correctPlan(m_context, m_plan, end, {Eigen::Matrix3d::Identity(), {0, 0.2, 0}, {0, 0, 0}}).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(correctPlan(m_context, m_plan, end, {Eigen::Matrix3d::Identity(), {0, std::nan(""), 0}, {0, 0, 0}}).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(correctPlan(m_context, Plan(), 0, {}).error().code, ErrorCode::kRefused);
}

}  // namespace
}  // namespace longarm::planning
