#include <gtest/gtest.h>

#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kDegree = M_PI / 180;

Eigen::VectorXd trueArm(const RobotBody& body) {
  return planning::groupPositions(*body.workcell().model, body.workcell().arm, body.trueConfiguration());
}

Eigen::VectorXd joints(double each) { return Eigen::VectorXd::Constant(6, each); }

TEST(VirtualBody, StartsInThePoseOfTheScenarioWithAllJointsByName) {
  const auto body = bodyOf(emptyScenario());
  EXPECT_NEAR(*body->measured().position("arm_3_joint"), 2.15, 1e-12);
  EXPECT_NEAR(*body->measured().position("gripper_joint"), 0.05, 1e-12);
  EXPECT_NEAR(*body->measured().position("gripper_right_joint"), 0.05, 1e-12);
  EXPECT_EQ(body->measured().names.size(), body->trueJoints().size());
}

TEST(VirtualBody, RefusesAnUnknownStartPose) {
  auto scenario = emptyScenario();
  scenario.start_pose = "nowhere";
  const auto body = RobotBody::create(builtIn(), scenario, 1);
  ASSERT_FALSE(body.ok());
  EXPECT_NE(body.error().message.find("nowhere"), std::string::npos);
}

TEST(VirtualBody, HidesOffsetsBacklashAndNoiseThatTheSeedDraws) {
  auto scenario = emptyScenario();
  scenario.imperfections = {0.1, 0.02, 0.002, 0.02, 2};
  const auto body = bodyOf(scenario, 5), same = bodyOf(scenario, 5), other = bodyOf(scenario, 6);
  const Eigen::VectorXd error = trueArm(*body) - armOf(*body);
  EXPECT_GT(error.cwiseAbs().maxCoeff(), 0.02 * kDegree);
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 0.13 * kDegree);
  EXPECT_EQ(trueArm(*body), trueArm(*same));
  EXPECT_NE(trueArm(*body), trueArm(*other));
  const Eigen::VectorXd before = armOf(*body);
  run(*body, 0.01);
  EXPECT_NE(before, armOf(*body)) << "the encoders have noise";
  EXPECT_LT((before - armOf(*body)).cwiseAbs().maxCoeff(), 0.02 * kDegree);
}

TEST(VirtualBody, IdealJointsAreWhereTheirEncodersSay) {
  const auto body = bodyOf(emptyScenario());
  moveArm(*body, joints(0.05), 0.5);
  EXPECT_LT((trueArm(*body) - armOf(*body)).norm(), 1e-12);
}

TEST(VirtualBody, BacklashLagsBehindTheEncoderWhenTheDirectionTurns) {
  auto scenario = emptyScenario();
  scenario.imperfections.backlash_deg = 0.2;
  const auto body = bodyOf(scenario);
  moveArm(*body, joints(0.05), 0.5);
  EXPECT_NEAR((armOf(*body) - trueArm(*body)).maxCoeff(), 0.1 * kDegree, 1e-9);
  moveArm(*body, joints(-0.05), 0.5);
  EXPECT_NEAR((armOf(*body) - trueArm(*body)).minCoeff(), -0.1 * kDegree, 1e-9);
}

TEST(VirtualBody, RefusesHorizonsWithoutAHeartbeat) {
  const auto body = bodyOf(emptyScenario());
  const Eigen::VectorXd q = body->arm().commandedAt(0).positions;
  const auto status = body->follow(quinticTo(body->arm().joints(), q, q, 0.5));
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("heartbeat"), std::string::npos);
}

TEST(VirtualBody, StandsStillOnThePathWithin400MsAfterTheClientFallsSilent) {
  const auto body = bodyOf(emptyScenario());
  const Eigen::VectorXd from = body->arm().commandedAt(0).positions;
  body->heartbeat();
  ASSERT_TRUE(body->follow(quinticTo(body->arm().joints(), from, from + sweep(0.8), 1.9)).ok());
  run(*body, 0.8);
  const double last_heartbeat_s = 0.75;
  while (body->arm().moving(body->time_s()) && body->time_s() < 3) body->tick();
  EXPECT_GT(body->time_s(), last_heartbeat_s + 0.25);
  EXPECT_LT(body->time_s(), last_heartbeat_s + 0.40);
  const Eigen::VectorXd way = (armOf(*body) - from).cwiseAbs();
  EXPECT_GT(way.minCoeff(), 0.1);
  EXPECT_LT(way.maxCoeff() - way.minCoeff(), 1e-9) << "off the straight joint path";
}

TEST(VirtualBody, BrakesAtOnceWhenTheClientIsLost) {
  const auto body = bodyOf(emptyScenario());
  const Eigen::VectorXd from = body->arm().commandedAt(0).positions;
  body->heartbeat();
  ASSERT_TRUE(body->follow(quinticTo(body->arm().joints(), from, from + sweep(0.8), 1.9)).ok());
  run(*body, 0.9);
  body->clientLost();
  const double lost_s = body->time_s();
  while (body->arm().moving(body->time_s()) && body->time_s() < 3) body->tick();
  EXPECT_LT(body->time_s() - lost_s, 0.15);
}

