// Jogging through the runtime: the gate, STOP, the player and a window that hangs.
#include <gtest/gtest.h>

#include "tests/session/runtime_fixture.h"

namespace longarm::session {
namespace {

class RuntimeJog : public testing::RuntimeFixture {
 protected:
  static planning::JogCommand turn(double by = 1) {
    planning::JogCommand command;
    command.frame = planning::JogFrame::kJoint;
    command.joint = 1;
    command.turn = by;
    command.speed = 1;
    return command;
  }
  // As the window does it: ten times a second.
  void hold(const planning::JogCommand& command, double seconds) {
    for (double t = 0; t < seconds - 1e-9; t += 0.1) {
      if (m_watchdog) m_runtime->touchGui();
      const auto status = m_runtime->jog(command);
      ASSERT_TRUE(status.ok()) << status.error().message;
      step(0.1);
    }
  }
};

TEST_F(RuntimeJog, MovesWhileItIsHeldAndComesToRest) {
  start();
  hold(turn(), 1);
  EXPECT_TRUE(m_runtime->status().jogging);
  EXPECT_GT(speedNow(), 0.1);
  m_runtime->releaseJog();
  step(0.5);
  EXPECT_FALSE(m_runtime->status().jogging);
  EXPECT_LT(speedNow(), 1e-6);
  EXPECT_GT(measured()[1], m_home[1] + 0.1);
  EXPECT_NEAR(measured()[0], m_home[0], 1e-9);
  EXPECT_EQ(m_runtime->status().gate.refused, 0u);
  EXPECT_TRUE(m_runtime->status().gate.owner.empty());
}

TEST_F(RuntimeJog, EndsByItselfWhenItIsNotRepeated) {
  start();
  hold(turn(), 0.5);
  step(0.8);
  EXPECT_LT(speedNow(), 1e-6);
  const double stands = measured()[1];
  step(1);
  EXPECT_EQ(measured()[1], stands);
}

TEST_F(RuntimeJog, StopEndsItAndMustBeReleasedBeforeTheNext) {
  start();
  hold(turn(), 0.5);
  m_runtime->stop("operator", "STOP pressed");
  step(0.4);
  EXPECT_LT(speedNow(), 1e-6);
  const double stands = measured()[1];
  EXPECT_EQ(m_runtime->jog(turn()).error().code, ErrorCode::kRefused);
  step(0.5);
  EXPECT_EQ(measured()[1], stands);
  ASSERT_TRUE(m_runtime->resetStop().ok());
  step(0.5);
  EXPECT_EQ(measured()[1], stands) << "nothing goes on by itself";
  hold(turn(-1), 0.5);
  EXPECT_LT(measured()[1], stands);
}

TEST_F(RuntimeJog, AndThePlayerExcludeEachOther) {
  start();
  loadAndPlay();
  step(0.2);
  EXPECT_EQ(m_runtime->jog(turn()).error().code, ErrorCode::kRefused);
  m_runtime->pause();
  step(0.5);
  hold(turn(), 0.3);
  const auto played = m_runtime->play();
  ASSERT_FALSE(played.ok());
  m_runtime->releaseJog();
  step(0.6);
  EXPECT_FALSE(m_runtime->play().ok()) << "the arm is not on the path any more";
}

TEST_F(RuntimeJog, EndsWhenTheWindowHangs) {
  m_watchdog = true;
  start();
  m_runtime->touchGui();
  hold(turn(), 0.5);
  for (int i = 0; i < 8; ++i) {       // the command goes on, the window does not
    (void)m_runtime->jog(turn());
    step(0.1);
  }
  EXPECT_LT(speedNow(), 1e-6);
}

TEST_F(RuntimeJog, EndsWhenJointStatesStayAway) {
  start();
  hold(turn(), 0.5);
  m_arm->freeze(true);
  step(0.6);
  m_arm->freeze(false);
  step(0.1);
  EXPECT_LT(speedNow(), 1e-6);
}

}  // namespace
}  // namespace longarm::session
