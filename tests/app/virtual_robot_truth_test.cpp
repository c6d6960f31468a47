#include <gtest/gtest.h>

#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector3d;

planning::ScenarioObject block(const char* name, const Pose& X_WO, const Vector3d& size, bool graspable = false) {
  planning::ScenarioObject out;
  out.body.name = name;
  out.body.shape = planning::Box{size};
  out.body.X_WO = X_WO;
  out.graspable = graspable;
  return out;
}

Pose toolAtStart() { return bodyOf(emptyScenario())->X_WT(); }

Pose shifted(Pose X, const Vector3d& by) {
  X.translation() += by;
  return X;
}

bool has(const RobotBody& body, const std::string& a, const std::string& b) {
  const auto& all = body.contacts().contacts();
  return std::any_of(all.begin(), all.end(),
                     [&](const ContactEvent& c) { return (c.a == a && c.b == b) || (c.a == b && c.b == a); });
}

TEST(VirtualTruth, TheBuiltInSceneIsFreeOfContactsAtTheStart) {
  for (unsigned seed : {0u, 1u, 2u, 3u}) {
    const auto body = bodyOf(*planning::loadScenario("grab_pipe"), seed);
    run(*body, 0.05);
    EXPECT_TRUE(body->contacts().contacts().empty())
        << "seed " << seed << ": " << body->contacts().contacts().front().a << " "
        << body->contacts().contacts().front().b;
  }
}

TEST(VirtualTruth, RemembersOnceAndWhenTheArmRanIntoSomething) {
  auto scenario = emptyScenario();
  const Pose X_WT = toolAtStart();
  scenario.objects = {block("wall", shifted(X_WT, {0, 0.25, 0}), {0.3, 0.02, 0.3})};
  scenario.goals = {{"no_contact", "", 0}, {"no_contact", "other", 0}, {"touch", "wall", 0}};
  const auto body = bodyOf(scenario);
  run(*body, 0.1);
  EXPECT_TRUE(body->goals()[0].reached);
  EXPECT_FALSE(body->goals()[2].reached);
  moveArm(*body, (Eigen::VectorXd(6) << 0.6, 0, 0, 0, 0, 0).finished(), 1.5);
  ASSERT_FALSE(body->contacts().contacts().empty());
  const auto& first = body->contacts().contacts().front();
  EXPECT_TRUE(first.a == "wall" || first.b == "wall");
  EXPECT_GT(first.time_s, 0.1);
  EXPECT_LT(first.time_s, 1.6);
  const std::size_t pairs = body->contacts().contacts().size();
  moveArm(*body, (Eigen::VectorXd(6) << -0.6, 0, 0, 0, 0, 0).finished(), 1.5);
  moveArm(*body, (Eigen::VectorXd(6) << 0.6, 0, 0, 0, 0, 0).finished(), 1.5);
  EXPECT_EQ(body->contacts().contacts().size(), pairs) << "each pair once";
  EXPECT_FALSE(body->goals()[0].reached);
  EXPECT_TRUE(body->goals()[1].reached);
  EXPECT_TRUE(body->goals()[2].reached);
}

TEST(VirtualTruth, TheGripperMayTouchWhatItTakesButNotTheTable) {
  auto scenario = emptyScenario();
  const Pose X_WT = toolAtStart();
  scenario.objects = {block("part", X_WT, {0.1, 0.03, 0.03}, true)};
  auto body = bodyOf(scenario);
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  EXPECT_TRUE(body->contacts().contacts().empty());
  scenario.objects[0].graspable = false;
  body = bodyOf(scenario);
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  EXPECT_FALSE(body->holding());
  EXPECT_TRUE(has(*body, "part", "finger_left_link"));
}

TEST(VirtualTruth, WhatAHeldObjectLayOnMayGoOnTouchingButNotTheWall) {
  auto scenario = emptyScenario();
  const Pose X_WT = toolAtStart();
  const Vector3d up = Vector3d::UnitZ();
  // The tool of the start pose points forward; the bar lies across in front of it on a low block.
  scenario.objects = {block("bar", X_WT, {0.4, 0.03, 0.03}, true),
                      block("rest", shifted(Pose(Eigen::Translation3d(X_WT.translation())), -0.115 * up), {0.02, 0.02, 0.2}),
                      block("wall", shifted(X_WT, {0, 0.35, 0}), {1.2, 0.02, 0.4})};
  const auto body = bodyOf(scenario);
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  EXPECT_FALSE(has(*body, "bar", "rest"));
  moveArm(*body, (Eigen::VectorXd(6) << 0.7, 0, 0, 0, 0, 0).finished(), 1.8);
  EXPECT_TRUE(has(*body, "bar", "wall")) << "what is held counts as the robot";
  EXPECT_FALSE(has(*body, "bar", "rest"));
}

TEST(VirtualTruth, NamesEveryMovingJoint) {
  const auto body = bodyOf(emptyScenario());
  const auto joints = body->trueJoints();
  EXPECT_EQ(joints.count("arm_1_joint"), 1u);
  EXPECT_EQ(joints.count("gripper_right_joint"), 1u);
  EXPECT_EQ(joints.count("torso_joint"), 1u);
}

}  // namespace
}  // namespace longarm::virtual_robot
