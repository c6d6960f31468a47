// A turn that is further than the arm reaches: the gripper lets go, goes back and grips again.
#include <cmath>

#include <gtest/gtest.h>

#include "planning/collision/collision_world.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;

const Workcell& cell() { return tests::builtIn(); }

// A wheel's axle ahead of the robot, and the arm with its rim in the hand.
class Regrip : public ::testing::Test {
 protected:
  void SetUp() override {
    m_axle = tests::featureOf(vision::FeatureKind::kLine, {m_middle + Vector3d(0.1, 0, 0), m_middle - Vector3d(0.1, 0, 0)}, 0.0005, "axle");
    const Vector3d rim = m_middle + Vector3d(0, 0, 0.11);
    const auto top = tests::featureOf(vision::FeatureKind::kLine, {rim + Vector3d(0, 0.05, 0), rim - Vector3d(0, 0.05, 0)}, 0.0005, "rim");
    PlanContext context = tests::contextOf(cell(), "home");
    context.budget_s = 60;
    context.arguments = {{"radius", 0.011}};
    const Plan there = tests::macroOf("approach_from_side").plan(context, &top);
    ASSERT_TRUE(there.ok()) << there.reason;
    m_start = tests::planAt(cell(), there, there.trajectory.duration());
    setFinger(0.011);
  }
  void setFinger(double position) {
    m_start[cell().model->joints()[static_cast<std::size_t>(*cell().model->jointIndex(cell().gripper->joint))].q_index] = position;
  }
  Plan turn(const std::map<std::string, double>& arguments, const std::vector<WorldObject>& objects = {}) {
    PlanContext context = tests::contextOf(cell(), "home");
    context.start = m_start;
    context.budget_s = 60;
    context.arguments = arguments;
    context.objects = objects;
    return tests::macroOf("move_around_axis").plan(context, &m_axle);
  }
  double radiusAt(const Plan& plan, double t) const {
    Vector3d arm = tests::toolAt(cell(), plan, t).translation() - m_middle;
    arm.x() = 0;
    return arm.norm();
  }
  static int grips(const Plan& plan) { return static_cast<int>(plan.figures.at("grips")); }

  const Vector3d m_middle{0.8, 0, 0.55};
  vision::Feature m_axle;
  Eigen::VectorXd m_start;
};

constexpr double kFar = 4.2;             // [rad]

TEST_F(Regrip, IsNotDoneWhereNobodyAskedForIt) {
  const Plan plan = turn({{"angle", kFar}});
  ASSERT_FALSE(plan.ok()) << "no wrist turns that far";
  EXPECT_EQ(plan.failed_stage, "act");
  const Plan near = turn({{"angle", 0.3}, {"regrip", 1}});
  ASSERT_TRUE(near.ok()) << near.reason;
  EXPECT_EQ(grips(near), 1);
  EXPECT_EQ(near.stages.size(), 1u) << "one turn is enough";
}

