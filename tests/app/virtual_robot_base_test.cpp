// The virtual robot drives: its base, tool, cameras and what it holds move together, and it stops by itself.
#include <gtest/gtest.h>

#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

// With heartbeats, and a velocity twenty times a second.
void drive(RobotBody& body, const BaseTwist& twist, double seconds) {
  for (double t = 0; t < seconds - 1e-9; t += 0.05) {
    const auto status = body.drive(twist);
    ASSERT_TRUE(status.ok()) << status.error().message;
    run(body, 0.05);
  }
}

TEST(VirtualBase, EverythingOnTheRobotMovesWithIt) {
  const auto body = bodyOf(emptyScenario());
  const auto before = body->snapshot();
  const Pose X_WT = body->X_WT();
  run(*body, 0.1);
  drive(*body, {0.2, 0, 0.3}, 2);
  run(*body, 1);
  const Pose moved = body->X_WB();
  EXPECT_GT(moved.translation().norm(), 0.2);
  EXPECT_GT(moved.linear()(1, 0), 0.3) << "to the left";
  EXPECT_LT((body->X_WT().matrix() - (moved * X_WT).matrix()).norm(), 1e-6);
  const auto after = body->snapshot();
  ASSERT_FALSE(after.X_WC.empty());
  for (const auto& [camera, X_WC] : after.X_WC) {
    EXPECT_LT((X_WC.matrix() - (moved * before.X_WC.at(camera)).matrix()).norm(), 1e-6) << camera;
  }
}

TEST(VirtualBase, StopsByItselfWhenNothingFollows) {
  const auto body = bodyOf(emptyScenario());
  run(*body, 0.1);
  drive(*body, {0.3, 0, 0}, 1);
  EXPECT_TRUE(body->base()->moving());
  run(*body, 0.25 + 0.3 / builtIn().base->max_acceleration + 0.1);
  EXPECT_FALSE(body->base()->moving());
}

TEST(VirtualBase, StopsWithoutHeartbeatAndWhenTheClientIsGone) {
  for (const bool gone : {false, true}) {
    const auto body = bodyOf(emptyScenario());
    run(*body, 0.1);
    drive(*body, {0.2, 0, 0}, 0.6);
    if (gone) body->clientLost();
    for (int i = 0; i < 300; ++i) {
      (void)body->drive({0.2, 0, 0}).ok();  // commands alone keep nothing going
      body->tick();
    }
    EXPECT_FALSE(body->base()->moving());
    EXPECT_EQ(body->drive({0.2, 0, 0}).error().code, ErrorCode::kRefused);
  }
}

TEST(VirtualBase, RefusesToDriveWhileTheArmMovesAndBeyondItsCaps) {
  const auto body = bodyOf(emptyScenario());
  run(*body, 0.1);
  EXPECT_EQ(body->drive({1, 0, 0}).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(body->drive({0, 0.1, 0}).error().code, ErrorCode::kOutOfLimits);
  const Eigen::VectorXd from = body->arm().commandedAt(body->time_s()).positions;
  ASSERT_TRUE(body->follow(quinticTo(body->arm().joints(), from, from + sweep(0.05), 0.5)).ok());
  run(*body, 0.2);
  EXPECT_EQ(body->drive({0.1, 0, 0}).error().code, ErrorCode::kRefused);
  run(*body, 0.6);
  EXPECT_TRUE(body->drive({0.1, 0, 0}).ok());
}

TEST(VirtualBase, StopEndsTheDrive) {
  const auto body = bodyOf(emptyScenario());
  run(*body, 0.1);
  drive(*body, {0.2, 0, 0}, 0.6);
  body->stop();
  run(*body, 0.6);
  EXPECT_FALSE(body->base()->moving());
}

TEST(VirtualBase, ItsOdometryIsOffByTheShareOfTheScenario) {
  auto scenario = emptyScenario();
  scenario.imperfections.odometry_share = 0.05;
  const auto body = bodyOf(scenario, 3), same = bodyOf(scenario, 3);
  for (auto* each : {body.get(), same.get()}) {
    run(*each, 0.1);
    drive(*each, {0.3, 0, 0}, 3);
    run(*each, 1);
  }
  const double truth = body->X_WB().translation().x(), told = body->base()->odometry().x;
  EXPECT_GT(std::abs(told - truth), 1e-4);
  EXPECT_LT(std::abs(told / truth - 1), 0.05);
  EXPECT_EQ(told, same->base()->odometry().x);
  const auto ideal = bodyOf(emptyScenario());
  run(*ideal, 0.1);
  drive(*ideal, {0.3, 0, 0}, 1);
  EXPECT_EQ(ideal->X_WB().translation().x(), ideal->base()->odometry().x);
}

TEST(VirtualBase, DrivingIntoSomethingIsAContact) {
  auto scenario = emptyScenario();
  planning::ScenarioObject post;
  post.body.name = "post";
  post.body.shape = planning::Box{{0.1, 0.1, 1}};
  post.body.X_WO.translation() = Eigen::Vector3d(1.2, 0, 0.5);
  scenario.objects.push_back(post);
  const auto body = bodyOf(scenario);
  run(*body, 0.1);
  EXPECT_TRUE(body->contacts().contacts().empty());
  drive(*body, {0.3, 0, 0}, 4);
  ASSERT_FALSE(body->contacts().contacts().empty());
  const auto& first = body->contacts().contacts().front();
  EXPECT_TRUE(first.a == "post" || first.b == "post");
}

}  // namespace
}  // namespace longarm::virtual_robot
