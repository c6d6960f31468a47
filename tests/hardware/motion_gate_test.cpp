#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <thread>

#include "tests/hardware/gate_rig.h"

namespace longarm::hardware::tests {
namespace {

const Eigen::Vector3d kDiagonal(1, -0.5, 0.25);

std::string why(const Status& status) { return status.ok() ? "accepted" : status.error().message; }

#define EXPECT_REFUSED(status, error_code, words)                                     \
  do {                                                                                \
    const Status outcome = (status);                                                  \
    EXPECT_FALSE(outcome.ok());                                                       \
    EXPECT_EQ(outcome.error().code, error_code) << why(outcome);                      \
    EXPECT_NE(why(outcome).find(words), std::string::npos) << why(outcome);           \
  } while (false)

Horizon good() { return restToRest(Eigen::Vector3d::Zero(), 0.03 * kDiagonal, 0.3); }

TEST(MotionGate, AGoodHorizonReachesTheArmAndIsFollowed) {
  GateRig rig;
  rig.start();
  const Status status = rig.submit(good());
  ASSERT_TRUE(status.ok()) << why(status);
  rig.clock.advance(0.5);
  EXPECT_LT((rig.position() - 0.03 * kDiagonal).norm(), 1e-12);
  EXPECT_EQ(rig.gate.status().accepted, 1u);
}

TEST(MotionGate, NothingMovesBeforeStopIsReleasedAndTheArmIsTaken) {
  GateRig rig;
  EXPECT_TRUE(rig.gate.status().stopped);
  EXPECT_REFUSED(rig.gate.acquire("player"), ErrorCode::kRefused, "STOP is latched");
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kRefused, "STOP is latched");
  ASSERT_TRUE(rig.gate.reset().ok());
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kRefused, "nobody has taken it");
  ASSERT_TRUE(rig.gate.acquire("jog").ok());
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kRefused, "\"jog\" has it");
  EXPECT_REFUSED(rig.gate.acquire("player"), ErrorCode::kRefused, "\"jog\" has it");
  rig.gate.release("player");
  EXPECT_EQ(rig.gate.status().owner, "jog");
  rig.gate.release("jog");
  EXPECT_TRUE(rig.gate.acquire("player").ok());
  EXPECT_EQ(rig.arm->horizonsReceived(), 0u);
}

TEST(MotionGate, StaleAndMissingJointStatesRefuseMotion) {
  GateRig rig;
  rig.start();
  rig.arm->freeze(true);
  rig.clock.advance(0.21);
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kStale, "0.210 s old");
  rig.arm->freeze(false);
  EXPECT_TRUE(rig.submit(good()).ok());
}

TEST(MotionGate, TheSequenceOfOneOwnerMustGrow) {
  GateRig rig;
  rig.start();
  ASSERT_TRUE(rig.submit(good()).ok());
  rig.sequence -= 1;
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kRefused, "sequence must grow");
}

