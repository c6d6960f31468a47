// Driving through the runtime: a dead man's switch, the arm, STOP, the link, and a motion that was loaded
// elsewhere.
#include <gtest/gtest.h>

#include "hardware/sim/simulated_base.h"
#include "tests/session/runtime_fixture.h"

namespace longarm::session {
namespace {

class RuntimeDrive : public testing::RuntimeFixture {
 protected:
  void SetUp() override {
    auto cell = std::make_shared<planning::Workcell>(*m_workcell);
    cell->base = BaseLimits();
    m_workcell = cell;
    RuntimeOptions options;
    options.make_devices = [this](const planning::Workcell& workcell, const std::string&,
                                  const Clock& clock) {
      auto set = devices(workcell, clock);
      m_base = std::make_shared<hardware::SimulatedBase>("base", *workcell.base, clock);
      set->base = m_base;
      return set;
    };
    startWith(options);
  }
  // As the window does it: twenty times a second.
  void hold(const BaseTwist& twist, double seconds) {
    for (double t = 0; t < seconds - 1e-9; t += 0.04) {
      const auto status = m_runtime->drive(twist);
      ASSERT_TRUE(status.ok()) << status.error().message;
      if (m_watchdog) m_runtime->touchGui();
      step(0.04);
    }
  }
  double gone() const { return m_runtime->status().base->x; }

  std::shared_ptr<hardware::SimulatedBase> m_base;
};

TEST_F(RuntimeDrive, MovesWhileItIsHeldAndComesToRestWhenItIsLetGoOf) {
  hold({0.2, 0, 0}, 1);
  EXPECT_TRUE(m_runtime->status().driving);
  EXPECT_EQ(m_runtime->status().gate.owner, "drive");
  EXPECT_GT(gone(), 0.1);
  m_runtime->releaseDrive();
  step(0.6);
  EXPECT_FALSE(m_runtime->status().driving);
  EXPECT_TRUE(m_runtime->status().gate.owner.empty());
  const double stands = gone();
  step(1);
  EXPECT_EQ(gone(), stands);
  EXPECT_EQ(m_runtime->status().gate.refused, 0u) << m_runtime->status().gate.reason;
}

TEST_F(RuntimeDrive, EndsByItselfWhenItIsNotRepeated) {
  hold({0.3, 0, 0}, 1);
  step(1.2);
  EXPECT_FALSE(m_runtime->status().driving);
  const double stands = gone();
  step(0.5);
  EXPECT_EQ(gone(), stands);
}

TEST_F(RuntimeDrive, KeepsToItsAccelerationAndItsCaps) {
  EXPECT_EQ(m_runtime->drive({0.31, 0, 0}).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(m_runtime->drive({0, 0.1, 0}).error().code, ErrorCode::kOutOfLimits);
  double before = 0;
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(m_runtime->drive({i < 30 ? 0.3 : -0.3, 0, 0}).ok());
    step(0.02);
    const double now = m_runtime->status().base->twist.forward;
    EXPECT_LE(std::abs(now - before), 0.02 * m_workcell->base->max_acceleration + 1e-9);
    before = now;
  }
}

TEST_F(RuntimeDrive, ArmAndBaseNeverMoveTogether) {
  hold({0.2, 0, 0}, 0.4);
  ASSERT_TRUE(m_runtime->load(motion()).ok());
  EXPECT_EQ(m_runtime->play().error().code, ErrorCode::kRefused) << "the base has the robot";
  planning::JogCommand jog;
  jog.frame = planning::JogFrame::kJoint;
  jog.joint = 1;
  jog.turn = 1;
  EXPECT_EQ(m_runtime->jog(jog).error().code, ErrorCode::kRefused);
  const Eigen::VectorXd held = measured();
  step(1.5);
  EXPECT_EQ((measured() - held).norm(), 0);
}

TEST_F(RuntimeDrive, WhileTheArmMovesTheBaseStands) {
  loadAndPlay();
  step(1);
  EXPECT_EQ(m_runtime->drive({0.1, 0, 0}).error().code, ErrorCode::kRefused);
  m_runtime->pause();
  EXPECT_EQ(m_runtime->drive({0.1, 0, 0}).error().code, ErrorCode::kRefused) << "it still slows down";
  step(0.5);
  EXPECT_EQ(gone(), 0);
  hold({0.1, 0, 0}, 0.4);
  EXPECT_GT(gone(), 0.005);
}

TEST_F(RuntimeDrive, AMotionThatWasLoadedElsewhereIsNotPlayedOn) {
  loadAndPlay();
  step(1);
  m_runtime->pause();
  step(0.5);
  hold({0.2, 0, 0}, 0.6);
  m_runtime->releaseDrive();
  step(1);
  const auto refused = m_runtime->play();
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kStale);
  EXPECT_NE(refused.error().message.find("base has moved"), std::string::npos) << refused.error().message;
}

TEST_F(RuntimeDrive, StopStopsItAndNothingGoesOnByItself) {
  hold({0.3, 0, 0}, 1);
  m_runtime->stop("operator", "STOP pressed");
  const double stands = gone();
  step(1);
  EXPECT_NEAR(gone(), stands, 1e-9);
  EXPECT_EQ(m_runtime->drive({0.1, 0, 0}).error().code, ErrorCode::kRefused);
  ASSERT_TRUE(m_runtime->resetStop().ok());
  step(1);
  EXPECT_NEAR(gone(), stands, 1e-9);
  hold({0.1, 0, 0}, 0.4);
  EXPECT_GT(gone(), stands + 0.005);
}

TEST_F(RuntimeDrive, ALinkThatFallsSilentMidDriveStopsIt) {
  hold({0.3, 0, 0}, 1);
  m_base->freeze(true);
  for (int i = 0; i < 10; ++i) {
    (void)m_runtime->drive({0.3, 0, 0}).ok();
    step(0.05);
  }
  const auto status = m_runtime->status();
  EXPECT_TRUE(status.gate.stopped);
  EXPECT_EQ(status.gate.source, "link");
  EXPECT_FALSE(status.driving);
  EXPECT_NE(status.drive_notice.find("odometry"), std::string::npos) << status.drive_notice;
  m_base->freeze(false);
  const double stands = gone();
  step(1);
  EXPECT_NEAR(gone(), stands, 1e-9);
}

TEST_F(RuntimeDrive, AFaultOfTheBaseEndsTheDrive) {
  hold({0.2, 0, 0}, 0.6);
  m_base->injectFault("a track has come off");
  step(0.1);
  EXPECT_FALSE(m_runtime->status().driving);
  ASSERT_FALSE(m_runtime->status().faults.empty());
  EXPECT_NE(m_runtime->status().faults.front().find("track"), std::string::npos);
}

class RuntimeDriveWatched : public RuntimeDrive {
 protected:
  void SetUp() override {
    m_watchdog = true;
    RuntimeDrive::SetUp();
  }
};

TEST_F(RuntimeDriveWatched, AWindowThatHangsEndsTheDriveWithinAQuarterOfASecond) {
  m_runtime->touchGui();
  hold({0.2, 0, 0}, 1);
  for (int i = 0; i < 8; ++i) {  // somebody goes on asking, but the window has stopped answering
    (void)m_runtime->drive({0.2, 0, 0}).ok();
    step(0.04);
  }
  step(0.6);
  EXPECT_EQ(m_runtime->status().base->twist.forward, 0);
}

}  // namespace
}  // namespace longarm::session
