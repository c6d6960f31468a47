#include <cmath>

#include <gtest/gtest.h>

#include "tests/session/runtime_fixture.h"

namespace longarm::session {
namespace {

using planning::PlayerState;

class RuntimeMotion : public testing::RuntimeFixture {};

TEST_F(RuntimeMotion, PlaysAMotionToItsEnd) {
  start();
  loadAndPlay();
  const Trajectory path = motion();
  step(path.duration() + 1);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kDone);
  EXPECT_LT((measured() - path.points.back().positions).norm(), 1e-6);
  ASSERT_NE(event("done"), nullptr);
  EXPECT_TRUE(m_runtime->status().gate.owner.empty());
  EXPECT_EQ(m_runtime->status().gate.refused, 0u);
}

TEST_F(RuntimeMotion, StaysOnThePathAtEverySpeedAndDirection) {
  start();
  loadAndPlay();
  const Trajectory path = motion();
  double worst = 0;
  for (const double speed : {1.0, 2.0, -2.0, 0.5, -0.5, 2.0}) {
    m_runtime->setSpeed(speed);
    for (int i = 0; i < 60; ++i) {
      step(0.02);
      const double cursor = m_runtime->status().cursor;
      worst = std::max(worst, testing::distanceToPath(path, measured(), cursor, 0.2));
    }
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_EQ(m_runtime->status().gate.refused, 0u);
}

TEST_F(RuntimeMotion, StopBringsTheArmToRestAndLatches) {
  start();
  loadAndPlay();
  m_runtime->setSpeed(2);
  step(3);
  ASSERT_GT(speedNow(), 0.2);
  m_runtime->stop("operator", "STOP pressed");
  const double speed = speedNow();
  step(0.1);
  EXPECT_LT(speedNow(), speed);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kHalted);
  step(0.3);
  EXPECT_EQ(speedNow(), 0);
  EXPECT_TRUE(m_runtime->status().stop_confirmed);
  ASSERT_NE(event("stop"), nullptr);
  EXPECT_EQ(event("stop")->source, "operator");
  EXPECT_EQ(m_runtime->play().error().code, ErrorCode::kRefused);
}

TEST_F(RuntimeMotion, TheCommandedVelocityIsZeroWithinATenthOfASecondOfStop) {
  start();
  loadAndPlay();
  m_runtime->setSpeed(2);
  step(3);
  const double peak = speedNow();
  ASSERT_GT(peak, 0.2);
  m_runtime->stop("operator", "STOP pressed");
  // At the stop deceleration of 10 rad/s2 this speed needs less than 0.1 s.
  ASSERT_LT(peak / m_workcell->arm_limits.stop_deceleration[0], 0.1);
  step(0.1);
  EXPECT_FALSE(m_runtime->status().moving);
}

TEST_F(RuntimeMotion, AfterAStopTheMotionIsResumedOnlyByResetAndPlay) {
  start();
  loadAndPlay();
  step(2);
  m_runtime->stop("operator", "STOP pressed");
  step(0.5);
  const Eigen::VectorXd stands = measured();
  ASSERT_TRUE(m_runtime->resetStop().ok());
  step(2);
  EXPECT_EQ((measured() - stands).norm(), 0);
  const auto resumed = m_runtime->play();
  ASSERT_TRUE(resumed.ok()) << resumed.error().message;
  step(motion().duration() + 1);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kDone);
}

TEST_F(RuntimeMotion, APlanFromElsewhereIsRefusedNamingJointAndValues) {
  start();
  Trajectory elsewhere = motion();
  for (auto& p : elsewhere.points) p.positions[1] += 0.02;
  const auto refused = m_runtime->load(elsewhere);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kStale);
  EXPECT_NE(refused.error().message.find("joint_2 is at -0.2000"), std::string::npos)
      << refused.error().message;
  EXPECT_NE(refused.error().message.find("0.01"), std::string::npos);
}

TEST_F(RuntimeMotion, PlayIsRefusedWhenTheArmWasMovedSinceLoading) {
  start();
  ASSERT_TRUE(m_runtime->load(motion()).ok());
  m_arm->setOffset(Eigen::Vector3d(0.02, 0, 0));
  const auto refused = m_runtime->play();
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kStale);
}

