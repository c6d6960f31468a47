// Grab Pipe on random pipes of the range it must serve: a seeded sample in every run, the figures as a campaign.
#include <algorithm>
#include <cstdio>
#include <map>

#include <gtest/gtest.h>

#include "planning/macros/grab_pipe.h"
#include "planning/motion/check_trajectory.h"
#include "planning/trajectory/nominal_limits.h"
#include "tests/planning/pipe_scene.h"

namespace longarm::planning {
namespace {

struct Tally {
  int pipes = 0, planned = 0, violations = 0, off_goal = 0, over_half = 0, off_middle = 0;
  std::vector<double> seconds, durations;
  std::map<std::string, int> failures;

  double median(std::vector<double> v) const {
    if (v.empty()) return 0;
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  }
  double share() const { return static_cast<double>(planned) / pipes; }
  void print() const {
    std::vector<double> sorted = seconds;
    std::sort(sorted.begin(), sorted.end());
    std::printf("%d pipes: %d planned (%.1f %%), %d violations, %d off the goal, %d off the middle; planning median %.3f s, "
                "p95 %.3f s, worst %.3f s; motion median %.1f s\n",
                pipes, planned, 100 * share(), violations, off_goal, off_middle, median(seconds),
                sorted.empty() ? 0 : sorted[sorted.size() * 95 / 100], sorted.empty() ? 0 : sorted.back(), median(durations));
    for (const auto& [reason, count] : failures) std::printf("  %d x %s\n", count, reason.c_str());
  }
};

// The independent sweep, with the true pipe in the scene: only the gripper, only in the last leg, may touch it.
CheckReport sweep(const Workcell& cell, const Plan& plan, const vision::Feature& feature) {
  const Eigen::Vector3d a = feature.vertices[0].xyz, b = feature.vertices[1].xyz;
  WorldObject pipe;
  pipe.name = "pipe";
  pipe.shape = Cylinder{0.02, (b - a).norm()};
  pipe.X_WO.linear() = rotationWithZ(b - a);
  pipe.X_WO.translation() = 0.5 * (a + b);
  CheckOptions options;
  options.objects = {pipe};
  const PlanStage& last = plan.stages.back();
  options.allowed = {{"pipe", cell.gripper->links, last.start_s, last.end_s}};
  Eigen::VectorXd q = plan.start_configuration;
  const auto joint = cell.model->jointIndex(cell.gripper->joint);
  q[cell.model->joints()[static_cast<std::size_t>(*joint)].q_index] = cell.gripper->open;
  const auto report = checkTrajectory(cell, plan.trajectory, q, options);
  return report.ok() ? *report : CheckReport{};
}

Tally run(int pipes, unsigned seed) {
  const Workcell& cell = tests::builtIn();
  const GrabPipe macro;
  Random random(seed);
  Tally tally;
  for (int i = 0; i < pipes; ++i) {
    const vision::Feature feature = tests::randomPipe(random);
    PlanContext context = tests::contextOf(cell);
    context.seed = static_cast<unsigned>(i + 1);
    const Plan plan = macro.plan(context, &feature);
    ++tally.pipes;
    tally.seconds.push_back(plan.planning_seconds);
    if (!plan.ok()) {
      ++tally.failures[plan.reason];
      continue;
    }
    ++tally.planned;
    tally.durations.push_back(plan.trajectory.duration());
    tally.off_middle += (plan.goal.translation() - 0.5 * (feature.vertices[0].xyz + feature.vertices[1].xyz)).norm() > 1e-6;
    tally.over_half += plan.max_velocity_ratio > 0.5 + 1e-6 || plan.max_acceleration_ratio > 0.25 + 1e-6;
    const CheckReport report = sweep(cell, plan, feature);
    if (!report.ok) {
      ++tally.violations;
      for (const auto& v : report.violations) std::printf("pipe %d: %s %s\n", i, v.kind.c_str(), v.sentence.c_str());
    }
    Eigen::VectorXd q = plan.start_configuration;
    setGroupPositions(*cell.model, cell.arm, plan.trajectory.points.back().positions, q);
    const Pose end = cell.model->forward(q, *cell.model->linkIndex(cell.arm.tip_link));
    tally.off_goal += (end.translation() - plan.goal.translation()).norm() > 1e-4 || angleBetween(end.linear(), plan.goal.linear()) > 1e-4;
  }
  tally.print();
  return tally;
}

TEST(GrabPipe, PlansASampleOfRandomPipesWithoutTouchingAnything) {
  const Tally tally = run(25, 1);
  EXPECT_GE(tally.planned, 24);
  EXPECT_EQ(tally.violations, 0);
  EXPECT_EQ(tally.off_goal, 0);
  EXPECT_EQ(tally.over_half, 0);
}

TEST(GrabPipeCampaign, PlansNinetyEightPercentOfAThousandPipes) {
  const Tally tally = run(1000, 2024);
  EXPECT_GE(tally.share(), 0.98);
  EXPECT_EQ(tally.violations, 0);
  EXPECT_EQ(tally.off_goal, 0);
  EXPECT_EQ(tally.over_half, 0);
}

}  // namespace
}  // namespace longarm::planning