TEST(VirtualBody, NeverPassesARateWhateverItIsTold) {
  auto scenario = emptyScenario();
  const auto body = bodyOf(scenario);
  const auto& model = *body->workcell().model;
  auto before = body->trueJoints();
  SeededRandom random(3);
  for (int i = 0; i < 2000; ++i) {
    if (i % 10 == 0) body->heartbeat();
    if (i % 70 == 0) {
      ASSERT_TRUE(body->aim("head", {{"head_pan_joint", random.between(-4, 4)},
                                     {"head_tilt_joint", random.between(-2, 2)}}).ok());
      ASSERT_TRUE(body->moveGripper(random.between(-0.02, 0.08)).ok());
      const Eigen::VectorXd q = body->arm().commandedAt(body->time_s()).positions;
      (void)body->follow(quinticTo(body->arm().joints(), q, q + sweep(random.between(-0.5, 0.5)), 0.8)).ok();
    }
    body->tick();
    const auto now = body->trueJoints();
    for (const auto& [name, value] : now) {
      const auto& joint = model.joints()[static_cast<std::size_t>(*model.jointIndex(name))];
      EXPECT_LE(std::abs(value - before[name]) / RobotBody::kTick_s, joint.max_velocity * 1.001) << name;
      EXPECT_GE(value, joint.lower - 1e-9) << name;
      EXPECT_LE(value, joint.upper + 1e-9) << name;
    }
    before = now;
  }
}

TEST(VirtualBody, ReportsTheVelocityItMovesAt) {
  const auto body = bodyOf(emptyScenario());
  ASSERT_TRUE(body->aim("head", {{"head_pan_joint", 1.0}}).ok());
  run(*body, 0.4);
  const double a = *body->measured().position("head_pan_joint");
  const auto index = static_cast<Eigen::Index>(
      std::find(body->measured().names.begin(), body->measured().names.end(), "head_pan_joint") -
      body->measured().names.begin());
  const double v = body->measured().velocities[index];
  run(*body, 0.01);
  EXPECT_NEAR((*body->measured().position("head_pan_joint") - a) / 0.01, v, 0.06);
  EXPECT_GT(v, 0.5);
  run(*body, 2);
  EXPECT_NEAR(*body->measured().position("head_pan_joint"), 1.0, 1e-9);
  EXPECT_EQ(body->measured().velocities[index], 0);
}

TEST(VirtualBody, RefusesToAimWhatItDoesNotHave) {
  const auto body = bodyOf(emptyScenario());
  EXPECT_EQ(body->aim("tail", {}).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(body->aim("head", {{"arm_1_joint", 0.1}}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(body->aim("head", {{"head_pan_joint", std::nan("")}}).error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(body->moveGripper(std::nan("")).error().code, ErrorCode::kInvalidInput);
}

TEST(VirtualBody, AStickingJointFallsBehindAndIsSeenByItsEncoder) {
  const auto body = bodyOf(emptyScenario());
  ASSERT_TRUE(body->faults().start("joint_stiction", 0, 0, "arm_2_joint").ok());
  const Eigen::VectorXd from = armOf(*body);
  moveArm(*body, joints(0.015), 0.4);
  EXPECT_NEAR(armOf(*body)[1], from[1], 1e-12);
  EXPECT_NEAR(armOf(*body)[0], from[0] + 0.015, 1e-9);
  ASSERT_TRUE(body->faults().start("clear", 0, 0, "").ok());
  run(*body, 0.1);
  EXPECT_NEAR(armOf(*body)[1], from[1] + 0.015, 1e-9);
}

TEST(VirtualBody, AMovedBaseTakesTheCamerasWithItAndLeavesTheWorld) {
  auto scenario = *planning::loadScenario("grab_pipe");
  const auto body = bodyOf(scenario);
  const auto before = body->snapshot();
  ASSERT_TRUE(body->faults().start("moved_base", 0, 0, "").ok());
  const auto after = body->snapshot();
  EXPECT_GT((before.X_WC.at("wrist").translation() - after.X_WC.at("wrist").translation()).norm(), 0.01);
  EXPECT_TRUE(before.objects.front().X_WO.isApprox(after.objects.front().X_WO));
}

TEST(VirtualBody, AKnockedCameraIsADegreeOffAndItsPartnerIsNot) {
  const auto body = bodyOf(emptyScenario());
  const auto before = body->snapshot();
  ASSERT_TRUE(body->faults().start("knocked_camera", 0, 0, "").ok());
  const auto after = body->snapshot();
  EXPECT_NEAR(angleBetween(before.X_WC.at("head_left").linear(), after.X_WC.at("head_left").linear()), kDegree, 1e-9);
  EXPECT_TRUE(before.X_WC.at("head_right").isApprox(after.X_WC.at("head_right")));
}

TEST(VirtualFaults, ComeAtTheirTimeOrInMidMotionAndEnd) {
  FaultBoard board({{"glare", 0.5, 0.2, ""}, {"link_cut", std::nullopt, 0.1, ""}});
  board.tick(0.4, true, 0.4);
  EXPECT_TRUE(board.names().empty());
  board.tick(0.5, true, 0.1);
  EXPECT_TRUE(board.active("glare"));
  board.tick(0.71, false, 0.2);
  EXPECT_FALSE(board.active("glare"));
  board.tick(1.3, true, 0.6);
  EXPECT_TRUE(board.active("link_cut")) << "a second of motion has passed";
  board.tick(1.5, true, 0.2);
  EXPECT_FALSE(board.active("link_cut"));
  const auto status = board.start("earthquake", 0, 0, "");
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("slipping_grasp"), std::string::npos);
}

}  // namespace
}  // namespace longarm::virtual_robot
