// Whole tasks on the virtual robot: in simulated time, with faults, over many seeds.
#include "session/task_runner.h"

#include <cstdio>
#include <map>

#include <gtest/gtest.h>

#include "core/clock.h"
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

TEST_F(TaskRunner, GrabsThePipeOfSeveralSeedsInSimulatedTime) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    const auto report = run(lockstepTask(seed));
    EXPECT_TRUE(report.success) << "seed " << seed << "\n" << testing::tableOf(report);
    EXPECT_EQ(report.stages.size(), 10u);
    EXPECT_TRUE(report.stops.empty());
  }
}

}  // namespace
}  // namespace longarm::session