TEST(MotionGate, MalformedHorizonsAreRefusedWithPointJointAndValue) {
  GateRig rig;
  rig.start();
  const auto refused = [&](auto change, ErrorCode code, const std::string& words) {
    Horizon h = good();
    change(h);
    EXPECT_REFUSED(rig.submit(h), code, words);
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  refused([](Horizon& h) { std::swap(h.joint_names[0], h.joint_names[1]); }, ErrorCode::kInvalidInput, "in this order");
  refused([](Horizon& h) { h.points.clear(); }, ErrorCode::kInvalidInput, "has 0 points");
  refused([](Horizon& h) { h.points[3].velocities.resize(2); }, ErrorCode::kInvalidInput, "needs 3");
  refused([&](Horizon& h) { h.points[2].positions[1] = nan; }, ErrorCode::kInvalidInput, "point 2: holds a number");
  refused([&](Horizon& h) { h.points[2].accelerations[1] = inf; }, ErrorCode::kInvalidInput, "not finite");
  refused([&](Horizon& h) { h.points[2].t = nan; }, ErrorCode::kInvalidInput, "not finite");
  refused([](Horizon& h) { h.points[2].t = h.points[1].t; }, ErrorCode::kInvalidInput, "times start at 0");
  refused([](Horizon& h) { h.points[0].t = 5e-324; }, ErrorCode::kInvalidInput, "times start at 0");
  refused([](Horizon& h) { h.points.back().velocities[1] = 0.01; }, ErrorCode::kInvalidInput, "joint_2 still moves at 0.01");
  refused([](Horizon& h) { h.points.back().t = 0.7; }, ErrorCode::kOutOfLimits, "lasts 0.7 s");
  refused([](Horizon& h) { h.is_stop = true; }, ErrorCode::kRefused, "only STOP");
  EXPECT_EQ(rig.arm->horizonsReceived(), 0u);
  EXPECT_EQ(rig.gate.status().refused, 11u);
}

TEST(MotionGate, LimitsOfPositionVelocityAndAccelerationHold) {
  GateRig rig;
  rig.start();
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  EXPECT_REFUSED(rig.submit(restToRest(zero, Eigen::Vector3d(0.4, 0, 0), 0.45)), ErrorCode::kOutOfLimits, "joint_1");
  EXPECT_REFUSED(rig.submit(restToRest(zero, Eigen::Vector3d(0, 0.1, 0), 0.3)), ErrorCode::kOutOfLimits,
                 "joint_2 accelerates at");
  Horizon jump = good();   // velocities lie about the positions
  for (std::size_t i = 5; i < jump.points.size(); ++i) jump.points[i].positions[2] += 0.01;
  EXPECT_REFUSED(rig.submit(jump), ErrorCode::kOutOfLimits, "joint_3");
  EXPECT_EQ(rig.arm->horizonsReceived(), 0u);
}

TEST(MotionGate, AnArmOutsideItsLimitsMayComeBackButGoNoFurther) {
  GateOptions options;
  options.limit_margin = 2.01;           // the arm stands 0.01 outside at 0
  GateRig rig(3, options);
  rig.start();
  EXPECT_REFUSED(rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.03, 0, 0), 0.3)),
                 ErrorCode::kOutOfLimits, "joint_1 at");
  Horizon still = restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.3);
  EXPECT_TRUE(rig.submit(still).ok());
}

TEST(MotionGate, AJumpFromTheMeasuredJointsIsRefused) {
  GateRig rig;
  rig.start();
  EXPECT_REFUSED(rig.submit(restToRest(Eigen::Vector3d(0, 0.03, 0), Eigen::Vector3d::Zero(), 0.3)),
                 ErrorCode::kOutOfLimits, "from the measured position of joint joint_2");
  EXPECT_REFUSED(rig.submit(brakingHorizon(Eigen::Vector3d::Zero(), kDiagonal, 0.2, 3)), ErrorCode::kOutOfLimits,
                 "measured velocity of joint joint_1");
}

TEST(MotionGate, AHorizonInMotionMustContinueTheCommandedPositionAndVelocity) {
  GateRig rig;
  rig.start();
  ASSERT_TRUE(rig.submit(good()).ok());
  rig.clock.advance(0.14);
  const auto commanded = rig.gate.commandedAt(rig.clock.now_s());
  ASSERT_TRUE(commanded.ok());
  ASSERT_GT(commanded->velocities.norm(), 0.1);
  const auto speed = commanded->velocities[0];
  EXPECT_REFUSED(rig.submit(restToRest(commanded->positions, Eigen::Vector3d::Zero(), 0.3)),
                 ErrorCode::kOutOfLimits, "commanded velocity of joint joint_1");
  const Eigen::VectorXd off = commanded->positions + Eigen::Vector3d(0, 0, 0.006);
  EXPECT_REFUSED(rig.submit(brakingHorizon(off, kDiagonal, speed, 2)), ErrorCode::kOutOfLimits,
                 "commanded position of joint joint_3");
  const Status status = rig.submit(brakingHorizon(commanded->positions, kDiagonal, speed, 2));
  EXPECT_TRUE(status.ok()) << why(status);
}

