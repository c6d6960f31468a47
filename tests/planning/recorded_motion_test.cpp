// Replaying a recorded motion: approached from where the arm is, with new times, checked like everything
// else.
#include <gtest/gtest.h>

#include "planning/macros/recorded_motion.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using namespace longarm::tests;

Eigen::VectorXd poseOf(const char* name) {
  Eigen::VectorXd q(6);
  const auto names = builtIn().armJointNames();
  for (std::size_t i = 0; i < names.size(); ++i)
    q[static_cast<Eigen::Index>(i)] = builtIn().poses.at(name).at(names[i]);
  return q;
}

RecordedMotion lookAround() {
  RecordedMotion motion;
  motion.name = "Look around";
  motion.joint_names = builtIn().armJointNames();
  Eigen::VectorXd q = poseOf("ready");
  for (const double turn : {0.0, 0.5, -0.5}) {
    q[0] = turn;
    motion.waypoints.push_back({"turn " + std::to_string(motion.waypoints.size()), q});
  }
  return motion;
}

PlanContext from(const char* pose) {
  PlanContext context;
  context.workcell = &builtIn();
  context.start = builtIn().model->neutral();
  setGroupPositions(*builtIn().model, builtIn().arm, poseOf(pose), context.start);
  context.budget_s = 60;
  return context;
}

TEST(RecordedMotion, IsApproachedFromElsewhereAndPassesItsWayPoints) {
  const auto motion = lookAround();
  const Plan plan = makeRecordedMotion(motion)->plan(from("look_ahead"), nullptr);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  ASSERT_EQ(plan.stages.size(), 2u);
  EXPECT_EQ(plan.stages[0].name, "approach");
  EXPECT_EQ(plan.stages[1].name, "replay");
  EXPECT_LT((plan.trajectory.points.front().positions - poseOf("look_ahead")).norm(), 1e-9);
  EXPECT_LT((plan.trajectory.sample(plan.stages[1].start_s).positions - motion.waypoints[0].joints).norm(),
            1e-6);
  EXPECT_LT((plan.trajectory.points.back().positions - motion.waypoints[2].joints).norm(), 1e-6);
  double furthest = 0;
  for (const auto& p : plan.trajectory.points) furthest = std::max(furthest, p.positions[0]);
  EXPECT_GT(furthest, 0.25) << "corners are rounded, not cut off";
  EXPECT_TRUE(sweepOf(builtIn(), plan, {}).ok);
}

TEST(RecordedMotion, FromItsFirstWayPointThereIsNothingToApproach) {
  const Plan plan = makeRecordedMotion(lookAround())->plan(from("ready"), nullptr);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  ASSERT_EQ(plan.stages.size(), 1u);
  EXPECT_EQ(plan.stages[0].name, "replay");
}

TEST(RecordedMotion, SomethingNewInItsWayRefusesIt) {
  PlanContext context = from("ready");
  const Pose tool =
      builtIn().model->forward(context.start, *builtIn().model->linkIndex(builtIn().arm.tip_link));
  const Eigen::Vector3d beside = expSO3({0, 0, 0.35}) * tool.translation();
  context.objects = {boxObject("crate", {0.12, 0.12, 0.12}, beside)};
  const Plan plan = makeRecordedMotion(lookAround())->plan(context, nullptr);
  EXPECT_EQ(plan.status, PlanStatus::kApproachBlocked) << plan.reason;
  EXPECT_NE(plan.reason.find("crate"), std::string::npos) << plan.reason;
  EXPECT_NE(plan.reason.find("turn 1"), std::string::npos) << plan.reason;
  EXPECT_EQ(plan.failed_stage, "replay");
  EXPECT_TRUE(plan.failed_pose.has_value());
}

TEST(RecordedMotion, AnotherArmsMotionOrOneBeyondTheLimitsIsRefused) {
  auto motion = lookAround();
  motion.waypoints[1].joints[1] = 9;
  EXPECT_EQ(makeRecordedMotion(motion)->plan(from("ready"), nullptr).status, PlanStatus::kLimits);
  motion = lookAround();
  motion.joint_names[3] = "elbow";
  EXPECT_EQ(makeRecordedMotion(motion)->plan(from("ready"), nullptr).status, PlanStatus::kLimits);
}

TEST(RecordedMotion, SurvivesItsFile) {
  const std::string path = ::testing::TempDir() + "recorded_motion_test.json";
  const auto motion = lookAround();
  ASSERT_TRUE(writeRecordedMotion(path, motion).ok());
  const auto read = readRecordedMotion(path);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_EQ(read->name, motion.name);
  EXPECT_EQ(read->joint_names, motion.joint_names);
  ASSERT_EQ(read->waypoints.size(), 3u);
  EXPECT_EQ(read->waypoints[1].joints, motion.waypoints[1].joints);
  EXPECT_EQ(read->waypoints[1].name, motion.waypoints[1].name);
  EXPECT_EQ(readRecordedMotion(path + ".not").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(macroName(motion), "recorded_look_around");
}

TEST(RecordedMotion, ThinningKeepsEveryPlaceWithinItsTolerance) {
  std::vector<Eigen::VectorXd> all;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.01 * i;
    all.push_back(Eigen::Vector3d(std::sin(t), std::cos(2 * t), 0.3 * t));
  }
  const auto kept = thinned(all, 0.002);
  EXPECT_LT(kept.size(), 80u);
  EXPECT_EQ(kept.front(), all.front());
  EXPECT_EQ(kept.back(), all.back());
  std::size_t piece = 0;
  for (const auto& q : all) {
    while (piece + 2 < kept.size() && q == kept[piece + 1]) ++piece;
    const Eigen::VectorXd way = kept[piece + 1] - kept[piece];
    const double s = std::clamp((q - kept[piece]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    EXPECT_LE((q - kept[piece] - s * way).cwiseAbs().maxCoeff(), 0.002 + 1e-12);
  }
}

}  // namespace
}  // namespace longarm::planning
