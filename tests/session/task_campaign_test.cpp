// The whole task over many random pipes, in simulated time, with the robot's hidden errors and 0.5 px clicks.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "core/text.h"
#include "planning/motion/check_trajectory.h"
#include "session/task/task_run.h"
#include "tests/session/task_fixture.h"

namespace longarm::session {
namespace {

struct Tally {
  int tasks = 0, planned = 0, grasped = 0, achieved = 0, sweep_violations = 0, touched = 0, stopped = 0;
  std::vector<double> planning_s;
  std::map<std::string, std::vector<unsigned>> failures;   // stage and reason -> seeds

  double share(int count) const { return tasks > 0 ? static_cast<double>(count) / tasks : 0; }
  void print() const {
    std::vector<double> sorted = planning_s;
    std::sort(sorted.begin(), sorted.end());
    std::printf("%d tasks: planned %d (%.1f %%), grasped %d (%.1f %%), achieved %d (%.1f %%); violations in the sweep %d, "
                "tasks with a true contact %d, stopped %d; planning median %.3f s, worst %.3f s\n",
                tasks, planned, 100 * share(planned), grasped, 100 * share(grasped), achieved, 100 * share(achieved),
                sweep_violations, touched, stopped, sorted.empty() ? 0 : sorted[sorted.size() / 2],
                sorted.empty() ? 0 : sorted.back());
    for (const auto& [reason, seeds] : failures) {
      std::printf("  %zu x %s; seeds", seeds.size(), reason.c_str());
      for (const auto seed : seeds) std::printf(" %u", seed);
      std::printf("\n");
    }
  }
};

const planning::ScenarioObject& truePipe(const planning::Scenario& scenario) {
  return *scenario.object(scenario.random_pipe->object);
}

// The planner's motion once more, by code that shares nothing with it, and past the pipe where it truly lies.
int violations(const planning::Workcell& cell, const planning::Plan& plan, const planning::Scenario& scenario) {
  planning::CheckOptions options;
  options.objects = {truePipe(scenario).body};
  const auto& last = plan.stages.back();
  options.allowed = {{options.objects[0].name, cell.gripper->links, last.start_s, last.end_s}};
  Eigen::VectorXd q = plan.start_configuration;
  const auto joint = cell.model->jointIndex(cell.gripper->joint);
  q[cell.model->joints()[static_cast<std::size_t>(*joint)].q_index] = cell.gripper->open;
  const auto report = planning::checkTrajectory(cell, plan.trajectory, q, options);
  if (!report.ok()) {
    std::printf("  sweep: %s\n", report.error().message.c_str());
    return 1;
  }
  for (const auto& v : report->violations) std::printf("  sweep: %s %s\n", v.kind.c_str(), v.sentence.c_str());
  return static_cast<int>(report->violations.size());
}

bool passed(const TaskReport& report, const std::string& stage) {
  return std::any_of(report.stages.begin(), report.stages.end(),
                     [&](const TaskStage& s) { return s.name == stage && s.ok; });
}

void runOne(unsigned seed, Tally& tally) {
  const auto& cell = testing::builtInWorkcell();
  const auto scenario = planning::randomised(*planning::loadScenario("grab_pipe"), seed);
  TaskOptions options;
  options.seed = seed;
  options.lockstep = true;
  options.click_sigma_px = 0.5;
  options.virtual_robot = testing::virtualRobot();
  TaskRun task(cell, scenario, options, *TaskFaults::make({}, true));
  ++tally.tasks;
  const auto started = task.start();
  ASSERT_TRUE(started.ok()) << started.error().message;
  const auto report = task.run();
  if (task.plan()) {
    ++tally.planned;
    tally.planning_s.push_back(task.plan()->planning_seconds);
    tally.sweep_violations += violations(cell, *task.plan(), scenario);
  }
  tally.grasped += passed(report, "close");
  tally.achieved += report.success;
  tally.stopped += !report.stops.empty();
  tally.touched += task.contacts() > 0;
  if (!report.success) {
    tally.failures[report.errors.empty() ? std::string("?") : report.errors[0]].push_back(seed);
    std::printf("seed %u\n%s", seed, testing::tableOf(report).c_str());
  }
}

Tally runMany(unsigned first, unsigned count) {
  Tally tally;
  for (unsigned seed = first; seed < first + count; ++seed) {
    runOne(seed, tally);
    if (tally.tasks % 20 == 0) tally.print();
    std::fflush(stdout);
  }
  tally.print();
  return tally;
}

unsigned fromEnvironment(const char* name, unsigned fallback) {
  const char* text = std::getenv(name);
  const auto number = text != nullptr ? parseInteger(text) : std::nullopt;
  return number && *number > 0 ? static_cast<unsigned>(*number) : fallback;
}

// LONGARM_RUN_SEEDS and LONGARM_RUN_FIRST change how many and which.
TEST(RunCampaign, GrabsNinetyEightPercentOfTwoHundredPipes) {
  LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
  const Tally tally = runMany(fromEnvironment("LONGARM_RUN_FIRST", 1), fromEnvironment("LONGARM_RUN_SEEDS", 200));
  EXPECT_GE(tally.share(tally.planned), 0.98);
  EXPECT_GE(tally.share(tally.grasped), 0.98);
  EXPECT_EQ(tally.sweep_violations, 0);
  EXPECT_EQ(tally.touched, 0);
  EXPECT_EQ(tally.stopped, 0);
}

}  // namespace
}  // namespace longarm::session
