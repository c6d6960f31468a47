// Driving the base through the gate: one owner, one thing that moves at a time, STOP for both.
#include "hardware/sim/simulated_base.h"
#include "tests/hardware/gate_rig.h"

namespace longarm::hardware::tests {
namespace {

struct DriveRig : GateRig {
  std::shared_ptr<SimulatedBase> base = std::make_shared<SimulatedBase>("base", BaseLimits(), clock);
  DriveRig() {
    EXPECT_TRUE(base->open().ok());
    gate.setBase(base, BaseLimits());
  }
  void startDriving() {
    ASSERT_TRUE(gate.reset().ok());
    ASSERT_TRUE(gate.acquire("drive").ok());
  }
  double gone() const { return std::hypot(base->odometry()->x, base->odometry()->y); }
};

TEST(GateDrive, PassesAVelocityOnToTheBase) {
  DriveRig rig;
  rig.startDriving();
  for (int i = 0; i < 50; ++i) {
    const auto status = rig.gate.drive("drive", {0.2, 0, 0});
    ASSERT_TRUE(status.ok()) << status.error().message;
    EXPECT_TRUE(rig.gate.driving());
    rig.clock.advance(0.02);
  }
  EXPECT_NEAR(rig.gone(), 0.2, 1e-9);
}

TEST(GateDrive, NothingMovesBeforeStopIsReleasedOrWithoutOwningIt) {
  DriveRig rig;
  EXPECT_EQ(rig.gate.drive("drive", {0.1, 0, 0}).error().code, ErrorCode::kRefused);
  ASSERT_TRUE(rig.gate.reset().ok());
  EXPECT_EQ(rig.gate.drive("drive", {0.1, 0, 0}).error().code, ErrorCode::kRefused) << "nobody has taken it";
  ASSERT_TRUE(rig.gate.acquire("player").ok());
  EXPECT_EQ(rig.gate.drive("drive", {0.1, 0, 0}).error().code, ErrorCode::kRefused);
  EXPECT_EQ(rig.gate.acquire("drive").error().code, ErrorCode::kRefused) << "the arm has it";
  EXPECT_EQ(rig.gate.drive("player", {0.4, 0, 0}).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(rig.gone(), 0);
}

TEST(GateDrive, TheBaseStandsWhileTheArmMoves) {
  DriveRig rig;
  rig.start();
  ASSERT_TRUE(rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.1, 0, 0), 0.4)).ok());
  rig.gate.release("player");
  ASSERT_TRUE(rig.gate.acquire("drive").ok());
  rig.clock.advance(0.2);
  const auto refused = rig.gate.drive("drive", {0.1, 0, 0});
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("arm still moves"), std::string::npos) << refused.error().message;
  rig.clock.advance(0.3);
  EXPECT_TRUE(rig.gate.drive("drive", {0.1, 0, 0}).ok());
}

TEST(GateDrive, TheArmStandsWhileTheBaseMoves) {
  DriveRig rig;
  rig.startDriving();
  ASSERT_TRUE(rig.gate.drive("drive", {0.1, 0, 0}).ok());
  rig.gate.release("drive");
  ASSERT_TRUE(rig.gate.acquire("player").ok());
  const auto refused = rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.1, 0, 0), 0.4));
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("base is driving"), std::string::npos) << refused.error().message;
  rig.clock.advance(0.3);  // its deadline is over
  EXPECT_TRUE(rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.1, 0, 0), 0.4)).ok());
}

TEST(GateDrive, StopStopsTheBaseAtOnceAndLatches) {
  DriveRig rig;
  rig.startDriving();
  ASSERT_TRUE(rig.gate.drive("drive", {0.3, 0, 0.2}).ok());
  rig.clock.advance(0.1);
  rig.gate.stop("operator", "STOP was pressed");
  const double gone = rig.gone();
  EXPECT_GT(gone, 0.02);
  rig.clock.advance(1);
  EXPECT_EQ(rig.gone(), gone);
  EXPECT_EQ(rig.gate.drive("drive", {0.1, 0, 0}).error().code, ErrorCode::kRefused);
  ASSERT_TRUE(rig.gate.reset().ok());
  EXPECT_EQ(rig.gate.drive("drive", {0.1, 0, 0}).error().code, ErrorCode::kRefused)
      << "whoever drove must take it again";
}

TEST(GateDrive, StaleOdometryRefusesDrivingButNotStopping) {
  DriveRig rig;
  rig.startDriving();
  rig.base->freeze(true);
  rig.clock.advance(0.5);
  EXPECT_EQ(rig.gate.drive("drive", {0.1, 0, 0}).error().code, ErrorCode::kStale);
  EXPECT_TRUE(rig.gate.drive("drive", {}).ok());
}

TEST(GateDrive, AGateWithoutABaseRefuses) {
  GateRig rig;
  rig.start();
  EXPECT_EQ(rig.gate.drive("player", {0.1, 0, 0}).error().code, ErrorCode::kRefused);
  EXPECT_FALSE(rig.gate.driving());
}

}  // namespace
}  // namespace longarm::hardware::tests
