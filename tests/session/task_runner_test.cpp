// Whole tasks on the virtual robot: in simulated time, with faults, over many seeds.
#include "session/task_runner.h"

#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "session/task/synthetic_operator.h"
#include "session/task/task_truth.h"
#include "tests/session/task_fixture.h"

namespace longarm::session {
namespace {

TaskOptions lockstepTask(unsigned seed) {
  TaskOptions options;
  options.seed = seed;
  options.lockstep = true;
  options.virtual_robot = testing::virtualRobot();
  return options;
}

class TaskRunner : public ::testing::Test {
 protected:
  void SetUp() override { LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT(); }
  static TaskReport run(const TaskOptions& options, const std::string& variant = {}) {
    const auto report = runTask(testing::builtInWorkcell(variant), options);
    EXPECT_TRUE(report.ok()) << report.error().message;
    return report.ok() ? *report : TaskReport{};
  }
};

double endOf(const TaskReport& report) {
  double out = 0;
  for (const auto& stage : report.stages) out += stage.seconds;
  return out;
}

TEST_F(TaskRunner, GrabsThePipeOfSeveralSeedsInSimulatedTime) {
  for (const unsigned seed : {0u, 2u}) {
    const auto report = run(lockstepTask(seed));
    EXPECT_TRUE(report.success) << "seed " << seed << "\n" << testing::tableOf(report);
    EXPECT_EQ(report.stages.size(), 10u);
    EXPECT_TRUE(report.stops.empty());
    EXPECT_TRUE(report.errors.empty());
  }
}

class EveryScenario : public ::testing::TestWithParam<const char*> {};

TEST_P(EveryScenario, ItsTaskIsDoneByClicksAlone) {
  LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
  TaskOptions options = lockstepTask(1);
  options.scenario = GetParam();
  const auto report = runTask(testing::builtInWorkcell(), options);
  ASSERT_TRUE(report.ok()) << report.error().message;
  EXPECT_TRUE(report->success) << testing::tableOf(*report);
}
INSTANTIATE_TEST_SUITE_P(Scenarios, EveryScenario,
                         ::testing::Values("open_door", "pull_drawer", "turn_valve", "scan_panel", "package", "crate", "hatch", "slope"));

TEST_F(TaskRunner, GivesTheSameReportForTheSameSeed) {
  const auto first = toJson(run(lockstepTask(5))), second = toJson(run(lockstepTask(5)));
  EXPECT_EQ(first, second);
}

TEST_F(TaskRunner, MeasuresWithTwoPanTiltCamerasToo) {
  auto options = lockstepTask(3);
  options.variant = "ptz";
  const auto report = run(options, "ptz");
  EXPECT_TRUE(report.success) << testing::tableOf(report);
}

TEST_F(TaskRunner, AHandThatTremblesTooMuchIsTold) {
  auto options = lockstepTask(1);
  options.click_sigma_px = 60;
  const auto report = run(options);
  EXPECT_FALSE(report.success) << testing::tableOf(report);
  ASSERT_EQ(report.errors.size(), 1u);
  EXPECT_FALSE(report.stages.back().ok);
}

TEST_F(TaskRunner, ACutLinkInSimulatedTimeStopsTheTask) {
  auto options = lockstepTask(1);
  options.faults = {"link_cut"};
  const auto report = run(options);
  EXPECT_FALSE(report.success);
  ASSERT_FALSE(report.stops.empty()) << testing::tableOf(report);
  EXPECT_EQ(report.stops[0].source, "link");
  EXPECT_EQ(report.stages.back().name, "play");
  EXPECT_LT(endOf(report) - report.stops[0].t, 10);
}

TEST_F(TaskRunner, ACutLinkInRealTimeEndsTheTaskWithinTenSeconds) {
  auto options = lockstepTask(1);
  options.lockstep = false;
  options.speed = 2;
  options.faults = {"link_cut"};
  const auto report = run(options);
  const std::string table = testing::tableOf(report);
  EXPECT_FALSE(report.success);
  ASSERT_FALSE(report.stops.empty()) << table;
  EXPECT_EQ(report.stops[0].source, "link") << table;
  EXPECT_EQ(report.stages.back().name, "play") << table;
  EXPECT_LT(endOf(report) - report.stops[0].t, 10) << table;
}

TEST_F(TaskRunner, AGraspThatSlipsIsNotCalledASuccess) {
  auto options = lockstepTask(2);
  options.faults = {"slipping_grasp"};
  const auto report = run(options);
  EXPECT_FALSE(report.success) << testing::tableOf(report);
  ASSERT_FALSE(report.errors.empty());
}

TEST_F(TaskRunner, FaultsOfTheVideoDoNotDisturbTheMotion) {
  auto options = lockstepTask(1);
  options.faults = {"frozen_camera", "dark_camera", "glare"};
  const auto report = run(options);
  EXPECT_TRUE(report.success) << testing::tableOf(report);
}

TEST_F(TaskRunner, ACancelledTaskEndsSoon) {
  auto options = lockstepTask(1);
  options.cancel.cancel();
  const auto report = run(options);
  EXPECT_FALSE(report.success);
  ASSERT_EQ(report.errors.size(), 1u);
  EXPECT_NE(report.errors[0].find("cancelled"), std::string::npos) << report.errors[0];
}

TEST(TaskRunnerInput, UnknownFaultsScenariosAndRobotsAreRefusedInASentence) {
  auto options = lockstepTask(1);
  options.virtual_robot = "/nowhere/robot";
  options.faults = {"earthquake"};
  const auto fault = runTask(testing::builtInWorkcell(), options);
  ASSERT_FALSE(fault.ok());
  EXPECT_EQ(fault.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(fault.error().message.find("earthquake"), std::string::npos) << fault.error().message;
  EXPECT_NE(fault.error().message.find("link_cut"), std::string::npos) << fault.error().message;
  options.faults.clear();
  const auto robot = runTask(testing::builtInWorkcell(), options);
  ASSERT_FALSE(robot.ok());
  EXPECT_EQ(robot.error().code, ErrorCode::kNotFound);
  options.scenario = "nothing_of_that_name";
  EXPECT_EQ(runTask(testing::builtInWorkcell(), options).error().code, ErrorCode::kNotFound);
}

TEST(TaskReportJson, HasTheKeysOfTheContract) {
  TaskReport report;
  report.stages = {{"connect", true, 0.5, "fine"}, {"aim", false, 1.5, "no"}};
  report.errors = {"aim: no"};
  report.stops = {{1.25, "link", "the joint state is 0.3 s old"}};
  EXPECT_EQ(toJson(report),
            R"({"success":false,"stages":[{"name":"connect","ok":true,"seconds":0.5,"detail":"fine"},)"
            R"({"name":"aim","ok":false,"seconds":1.5,"detail":"no"}],"errors":["aim: no"],)"
            R"("stops":[{"t":1.25,"source":"link","reason":"the joint state is 0.3 s old"}]})");
}

TEST(TaskTruthFile, SaysWhatIsMissing) {
  const auto good = parseTruth(
      R"({"time":1.5,"joints":{"a":0.25},"objects":[{"name":"pipe","pose":{"xyz":[1,2,3],"quaternion_xyzw":[0,0,0,1]}}],)"
      R"("held":"","contacts":[{"a":"x","b":"y","time":1}],"goals":[{"kind":"grasp","object":"pipe","reached":true}],"links":{}})");
  ASSERT_TRUE(good.ok()) << good.error().message;
  EXPECT_EQ(good->objects.at("pipe").translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(good->goals.at(0).reached);
  for (const char* wrong : {"", "[]", "{\"time\": 1}", "{\"time\": \"x\"}"}) {
    const auto read = parseTruth(wrong);
    ASSERT_FALSE(read.ok()) << wrong;
    EXPECT_EQ(read.error().code, ErrorCode::kInvalidInput);
  }
}

TEST(SyntheticOperator, TurnsBothCamerasOfTheHeadToAPoint) {
  const auto& cell = testing::builtInWorkcell();
  const auto pair = measuringPair(cell);
  ASSERT_TRUE(pair.ok());
  EXPECT_EQ(pair->first, "head_left");
  JointState now{0, cell.model->actuatedNames(), cell.model->neutral(), {}};
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.8, 0.1, 0.4), Eigen::Vector3d(0.5, -0.4, 0.7), Eigen::Vector3d(2, 0.5, 0.3)}) {
    const auto wishes = aimAt(cell, {pair->first, pair->second}, p, now);
    ASSERT_TRUE(wishes.ok()) << wishes.error().message;
    ASSERT_EQ(wishes->size(), 1u);
    Eigen::VectorXd q = now.positions;
    JointState aimed{0, {cell.pan_tilts[0].pan_joint, cell.pan_tilts[0].tilt_joint},
                     Eigen::Vector2d((*wishes)[0].pan, (*wishes)[0].tilt), {}};
    cell.model->assign(aimed, q);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& name : {pair->first, pair->second}) {
      const Pose X_RC = cell.model->forward(q, *cell.model->linkIndex(cell.camera(name)->link));
      const Eigen::Vector3d p_C = X_RC.inverse() * p;
      EXPECT_GT(p_C.z(), 0);
      sum += p_C.normalized();
    }
    // The cameras look past it to either side by the same angle, neither above nor below.
    EXPECT_NEAR(sum.x(), 0, 0.02);
    EXPECT_NEAR(sum.y(), 0, 0.02);
  }
}

