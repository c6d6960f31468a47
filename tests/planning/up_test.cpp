// Above is against gravity where the robot tells it, and along the base's z where not.
#include <gtest/gtest.h>

#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;

// A base that leans back and to its side.
const Vector3d kUp = Vector3d(-0.17, 0.12, 1).normalized();
const Vector3d kPoint(0.7, 0.05, 0.4);

Plan planned(const std::string& macro, const std::optional<Vector3d>& up, std::map<std::string, double> arguments) {
  PlanContext context = tests::contextOf(tests::builtIn(), "home");
  context.budget_s = 60;
  context.up = up;
  context.arguments = std::move(arguments);
  const auto point = tests::featureOf(vision::FeatureKind::kPoint, {kPoint});
  return tests::macroOf(macro).plan(context, &point);
}

Pose endOf(const Plan& plan) { return tests::toolAt(tests::builtIn(), plan, plan.trajectory.duration()); }

TEST(Up, MoveAboveStandsOverThePointAgainstGravity) {
  const Plan plan = planned("move_above", kUp, {{"height", 0.2}, {"max_tilt", 0}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT((endOf(plan).translation() - (kPoint + 0.2 * kUp)).norm(), 1e-4);
  EXPECT_LT((endOf(plan).linear().col(2) + kUp).norm(), 1e-3) << "the tool hangs plumb";
  ASSERT_FALSE(plan.notes.empty());
  EXPECT_NE(plan.notes.front().find("attitude sensor"), std::string::npos) << plan.notes.front();
  const Plan without = planned("move_above", std::nullopt, {{"height", 0.2}, {"max_tilt", 0}});
  ASSERT_TRUE(without.ok()) << without.reason;
  EXPECT_LT((endOf(without).translation() - (kPoint + Vector3d(0, 0, 0.2))).norm(), 1e-4);
}

TEST(Up, PlaceHereLowersAlongGravity) {
  const Plan plan = planned("place_here", kUp, {{"stand_off", 0.1}, {"max_lean", 1.5708}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const PlanStage* lower = tests::stageOf(plan, "lower");
  ASSERT_NE(lower, nullptr);
  const Vector3d way = endOf(plan).translation() - tests::toolAt(tests::builtIn(), plan, lower->start_s).translation();
  EXPECT_LT((way.normalized() + kUp).norm(), 1e-3);
}

TEST(Up, TouchFromAboveComesDownAlongGravity) {
  const Plan plan = planned("touch", kUp, {{"from", 1}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT((endOf(plan).linear().col(2) + kUp).norm(), 0.02);
}

TEST(Up, LookAtKeepsThePictureLevelWithTheHorizon) {
  const Plan plan = planned("look_at", kUp, {});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const auto& cell = tests::builtIn();
  const Eigen::Matrix3d R = cell.model->forward(tests::planAt(cell, plan, plan.trajectory.duration()), *cell.model->linkIndex("wrist_optical")).linear();
  // The picture's rows lie level, or it was rolled by whole steps of 15 degrees from there because it had to be.
  const double roll = std::atan2(R.col(0).dot(kUp), -R.col(1).dot(kUp));
  EXPECT_NEAR(std::remainder(roll, M_PI / 12), 0, 0.01);
}

TEST(Up, MacrosSayWhetherTheyGoByIt) {
  for (const char* name : {"move_above", "place_here", "look_at", "touch", "approach_from_side", "place_disruptor", "grasp_by_faces"}) {
    EXPECT_TRUE(tests::macroOf(name).info().uses_up) << name;
  }
  EXPECT_FALSE(tests::macroOf("move_parallel").info().uses_up);
}

}  // namespace
}  // namespace longarm::planning