TEST_F(Regrip, LetsGoGoesBackAndGripsAgainUntilTheWholeTurnIsDone) {
  const Plan plan = turn({{"angle", kFar}, {"regrip", 1}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const int count = grips(plan);
  ASSERT_GT(count, 1);
  ASSERT_EQ(plan.stages.size(), static_cast<std::size_t>(4 * count - 3));
  const Pose X_start = tests::toolAt(cell(), plan, 0);
  double turned = 0;
  for (std::size_t i = 0; i < plan.stages.size(); ++i) {
    const PlanStage& stage = plan.stages[i];
    const Pose X_end = tests::toolAt(cell(), plan, stage.end_s);
    EXPECT_LT(plan.trajectory.sample(stage.end_s).velocities.cwiseAbs().maxCoeff(), 1e-9) << "the arm rests at " << stage.name;
    if (stage.name == "act") {
      EXPECT_EQ(stage.gripper.has_value(), i + 1 < plan.stages.size());
      if (stage.gripper) EXPECT_EQ(stage.gripper->position, cell().gripper->open);
      turned += angleBetween(tests::toolAt(cell(), plan, stage.start_s).linear(), X_end.linear());
      for (double t = stage.start_s; t <= stage.end_s; t += 0.02) ASSERT_NEAR(radiusAt(plan, t), 0.11, 1e-3) << "on the arc";
    } else if (stage.name == "approach") {
      ASSERT_TRUE(stage.gripper.has_value());
      EXPECT_TRUE(stage.gripper->grips);
      EXPECT_LT((X_end.translation() - X_start.translation()).norm(), 1e-4) << "grips where it gripped";
      EXPECT_LT(angleBetween(X_end.linear(), X_start.linear()), 1e-3);
    } else {
      EXPECT_FALSE(stage.gripper.has_value()) << stage.name;
    }
    if (stage.name != "return") continue;
    for (double t = stage.start_s; t <= stage.end_s; t += 0.05) {
      EXPECT_LT(tests::toolAt(cell(), plan, t).translation().x(), X_start.translation().x() - 0.05) << "well off the wheel on its way back";
    }
  }
  EXPECT_NEAR(turned, kFar, 2e-3);
  EXPECT_NE(plan.notes.back().find("lets go"), std::string::npos) << plan.notes.back();
}

TEST_F(Regrip, TurnsByWholeSpokesWhereTheHandleHasSome) {
  const double pitch = M_PI / 3;
  const Plan plan = turn({{"angle", kFar}, {"regrip", 1}, {"pitch", pitch}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_GT(grips(plan), 1);
  double left = kFar;
  for (const auto& stage : plan.stages) {
    if (stage.name != "act") continue;
    const double turned = angleBetween(tests::toolAt(cell(), plan, stage.start_s).linear(), tests::toolAt(cell(), plan, stage.end_s).linear());
    left -= turned;
    if (stage.gripper) EXPECT_NEAR(std::remainder(turned, pitch), 0, 2e-3) << "the hand finds the same handle again";
  }
  EXPECT_NEAR(left, 0, 4e-3);
}

// What was in the hand stays where it was turned to: the way back keeps clear of it.
TEST_F(Regrip, WhatWasLetGoOfIsInTheWay) {
  WorldObject rim;
  rim.name = "rim";
  rim.shape = Cylinder{0.011, 0.1};
  rim.X_WO.translation() = m_middle + Vector3d(0, 0, 0.11);
  rim.X_WO.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitX()).toRotationMatrix();
  const Plan plan = turn({{"angle", kFar}, {"regrip", 1}}, {rim});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  CollisionOptions options;
  options.moving = movingIndices(*cell().model, cell().arm);
  const double per_turn = kFar / grips(plan);
  int released = 0;
  for (const auto& stage : plan.stages) {
    if (stage.name == "act") ++released;
    if (stage.name != "return") continue;
    WorldObject there = rim;
    Pose turned = Pose::Identity();
    turned.linear() = Eigen::AngleAxisd(-released * per_turn, Vector3d::UnitX()).toRotationMatrix();
    turned.translation() = m_middle - turned.linear() * m_middle;
    there.X_WO = turned * rim.X_WO;
    const CollisionWorld world(cell().model, {there}, allowedPairs(cell()), options);
    for (double t = stage.start_s; t <= stage.end_s; t += 0.05) {
      EXPECT_GT(world.clearance(tests::gripperOpened(cell(), tests::planAt(cell(), plan, t))), 0.004) << "turn " << released << ", " << t << " s";
    }
  }
  EXPECT_EQ(released, grips(plan));
}

TEST_F(Regrip, NeedsAGripper) {
  Workcell bare = cell();
  bare.gripper.reset();
  PlanContext context = tests::contextOf(bare, "home");
  context.start = m_start;
  context.arguments = {{"angle", 0.3}, {"regrip", 1}};
  const Plan plan = tests::macroOf("move_around_axis").plan(context, &m_axle);
  ASSERT_FALSE(plan.ok());
  EXPECT_NE(plan.reason.find("gripper"), std::string::npos) << plan.reason;
}

}  // namespace
}  // namespace longarm::planning