TEST(MotionGate, AStartTimeFarFromNowIsRefused) {
  GateRig rig;
  rig.start();
  Horizon h = good();
  h.sequence = 1;
  h.start_s = rig.clock.now_s() - 0.3;
  EXPECT_REFUSED(rig.gate.submit(h), ErrorCode::kStale, "-0.300 s from now");
  h.start_s = rig.clock.now_s() + 0.3;
  EXPECT_REFUSED(rig.gate.submit(h), ErrorCode::kRefused, "0.300 s from now");
  h.start_s = std::nan("");
  EXPECT_REFUSED(rig.gate.submit(h), ErrorCode::kInvalidInput, "not finite");
}

TEST(MotionGate, ToolSpeedAndClearanceAreAskedOfTheCallables) {
  GateChecks checks;
  checks.tool_position = [](const Eigen::VectorXd& q) { return Eigen::Vector3d(q[0], q[1], q[2]); };
  checks.max_tool_speed = 0.25;
  checks.clearance = [](const Eigen::VectorXd& q) { return 0.02 - q[0]; };
  checks.min_clearance = 0.01;
  GateRig rig(3, {}, checks);
  rig.start();
  EXPECT_REFUSED(rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0.08, 0), 0.45)),
                 ErrorCode::kOutOfLimits, "the tool moves at 0.2");
  EXPECT_REFUSED(rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.015, 0, 0), 0.3)),
                 ErrorCode::kCollision, "5.0 mm of clearance");
  EXPECT_TRUE(rig.submit(restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(-0.015, 0, 0), 0.3)).ok());
}

TEST(MotionGate, ACheckThatThrowsRefusesTheHorizon) {
  GateChecks checks;
  checks.clearance = [](const Eigen::VectorXd&) -> double { throw std::runtime_error("no geometry"); };
  GateRig rig(3, {}, checks);
  rig.start();
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kInternal, "no geometry");
}

TEST(MotionGate, ATrackingErrorHeldForATenthOfASecondStops) {
  GateRig rig;
  rig.start();
  ASSERT_TRUE(rig.submit(good()).ok());
  rig.clock.advance(0.02);
  rig.gate.watch();
  rig.arm->setOffset(Eigen::Vector3d(0, 0.11, 0));
  rig.clock.advance(0.02);
  rig.gate.watch();
  rig.clock.advance(0.05);
  rig.gate.watch();
  EXPECT_FALSE(rig.gate.stopped()) << "only 50 ms";
  rig.clock.advance(0.06);
  rig.gate.watch();
  EXPECT_TRUE(rig.gate.stopped());
  EXPECT_EQ(rig.gate.status().source, "tracking");
  EXPECT_NE(rig.gate.status().reason.find("joint_2 is 0.110 from where it was sent"), std::string::npos);
}

TEST(MotionGate, AShortTrackingErrorDoesNotStop) {
  GateRig rig;
  rig.start();
  ASSERT_TRUE(rig.submit(good()).ok());
  for (int i = 0; i < 10; ++i) {
    rig.arm->setOffset(Eigen::Vector3d(0, i % 3 == 0 ? 0.0 : 0.2, 0));
    rig.clock.advance(0.04);
    rig.gate.watch();
  }
  EXPECT_FALSE(rig.gate.stopped());
}

TEST(MotionGate, StopLatchesTakesTheArmAwayAndKeepsTheFirstReason) {
  GateRig rig;
  rig.start();
  std::string told;
  rig.gate.onStop([&](const std::string& source, const std::string& reason) { told = source + ": " + reason; });
  ASSERT_TRUE(rig.submit(good()).ok());
  rig.clock.advance(0.1);
  rig.gate.stop("operator", "space bar");
  rig.gate.stop("link", "no heartbeat");
  EXPECT_EQ(told, "link: no heartbeat");
  EXPECT_EQ(rig.gate.status().source, "operator");
  EXPECT_EQ(rig.gate.status().owner, "");
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kRefused, "STOP is latched");
  EXPECT_REFUSED(rig.gate.reset(), ErrorCode::kRefused, "still brakes");
  rig.clock.advance(1);
  ASSERT_TRUE(rig.gate.reset().ok());
  EXPECT_FALSE(rig.gate.status().stopped);
  EXPECT_EQ(rig.gate.status().reason, "");
}