// The robot braked along the path by itself, e.g. because the heartbeat was late: Play goes on from there.
TEST_F(RuntimeMotion, PlayGoesOnFromWhereTheArmStandsOnThePath) {
  start();
  loadAndPlay();
  step(2.5);
  m_runtime->pause();
  step(0.6);
  ASSERT_EQ(m_runtime->status().player, PlayerState::kPaused);
  const double cursor = m_runtime->status().cursor;
  const auto path = m_runtime->trajectory();
  const Eigen::VectorXd behind = path.sample(cursor - 0.5).positions - path.sample(cursor).positions;
  ASSERT_GT(behind.cwiseAbs().maxCoeff(), 0.01) << "far enough to matter";
  m_arm->setOffset(behind);
  step(0.1);
  const auto played = m_runtime->play();
  ASSERT_TRUE(played.ok()) << played.error().message;
  EXPECT_NEAR(m_runtime->status().cursor, cursor - 0.5, 0.05);
  step(0.1);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kPlaying);
}

TEST_F(RuntimeMotion, ATrajectoryOfOtherJointsIsRefused) {
  start();
  Trajectory other = motion();
  std::swap(other.joint_names[0], other.joint_names[1]);
  EXPECT_EQ(m_runtime->load(other).error().code, ErrorCode::kInvalidInput);
}

TEST_F(RuntimeMotion, NothingIsLoadedWhileTheArmMoves) {
  start();
  loadAndPlay();
  step(1);
  EXPECT_EQ(m_runtime->load(motion()).error().code, ErrorCode::kRefused);
  m_runtime->unload();
  EXPECT_EQ(m_runtime->status().player, PlayerState::kPlaying);
}

TEST_F(RuntimeMotion, ALinkThatFallsSilentStopsTheMotionAndNothingRestartsByItself) {
  start();
  loadAndPlay();
  step(2);
  m_arm->freeze(true);
  step(0.5);
  const auto silent = m_runtime->status();
  EXPECT_EQ(silent.link, LinkState::kQuiet);
  EXPECT_TRUE(silent.gate.stopped);
  EXPECT_EQ(silent.gate.source, "link");
  EXPECT_EQ(silent.player, PlayerState::kHalted);
  step(1.5);
  EXPECT_EQ(m_runtime->status().link, LinkState::kLost);
  m_arm->freeze(false);
  step(0.2);
  EXPECT_EQ(m_runtime->status().link, LinkState::kUp);
  const Eigen::VectorXd stands = measured();
  step(2);
  EXPECT_EQ((measured() - stands).norm(), 0);
}

TEST_F(RuntimeMotion, ATenthOfASecondWithoutJointStatesIsNoReasonToStop) {
  start();
  loadAndPlay();
  step(2);
  m_arm->freeze(true);
  step(0.1);
  m_arm->freeze(false);
  step(motion().duration());
  EXPECT_EQ(m_runtime->status().player, PlayerState::kDone);
}

TEST_F(RuntimeMotion, AFaultOfTheArmIsReportedAndClearedOnlyByTheOperator) {
  start();
  loadAndPlay();
  step(1);
  m_arm->injectFault("joint 2 is too hot");
  step(0.2);
  const auto status = m_runtime->status();
  ASSERT_FALSE(status.faults.empty());
  EXPECT_NE(status.faults.front().find("joint 2 is too hot"), std::string::npos);
  EXPECT_EQ(status.player, PlayerState::kHalted);
  step(0.5);
  ASSERT_TRUE(m_runtime->resetStop().ok());
  EXPECT_TRUE(m_runtime->status().faults.empty());
}

TEST_F(RuntimeMotion, ASlippedEncoderEndsTheMotion) {
  start();
  loadAndPlay();
  step(1);
  m_arm->setOffset(Eigen::Vector3d(0.3, 0, 0));
  step(0.3);
  EXPECT_TRUE(m_runtime->status().gate.stopped);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kHalted);
}