TEST(SyntheticHand, TremblesAsMuchAsItIsTold) {
  vision::CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 700;
  camera.cx = 320;
  camera.cy = 240;
  SyntheticHand hand(7, 0.5);
  double sum = 0;
  constexpr int kClicks = 4000;
  for (int i = 0; i < kClicks; ++i) {
    const auto pixel = hand.click(camera, Pose::Identity(), {0.1, 0, 1});
    ASSERT_TRUE(pixel.ok());
    sum += (*pixel - Eigen::Vector2d(390, 240)).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(sum / (2 * kClicks)), 0.5, 0.02);
  EXPECT_EQ(hand.click(camera, Pose::Identity(), {1, 0, 1}).error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(hand.click(camera, Pose::Identity(), {0, 0, -1}).error().code, ErrorCode::kDegenerate);
}

// Real time needs a machine that is not too busy.
TEST(RunRealtimeCampaign, AchievesTheTaskInRealTimeAndOverASlowLink) {
  LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
  for (const bool slow : {false, true}) {
    auto options = lockstepTask(1);
    options.lockstep = false;
    if (slow) options.faults = {"link_delay"};
    const auto report = runTask(testing::builtInWorkcell(), options);
    ASSERT_TRUE(report.ok()) << report.error().message;
    std::printf("%s", testing::tableOf(*report).c_str());
    EXPECT_TRUE(report->success);
  }
}

}  // namespace
}  // namespace longarm::session