TEST(MotionGate, ResetIsRefusedWhileTheArmIsInFaultOrClosed) {
  GateRig rig;
  rig.arm->injectFault("drive 3 overheated");
  EXPECT_REFUSED(rig.gate.reset(), ErrorCode::kRefused, "in fault");
  rig.arm->close();
  EXPECT_REFUSED(rig.gate.reset(), ErrorCode::kRefused, "closed");
  EXPECT_TRUE(rig.gate.stopped());
}

TEST(MotionGate, AFaultOfTheArmRefusesMotionWithItsReason) {
  GateRig rig;
  rig.start();
  rig.arm->injectFault("drive 3 overheated");
  EXPECT_REFUSED(rig.submit(good()), ErrorCode::kRefused, "drive 3 overheated");
}

// An arm whose send() is interrupted by STOP, the worst moment there is.
class InterruptedArm final : public RunnerDevice<RobotArm> {
 public:
  explicit InterruptedArm(const Clock& clock) : RunnerDevice<RobotArm>("arm"), m_clock(clock) {}
  std::shared_ptr<const JointState> jointState() const override {
    return std::make_shared<const JointState>(
        JointState{m_clock.now_s(), jointNames(3), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  }
  Result<JointState> jointStateAt(double) const override { return Error{ErrorCode::kStale, "none"}; }
  Status send(const Horizon&) override {
    if (during_send) during_send();
    last = "motion";
    return {};
  }
  std::function<void()> during_send;
  std::string last;

 protected:
  Status onStop() override {
    last = "stop";
    return {};
  }

 private:
  const Clock& m_clock;
};

TEST(MotionGate, AStopDuringTheSendingOfAHorizonHasTheLastWord) {
  ManualClock clock(10);
  auto arm = std::make_shared<InterruptedArm>(clock);
  ASSERT_TRUE(arm->open().ok());
  MotionGate gate(arm, jointNames(3), testLimits(3), clock);
  ASSERT_TRUE(gate.reset().ok());
  ASSERT_TRUE(gate.acquire("player").ok());
  arm->during_send = [&] {
    arm->during_send = nullptr;
    gate.stop("operator", "space bar");
  };
  Horizon h = good();
  h.start_s = 10;
  EXPECT_REFUSED(gate.submit(h), ErrorCode::kRefused, "STOP was pressed");
  EXPECT_EQ(arm->last, "stop");
  EXPECT_TRUE(gate.stopped());
}

TEST(MotionGate, ADriverThatThrowsIsARefusalAndStopStillWorks) {
  ManualClock clock(10);
  auto arm = std::make_shared<InterruptedArm>(clock);
  ASSERT_TRUE(arm->open().ok());
  MotionGate gate(arm, jointNames(3), testLimits(3), clock);
  ASSERT_TRUE(gate.reset().ok());
  ASSERT_TRUE(gate.acquire("player").ok());
  arm->during_send = [] { throw std::runtime_error("cable"); };
  Horizon h = good();
  h.start_s = 10;
  EXPECT_REFUSED(gate.submit(h), ErrorCode::kInternal, "cable");
  gate.onStop([](const std::string&, const std::string&) { throw 42; });
  gate.stop("operator", "space bar");
  EXPECT_EQ(arm->last, "stop");
}

TEST(MotionGate, StopFromOneThreadEndsWhateverAnotherSubmits) {
  for (int round = 0; round < 50; ++round) {
    GateRig rig;
    rig.start();
    std::atomic<bool> quit{false};
    std::thread submitter([&] {
      std::uint64_t k = 0;
      while (!quit) {
        Horizon h = good();
        h.sequence = ++k;
        h.start_s = rig.clock.now_s();
        (void)rig.gate.submit(h);
      }
    });
    std::this_thread::yield();
    rig.gate.stop("operator", "space bar");
    quit = true;
    submitter.join();
    const auto received = rig.arm->horizonsReceived();
    (void)rig.submit(good());
    EXPECT_EQ(rig.arm->horizonsReceived(), received);
    rig.clock.advance(0.2);              // speed <= 1 at deceleration 12: stands after 0.09 s
    EXPECT_EQ(rig.velocity().norm(), 0);
    const Eigen::VectorXd there = rig.position();
    rig.clock.advance(5);
    EXPECT_EQ((rig.position() - there).norm(), 0);
  }
}

}  // namespace
}  // namespace longarm::hardware::tests
