// Arms that are not ours, known by their workcell files alone: every macro that their tools allow, and the independent sweep.
#include <filesystem>
#include <fstream>
#include <set>

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/resource_path.h"
#include "planning/robot/ik.h"
#include "tests/planning/macro_scene.h"
#include "tests/support/test_data.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::featureOf;
using vision::FeatureKind;

struct Job {
  std::string macro;
  vision::Feature feature;
  std::map<std::string, double> arguments;
};

// Around a place in the middle of the arm's reach, x away from it.
std::vector<Job> jobsAround(const Vector3d& p) {
  const auto line = [&](const Vector3d& a, const Vector3d& b) { return featureOf(FeatureKind::kLine, {p + a, p + b}); };
  const auto point = featureOf(FeatureKind::kPoint, {p});
  const auto wall = featureOf(FeatureKind::kPlane, {p + Vector3d(0.1, -0.08, -0.06), p + Vector3d(0.1, 0.08, -0.06), p + Vector3d(0.1, 0.08, 0.06)});
  const auto box = featureOf(FeatureKind::kTriad, {p + Vector3d(0, -0.03, 0), p + Vector3d(0, 0.03, 0), p + Vector3d(0.05, -0.03, 0), p + Vector3d(0, -0.03, 0.06)});
  const auto across = line({0, -0.12, 0}, {0, 0.12, 0}), away = line({0, 0, 0}, {0.1, 0.02, 0});
  return {{"look_at", point, {}},
          {"touch", point, {}},
          {"move_above", point, {}},
          {"place_here", point, {}},
          {"grab_pipe", across, {}},
          {"approach_from_side", across, {}},
          {"move_around_axis", line({0, 0.2, -0.1}, {0, 0.2, 0.1}), {{"angle", 0.3}}},
          {"move_parallel", line({0, 0, 0}, {0, 0, 0.1}), {{"distance", 0.05}}},
          {"aim_along_axis", away, {{"stand_off", 0.1}}},
          {"place_disruptor", line({0.05, -0.1, -0.1}, {0.05, 0.1, -0.1}), {}},
          {"insert_along", away, {}},
          {"extract_along", line({0, 0, 0.3}, {0, 0, 0.1}), {{"distance", 0.03}}},
          {"surface_scan", wall, {}},
          {"follow_perimeter", wall, {}},
          {"press", wall, {}},
          {"wipe", wall, {}},
          {"grasp_by_faces", box, {}},
          {"push_face", box, {{"distance", 0.02}}},
          {"scan_faces", box, {}},
          {"look_around", box, {}},
          {"move_to", {}, {{"x", p.x()}, {"y", p.y()}, {"z", p.z()}}}};
}

// @returns the names of those that were planned.
std::vector<std::string> planAll(const Workcell& cell, const Vector3d& p, const std::set<std::string>& without = {}) {
  std::vector<std::string> done;
  const auto macros = makeMacros(cell);
  for (const auto& job : jobsAround(p)) {
    const Macro* macro = findMacro(macros, job.macro);
    if (macro == nullptr || without.count(job.macro) > 0) continue;
    PlanContext context = tests::contextOf(cell, "ready");
    context.arguments = job.arguments;
    context.budget_s = 60;
    const Plan plan = macro->plan(context, macro->info().takes ? &job.feature : nullptr);
    if (!plan.ok()) {
      ADD_FAILURE() << cell.name << ", " << job.macro << ": " << plan.failed_stage << ": " << plan.reason;
      continue;
    }
    const CheckReport report = tests::sweepOf(cell, plan, {});
    for (const auto& v : report.violations) ADD_FAILURE() << cell.name << ", " << job.macro << ": " << v.sentence;
    done.push_back(job.macro);
  }
  return done;
}

TEST(OtherArms, SevenJointsDoEveryMacro) {
  const auto path = resourcePath("robots/seven_joints/workcell.yaml");
  ASSERT_TRUE(path.ok()) << path.error().message;
  const auto cell = loadWorkcell(*path);
  ASSERT_TRUE(cell.ok()) << cell.error().message;
  EXPECT_TRUE(cell->warnings.empty()) << cell->warnings.front();
  ASSERT_EQ(cell->arm.joints.size(), 7u);
  EXPECT_EQ(planAll(*cell, {0.72, 0.05, 0.45}).size(), 21u);
}

TEST(OtherArms, TheUr5DoesEveryMacroThatNeedsNoGripper) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("longarm_other_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const std::string robot = tests::dataFolder() + "/robots/ur5/example-robot-data/robots/ur_description/";
  std::ofstream(folder / "ur5.yaml") << "format: 1\nname: ur5\nrobot: {urdf: '" << robot << "urdf/ur5_robot.urdf', srdf: '" << robot
                                     << "srdf/ur5.srdf'}\narm: {base: base_link, tip: tool0, max_acceleration: 4, stop_deceleration: 40}\n"
                                     << "poses: {ready: {shoulder_lift_joint: -1.9, elbow_joint: 2.0, wrist_1_joint: -1.67, wrist_2_joint: -1.57}}\n";
  const auto cell = loadWorkcell((folder / "ur5.yaml").string());
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(cell.ok()) << cell.error().message;
  const std::set<std::string> beyond{"grab_pipe", "grasp_by_faces", "look_at"};   // no gripper, no camera
  EXPECT_EQ(planAll(*cell, {0.62, 0.1, 0.3}, beyond).size(), 18u);
  for (const auto& job : jobsAround({0.62, 0.1, 0.3})) {
    if (beyond.count(job.macro) == 0) continue;
    const auto macros = makeMacros(*cell);
    const Plan refused = findMacro(macros, job.macro)->plan(tests::contextOf(*cell, "ready"), &job.feature);
    EXPECT_FALSE(refused.ok());
    EXPECT_NE(refused.reason.find("the workcell"), std::string::npos) << refused.reason;
  }
}

}  // namespace
}  // namespace longarm::planning
