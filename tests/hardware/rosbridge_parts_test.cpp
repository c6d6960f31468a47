// The parts of the driver that know neither threads nor sockets.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "hardware/drivers/rosbridge/clock_offset.h"
#include "hardware/drivers/rosbridge/joint_history.h"
#include "hardware/drivers/rosbridge/outbox.h"
#include "hardware/drivers/rosbridge/topic_names.h"

namespace longarm::hardware {
namespace {

JointState stateAt(double stamp_s, double position) {
  JointState out{stamp_s, {"a", "b"}, Eigen::Vector2d(position, -position), {}};
  out.velocities = Eigen::Vector2d(position * 10, 0);
  return out;
}

TEST(ClockOffset, IsUnknownBeforeTheFirstMessage) { EXPECT_FALSE(ClockOffset().offset()); }

TEST(ClockOffset, TakesTheMessageThatTravelledFastest) {
  ClockOffset offset;
  offset.add(1000.00, 10.030);
  offset.add(1000.01, 10.012);           // 2 ms on its way
  offset.add(1000.02, 10.060);
  EXPECT_NEAR(*offset.offset(), -989.998, 1e-9);
}

TEST(ClockOffset, IsNeverOffByMoreThanTheFastestTravel) {
  std::mt19937 rng(5);
  std::exponential_distribution<double> travel(1 / 0.02);   // 20 ms in the mean
  ClockOffset offset;
  const double truth = -1234.5;
  for (int i = 0; i < 3000; ++i) {
    const double sent = 2000 + i * 0.01;
    offset.add(sent, sent + truth + 0.0005 + travel(rng));
    if (i > 300) {
      EXPECT_NEAR(*offset.offset(), truth + 0.0005, 0.001);
    }
  }
}

TEST(ClockOffset, FollowsAClockThatDrifts) {
  ClockOffset offset;
  for (int i = 0; i < 10000; ++i) {      // 100 s at 100 ppm
    const double now = i * 0.01;
    offset.add(now * (1 - 1e-4), now);
  }
  EXPECT_NEAR(*offset.offset(), 99.99e-4, 1.1e-3);   // behind by at most the drift of one window of 10 s
}

TEST(ClockOffset, ForgetsAFastMessageAfterTheWindow) {
  ClockOffset offset(2);
  offset.add(0, 10);
  for (int i = 1; i < 400; ++i) offset.add(i * 0.01, 10.1 + i * 0.01);
  EXPECT_NEAR(*offset.offset(), 10.1, 1e-9);
}

TEST(ClockOffset, BeginsAnewWhenTheRobotsClockIsSetBack) {
  ClockOffset offset;
  offset.add(100000, 50);
  offset.add(3, 50.1);
  EXPECT_NEAR(*offset.offset(), 47.1, 1e-9);
}

TEST(JointHistory, IsStaleWhileEmpty) { EXPECT_EQ(JointHistory().at(1).error().code, ErrorCode::kStale); }

TEST(JointHistory, InterpolatesBetweenTwoStates) {
  JointHistory history;
  EXPECT_TRUE(history.add(stateAt(10.0, 0.0)));
  EXPECT_TRUE(history.add(stateAt(10.1, 1.0)));
  const auto state = history.at(10.025);
  ASSERT_TRUE(state.ok()) << state.error().message;
  EXPECT_NEAR(state->positions[0], 0.25, 1e-9);
  EXPECT_NEAR(state->positions[1], -0.25, 1e-9);
  EXPECT_NEAR(state->velocities[0], 2.5, 1e-9);
  EXPECT_EQ(state->stamp_s, 10.025);
}

TEST(JointHistory, ReachesBackSeveralSecondsAndNoFurther) {
  JointHistory history(8);
  for (int i = 0; i <= 2000; ++i) history.add(stateAt(i * 0.01, i * 0.01));
  for (const double t : {12.0, 15.555, 20.0}) {
    const auto state = history.at(t);
    ASSERT_TRUE(state.ok()) << state.error().message;
    EXPECT_NEAR(state->positions[0], t, 1e-9);
  }
  EXPECT_EQ(history.at(11.9).error().code, ErrorCode::kStale);
  const auto future = history.at(20.5);
  ASSERT_FALSE(future.ok());
  EXPECT_NE(future.error().message.find("8.00 s"), std::string::npos) << future.error().message;
}

TEST(JointHistory, DropsWhatComesTooLateButStartsAnewWithANewClock) {
  JointHistory history;
  history.add(stateAt(10.0, 1));
  EXPECT_FALSE(history.add(stateAt(9.99, 2)));
  EXPECT_FALSE(history.add(stateAt(10.0, 2)));
  EXPECT_EQ(history.newest()->positions[0], 1);
  EXPECT_TRUE(history.add(stateAt(0.1, 3)));
  EXPECT_EQ(history.at(10.0).error().code, ErrorCode::kStale);
  EXPECT_EQ(history.newest()->positions[0], 3);
}

TEST(JointHistory, DoesNotMixStatesOfDifferentJoints) {
  JointHistory history;
  history.add(stateAt(1.0, 0));
  JointState other{2.0, {"c"}, Eigen::VectorXd::Constant(1, 7), {}};
  history.add(other);
  const auto state = history.at(1.5);
  ASSERT_TRUE(state.ok());
  EXPECT_EQ(state->names, other.names);
}

TEST(Outbox, KeepsTheOrder) {
  Outbox box;
  EXPECT_TRUE(box.push({"one", false, 0}).ok());
  EXPECT_TRUE(box.push({"two", true, 5}).ok());
  EXPECT_EQ(box.pop(1)->text, "one");
  EXPECT_EQ(box.pop(1)->text, "two");
  EXPECT_FALSE(box.pop(1));
}

TEST(Outbox, StopPassesEverythingAndDropsWaitingMotion) {
  Outbox box;
  ASSERT_TRUE(box.push({"subscribe", false, 0}).ok());
  ASSERT_TRUE(box.push({"horizon", true, 100}).ok());
  box.pushUrgent("brake");
  box.pushUrgent("stop");
  const auto first = box.pop(1);
  EXPECT_EQ(first->text, "brake");
  EXPECT_TRUE(first->urgent);
  EXPECT_EQ(box.pop(1)->text, "stop");
  EXPECT_EQ(box.pop(1)->text, "subscribe");
  EXPECT_FALSE(box.pop(1));
  EXPECT_EQ(box.dropped(), 1u);
}

TEST(Outbox, DoesNotSendMotionThatIsTooOld) {
  Outbox box;
  ASSERT_TRUE(box.push({"old", true, 1.0}).ok());
  ASSERT_TRUE(box.push({"fresh", true, 3.0}).ok());
  EXPECT_EQ(box.pop(2.0)->text, "fresh");
  EXPECT_EQ(box.dropped(), 1u);
}

TEST(Outbox, IsBoundedButNeverForStop) {
  Outbox box(3);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(box.push({"x", false, 0}).ok());
  const auto full = box.push({"x", false, 0});
  ASSERT_FALSE(full.ok());
  EXPECT_EQ(full.error().code, ErrorCode::kRefused);
  EXPECT_NE(full.error().message.find("3 messages"), std::string::npos) << full.error().message;
  box.pushUrgent("stop");
  EXPECT_EQ(box.pop(0)->text, "stop");
}

TEST(TopicNames, AreThoseOfTheInterfaceUnlessReplaced) {
  const TopicNames names(std::map<std::string, std::string>{{"/joint_states", "/my_robot/joints"},
                                                           {"/pan_tilt/head/command", "/neck"}});
  EXPECT_EQ(names.jointStates(), "/my_robot/joints");
  EXPECT_EQ(names.panTiltCommand("head"), "/neck");
  EXPECT_EQ(names.panTiltCommand("other"), "/pan_tilt/other/command");
  EXPECT_EQ(names.image("wrist"), "/camera/wrist/image/compressed");
}

}  // namespace
}  // namespace longarm::hardware
