// The console and the virtual robot in real time, when the link, the robot or the console goes away.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <thread>

#include <gtest/gtest.h>

#include "hardware/drivers/rosbridge/rosbridge_arm.h"
#include "hardware/fault_proxy/fault_proxy.h"
#include "planning/macros/macro.h"
#include "planning/trajectory/trajectory_file.h"
#include "session/robot/robot_runtime.h"
#include "tests/session/task_fixture.h"

extern char** environ;

namespace longarm::session {
namespace {

using hardware::FaultProxy;
using planning::PlayerState;

constexpr double kOnPath = 0.1 * M_PI / 180;   // what the figures allow [rad]
constexpr double kStill = 0.004;         // measured speed of an arm that stands: noise of the encoders [rad/s]

bool eventually(const std::function<bool()>& condition, double timeout_s) {
  const SteadyClock clock;
  for (const double end = clock.now_s() + timeout_s; clock.now_s() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return condition();
}

// Largest joint difference to the nearest point of the path.
double offPath(const Trajectory& path, const Eigen::VectorXd& q) {
  double least = 1e9;
  for (double t = 0; t <= path.duration(); t += 0.002) {
    least = std::min(least, (path.sample(t).positions - q).cwiseAbs().maxCoeff());
  }
  return least;
}

std::string script(const std::string& name, const std::string& body) {
  const std::string path = ::testing::TempDir() + "link_" + name + ".sh";
  std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
  chmod(path.c_str(), 0755);
  return path;
}

std::shared_ptr<const planning::Workcell> workcell() {
  static const auto cell = std::make_shared<const planning::Workcell>(testing::builtInWorkcell());
  return cell;
}

TEST(VirtualMode, ConnectsToNothingButThisMachine) {
  RuntimeOptions options;
  options.gui_watchdog = false;
  options.virtual_robot = script("far", "echo '{\"url\":\"ws://10.1.2.3:9090\"}'\ncat > /dev/null");
  const auto far = RobotRuntime::start(workcell(), options);
  ASSERT_FALSE(far.ok());
  EXPECT_EQ(far.error().code, ErrorCode::kRefused);
  EXPECT_NE(far.error().message.find("ws://10.1.2.3:9090"), std::string::npos) << far.error().message;
  options.virtual_robot = script("near", "echo '{\"url\":\"ws://127.0.0.1:9\"}'\ncat > /dev/null");
  options.through = [](const std::string&) { return std::string("ws://robot.example:9090"); };
  const auto through = RobotRuntime::start(workcell(), options);
  ASSERT_FALSE(through.ok());
  EXPECT_EQ(through.error().code, ErrorCode::kRefused);
}

TEST(VirtualMode, NeverTakesTheAddressOrDriverOfTheWorkcell) {
  auto cell = testing::builtInWorkcell();
  cell.backend.url = "ws://10.1.2.3:9090";
  RuntimeOptions options;
  options.gui_watchdog = false;
  options.virtual_robot = "/nowhere/longarm-virtual-robot";
  const auto started = RobotRuntime::start(std::make_shared<planning::Workcell>(cell), options);
  ASSERT_FALSE(started.ok()) << "it must not fall back to the real robot";
  EXPECT_EQ(started.error().code, ErrorCode::kNotFound);
}

TEST(LiveMode, RefusesADriverAndAnAddressItDoesNotKnow) {
  auto cell = testing::builtInWorkcell();
  cell.backend.driver = "mystery";
  cell.backend.url = "ws://127.0.0.1:9";
  RuntimeOptions options;
  options.mode = RobotMode::kLive;
  const auto driver = RobotRuntime::start(std::make_shared<planning::Workcell>(cell), options);
  ASSERT_FALSE(driver.ok());
  EXPECT_NE(driver.error().message.find("mystery"), std::string::npos) << driver.error().message;
  cell.backend = {};
  cell.backend.url = "http://robot";
  const auto url = RobotRuntime::start(std::make_shared<planning::Workcell>(cell), options);
  ASSERT_FALSE(url.ok());
  EXPECT_NE(url.error().message.find("http://robot"), std::string::npos) << url.error().message;
}

class LinkLoss : public ::testing::Test {
 protected:
  void SetUp() override {
    LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
    RuntimeOptions options;
    options.gui_watchdog = false;
    options.cameras = false;
    options.stream_cameras = false;
    options.virtual_robot = testing::virtualRobot();
    options.through = [this](const std::string& url) {
      auto proxy = FaultProxy::start(url);
      EXPECT_TRUE(proxy.ok());
      m_proxy = std::move(*proxy);
      return m_proxy->url();
    };
    auto started = RobotRuntime::start(workcell(), options);
    ASSERT_TRUE(started.ok()) << started.error().message;
    m_runtime = std::move(*started);
    const auto up = m_runtime->waitUntilUp(20);
    ASSERT_TRUE(up.ok()) << up.error().message;
  }

  // To "home", which takes several seconds.
  void startMoving() {
    ASSERT_TRUE(m_runtime->resetStop().ok());
    planning::PlanContext context;
    context.workcell = workcell().get();
    context.start = *m_runtime->configuration();
    const auto macros = planning::makeMacros(*workcell());
    const auto plan = planning::findMacro(macros, "home")->plan(context, nullptr);
    ASSERT_TRUE(plan.ok()) << plan.reason;
    m_path = plan.trajectory;
    ASSERT_TRUE(eventually([&] { return m_runtime->load(m_path).ok(); }, 5));
    ASSERT_TRUE(keepPlaying([&] { return m_runtime->status().cursor > 0.3 * m_path.duration() && speed() > 0.05; }))
        << m_runtime->status().notice;
  }
  // A busy machine delivers joint states too late now and then, and the gate stops as it must: then the operator goes on.
  bool keepPlaying(const std::function<bool()>& until) {
    return eventually([&] {
      if (until()) return true;
      const auto status = m_runtime->status();
      if (status.player == PlayerState::kPlaying || status.player == PlayerState::kDone) return false;
      if (!status.gate.stopped || m_runtime->resetStop().ok()) (void)m_runtime->play();
      return false;
    }, 60);
  }
  Eigen::VectorXd arm() const { return *m_runtime->jointState()->positionsOf(workcell()->armJointNames()); }
  double speed() const {
    const auto state = m_runtime->jointState();
    return state->velocities.size() > 0 ? state->velocities.cwiseAbs().maxCoeff() : 0;
  }
  // The gate latches and brakes first and writes down who asked for it after that.
  std::string stoppedBy() const {
    const auto gate = m_runtime->status().gate;
    return gate.stopped ? gate.source : "";
  }
  bool up() const { return m_runtime->status().link == LinkState::kUp; }

  // After a loss: STOP is latched by the link, the arm stands on its path and stays there although the link is back.
  void expectStoppedAndRecovered() {
    ASSERT_TRUE(eventually([&] { return stoppedBy() != ""; }, 5)) << "the motion went on";
    EXPECT_EQ(stoppedBy(), "link") << m_runtime->status().gate.reason;
    ASSERT_TRUE(eventually([&] { return up() && speed() < kStill; }, 15)) << m_runtime->status().link_text;
    const Eigen::VectorXd stands = arm();
    EXPECT_LT(offPath(m_path, stands), kOnPath);
    const SteadyClock clock;
    for (const double end = clock.now_s() + 1; clock.now_s() < end;) {
      ASSERT_LT((arm() - stands).cwiseAbs().maxCoeff(), 0.002) << "it has resumed by itself";
    }
    EXPECT_FALSE(m_runtime->play().ok()) << "STOP must be released first";
  }

  void expectThatItGoesOnWhenAsked() {
    EXPECT_TRUE(keepPlaying([&] { return m_runtime->status().player == PlayerState::kDone; }))
        << m_runtime->status().notice;
    EXPECT_TRUE(eventually([&] { return (arm() - m_path.points.back().positions).cwiseAbs().maxCoeff() < kOnPath; }, 5));
  }

  std::unique_ptr<FaultProxy> m_proxy;
  Trajectory m_path;
  std::unique_ptr<RobotRuntime> m_runtime;
};

TEST_F(LinkLoss, ACutOfATenthOfASecondStopsTheMotionUntilTheOperatorGoesOn) {
  startMoving();
  m_proxy->cut(0.1);
  expectStoppedAndRecovered();
  expectThatItGoesOnWhenAsked();
}

TEST_F(LinkLoss, ACutOfASecondStopsTheMotionUntilTheOperatorGoesOn) {
  startMoving();
  m_proxy->cut(1.0);
  expectStoppedAndRecovered();
  expectThatItGoesOnWhenAsked();
}

TEST_F(LinkLoss, AGapOfASecondStopsTheMotionUntilTheOperatorGoesOn) {
  startMoving();
  m_proxy->hold(FaultProxy::Direction::kBoth, 1.0);
  expectStoppedAndRecovered();
  expectThatItGoesOnWhenAsked();
}

TEST_F(LinkLoss, ALinkThatIsGoneForGoodIsSaidToBeLostAndARestartMendsIt) {
  startMoving();
  m_proxy->cut(-1);
  ASSERT_TRUE(eventually([&] { return m_runtime->status().link == LinkState::kLost; }, 5));
  EXPECT_NE(m_runtime->status().link_text.find("lost"), std::string::npos) << m_runtime->status().link_text;
  EXPECT_TRUE(m_runtime->status().gate.stopped);
  EXPECT_FALSE(m_runtime->play().ok());
  m_runtime->stop("operator", "STOP pressed");   // must not wait for a link that is not there
  const auto again = m_runtime->restart();
  ASSERT_TRUE(again.ok()) << again.error().message;
  ASSERT_TRUE(m_runtime->waitUntilUp(20).ok());
  EXPECT_TRUE(m_runtime->status().gate.stopped);
  EXPECT_EQ(m_runtime->status().player, PlayerState::kEmpty);
  EXPECT_TRUE(m_runtime->resetStop().ok());
}

TEST_F(LinkLoss, ALinkThatIsCutWhileNothingMovesLatchesStopAllTheSame) {
  ASSERT_TRUE(m_runtime->resetStop().ok());
  m_proxy->cut(0.3);
  EXPECT_TRUE(eventually([&] { return stoppedBy() == "link"; }, 5)) << stoppedBy();
  // Until the link is back, releasing STOP is refused.
  EXPECT_TRUE(eventually([&] { return m_runtime->resetStop().ok(); }, 10));
  EXPECT_TRUE(eventually([&] { return up(); }, 5));
}

TEST_F(LinkLoss, AKilledRobotIsNamedAndCanBeStartedAnew) {
  startMoving();
  const int pid = m_runtime->virtualRobotPid();
  ASSERT_GT(pid, 0);
  ASSERT_EQ(::kill(pid, SIGKILL), 0);
  ASSERT_TRUE(eventually([&] { return m_runtime->status().link == LinkState::kLost; }, 5));
  EXPECT_NE(m_runtime->status().link_text.find("was killed by signal 9"), std::string::npos) << m_runtime->status().link_text;
  EXPECT_FALSE(m_runtime->status().faults.empty());
  EXPECT_TRUE(eventually([&] { return m_runtime->status().gate.stopped; }, 5));
  EXPECT_FALSE(m_runtime->callService("/virtual_robot/info", "{}", 0.5).ok());
  const auto again = m_runtime->restart();
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_NE(m_runtime->virtualRobotPid(), pid);
  ASSERT_TRUE(m_runtime->waitUntilUp(20).ok());
  startMoving();
}

// A console that is killed: a process of its own, which this test watches from the robot's side.
class KilledConsole : public ::testing::Test {
 protected:
  void SetUp() override {
    LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
    auto robot = VirtualRobotProcess::start(testing::virtualRobot(), {"--scenario", "grab_pipe", "--port", "0", "--no-cameras"}, 20);
    ASSERT_TRUE(robot.ok()) << robot.error().message;
    m_robot = std::move(*robot);
  }
  void TearDown() override {
    if (m_console > 0) {
      ::kill(m_console, SIGKILL);
      ::waitpid(m_console, nullptr, 0);
    }
  }

  void startConsole(const std::string& speed) {
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::string program = LONGARM_MOVING_CONSOLE, url = m_robot->url(), rate = speed;
    char* argv[] = {program.data(), url.data(), m_file.data(), rate.data(), nullptr};
    const int failed = posix_spawn(&m_console, program.c_str(), &actions, nullptr, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    ASSERT_EQ(failed, 0);
    FILE* said = fdopen(ends[0], "r");
    char line[400] = "";
    EXPECT_NE(fgets(line, sizeof(line), said), nullptr);
    std::fclose(said);
    ASSERT_STREQ(line, "moving\n");
  }

  // Joint states from the moment of the kill on: time since then and arm joints.
  struct Sample {
    double since_s;
    Eigen::VectorXd q;
  };
  std::vector<Sample> watchAfter(double killed_s) {
    hardware::ConnectionSettings settings;
    settings.url = m_robot->url();
    settings.first_retry_s = 0.01;
    settings.last_retry_s = 0.05;
    hardware::RosbridgeRobot robot;
    robot.link = std::make_shared<hardware::Connection>(settings, m_clock);
    robot.state = std::make_shared<hardware::RobotState>(robot.link, "/joint_states");
    robot.clock = &m_clock;
    hardware::RosbridgeArm arm("watcher", robot, hardware::TopicNames());
    EXPECT_TRUE(arm.open().ok());
    std::vector<Sample> out;
    double last = -1;
    for (const double end = m_clock.now_s() + 3; m_clock.now_s() < end;) {
      const auto state = robot.state->newest();
      if (!state || state->stamp_s == last) continue;
      last = state->stamp_s;
      out.push_back({last - killed_s, *state->positionsOf(workcell()->armJointNames())});
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return out;
  }

  void killInMotion(const std::string& speed) {
    startConsole(speed);
    ASSERT_EQ(::kill(m_console, SIGKILL), 0);
    const double killed_s = m_clock.now_s();
    ::waitpid(m_console, nullptr, 0);
    m_console = 0;
    const auto samples = watchAfter(killed_s);
    ASSERT_GT(samples.size(), 50u) << "the robot told too little to judge";
    const Eigen::VectorXd stands = samples.back().q;
    double moved_s = 0;
    for (const auto& s : samples) {
      if ((s.q - stands).cwiseAbs().maxCoeff() > 0.0005) moved_s = s.since_s;
    }
    const auto path = planning::readTrajectory(m_file);
    ASSERT_TRUE(path.ok()) << path.error().message;
    std::printf("console killed at speed %s: first look %.0f ms after, arm stands after %.0f ms, %.4f deg off its path\n",
                speed.c_str(), 1e3 * samples.front().since_s, 1e3 * moved_s, offPath(*path, stands) * 180 / M_PI);
    EXPECT_LT(samples.front().since_s, 0.4) << "too late to see it move";
    EXPECT_LT(moved_s, 0.4);
    EXPECT_LT(offPath(*path, stands), kOnPath);
    EXPECT_GT((stands - path->points.back().positions).cwiseAbs().maxCoeff(), 0.1) << "it has gone to the end";
  }

  SteadyClock m_clock;
  std::unique_ptr<VirtualRobotProcess> m_robot;
  std::string m_file = ::testing::TempDir() + "killed_console.json";
  pid_t m_console = 0;
};

TEST_F(KilledConsole, LeavesTheArmStandingOnItsPath) { killInMotion("1"); }

TEST_F(KilledConsole, LeavesTheArmStandingOnItsPathAtDoubleSpeed) { killInMotion("2"); }

}  // namespace
}  // namespace longarm::session