TEST_F(RuntimeMotion, AWindowThatHangsPausesTheMotionAndEndsTheHeartbeat) {
  m_watchdog = true;
  start();
  m_runtime->touchGui();
  loadAndPlay();
  for (int i = 0; i < 40; ++i) {
    step(0.02);
    m_runtime->touchGui();
  }
  EXPECT_EQ(m_runtime->status().player, PlayerState::kPlaying);
  EXPECT_GT(m_alive_until->load(), m_runtime->clock().now_s());
  step(0.45);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kPlaying);
  step(0.1);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kPausing);
  EXPECT_NE(m_runtime->status().notice.find("window"), std::string::npos);
  step(0.4);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kPaused);
  EXPECT_GT(m_alive_until->load(), m_runtime->clock().now_s()) << "the robot needs not brake by itself";
  step(0.5);
  EXPECT_LT(m_alive_until->load(), m_runtime->clock().now_s());
  m_runtime->touchGui();
  ASSERT_TRUE(m_runtime->play().ok());
  step(0.2);
  EXPECT_TRUE(m_runtime->status().moving);
}

TEST_F(RuntimeMotion, GripperAndPanTiltAnswerWithoutResettingStop) {
  start();
  m_runtime->stop("operator", "STOP pressed");
  step(0.2);
  ASSERT_TRUE(m_runtime->setGripper(0.04).ok());
  ASSERT_TRUE(m_runtime->movePanTilt("head", 0.3, -0.2).ok());
  step(2);
  EXPECT_NEAR(m_runtime->gripperPosition(), 0.04, 1e-9);
  EXPECT_NEAR(m_runtime->panTilt("head")->pan, 0.3, 1e-9);
  EXPECT_EQ(m_runtime->movePanTilt("tail", 0, 0).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(m_runtime->cameraFrame("nose"), nullptr);
}

TEST_F(RuntimeMotion, ScrubbingShowsThePathWithoutMovingTheArm) {
  start();
  ASSERT_TRUE(m_runtime->load(motion()).ok());
  ASSERT_TRUE(m_runtime->scrub(3).ok());
  step(0.5);
  EXPECT_DOUBLE_EQ(m_runtime->status().cursor, 3);
  EXPECT_LT((measured() - m_home).norm(), 1e-12);
  ASSERT_TRUE(m_runtime->play().ok());
  step(0.1);
  EXPECT_LT(m_runtime->status().cursor, 0.2);
}

TEST_F(RuntimeMotion, RestartBringsANewRobotWithStopLatchedAndNothingLoaded) {
  start();
  loadAndPlay();
  step(1);
  ASSERT_TRUE(m_runtime->restart().ok());
  ASSERT_TRUE(m_runtime->waitUntilUp(5).ok());
  const auto status = m_runtime->status();
  EXPECT_TRUE(status.gate.stopped);
  EXPECT_EQ(status.player, PlayerState::kEmpty);
}

TEST_F(RuntimeMotion, TheConfigurationHoldsTheMeasuredJoints) {
  start();
  const auto q = m_runtime->configuration();
  ASSERT_TRUE(q.ok());
  EXPECT_LT((*q - m_home).norm(), 1e-12);
}

// Which way is up: turned from the sensor's frame, and not believed when it is old.
class TiltedRobot : public longarm::testing::RuntimeFixture {
 protected:
  void SetUp() override {
    auto cell = std::make_shared<planning::Workcell>(*longarm::testing::threeJointWorkcell());
    cell->imu = planning::ImuSpec{"a", ""};           // turns with joint_1
    m_workcell = cell;
    start();
  }
};

TEST_F(TiltedRobot, SaysWhichWayIsUpInItsRootFrame) {
  m_imu->tilt({0.2, 0, 1});
  step(0.1);
  const auto up = m_runtime->status().up;
  ASSERT_TRUE(up.has_value());
  const Eigen::Vector3d wanted = Eigen::AngleAxisd(m_home[0], Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(0.2, 0, 1).normalized();
  EXPECT_LT((*up - wanted).norm(), 1e-6);
  m_imu->freeze(true);
  step(0.5);
  EXPECT_TRUE(m_runtime->status().up.has_value());
  step(1);
  EXPECT_FALSE(m_runtime->status().up.has_value()) << "told more than a second ago";
}

}  // namespace
}  // namespace longarm::session
