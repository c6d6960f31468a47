// Damaged robots, workcells, scenarios and trajectories.
#include "core/motion.h"
#include "core/resource_path.h"
#include "core/text.h"
#include "planning/robot/robot_model.h"
#include "planning/trajectory/trajectory_file.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"
#include "tests/fuzz/damaged_copies.h"

namespace longarm::tests {
namespace {

std::string robotFolder() { return resourcePath("robots/longarm_one").value(); }

// Whatever was taken is walked through once.
Status useModel(const Result<std::shared_ptr<const planning::RobotModel>>& model) {
  if (!model) return model.error();
  std::vector<Pose> poses;
  (*model)->forward((*model)->neutral(), poses);
  EXPECT_EQ(poses.size(), (*model)->links().size());
  for (const auto& pose : poses) EXPECT_TRUE(pose.matrix().allFinite());
  for (const auto& warning : (*model)->warnings()) EXPECT_EQ(faultOfSentence(warning), "") << warning;
  return {};
}

TEST(DamagedFiles, Urdf) {
  const ScratchFolder folder;
  const auto figures =
      readDamagedCopies(folder, "robot.urdf", contentOf(robotFolder() + "/longarm_one.urdf"),
                        [](const std::string& path) { return useModel(planning::RobotModel::load(path)); });
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, Srdf) {
  const ScratchFolder folder;
  const std::string urdf = folder.write("robot.urdf", contentOf(robotFolder() + "/longarm_one.urdf"));
  planning::LoadOptions kinematics;
  kinematics.load_meshes = false;
  const auto figures = readDamagedCopies(
      folder, "robot.srdf", contentOf(robotFolder() + "/longarm_one.srdf"),
      [&](const std::string& path) { return useModel(planning::RobotModel::load(urdf, path, kinematics)); });
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, Workcell) {
  const ScratchFolder folder;
  std::filesystem::copy(robotFolder(), folder.path(), std::filesystem::copy_options::recursive);
  const auto figures = readDamagedCopies(folder, "workcell.yaml", contentOf(robotFolder() + "/workcell.yaml"),
                                         [](const std::string& path) -> Status {
                                           const auto workcell = planning::loadWorkcell(path);
                                           if (!workcell) return workcell.error();
                                           EXPECT_TRUE(workcell->arm_limits.max_velocity.allFinite());
                                           for (const auto& warning : workcell->warnings) {
                                             EXPECT_EQ(faultOfSentence(warning), "") << warning;
                                           }
                                           return {};
                                         });
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, Scenario) {
  const ScratchFolder folder;
  const auto figures = readDamagedCopies(folder, "scenario.yaml", contentOf(resourcePath("scenarios/grab_pipe.yaml").value()),
                                         [](const std::string& path) -> Status {
                                           const auto scenario = planning::loadScenario(path);
                                           if (!scenario) return scenario.error();
                                           const auto drawn = randomised(*scenario, 7);
                                           for (const auto& object : drawn.objects) {
                                             EXPECT_TRUE(object.body.X_WO.matrix().allFinite()) << object.body.name;
                                           }
                                           return {};
                                         });
  EXPECT_GT(figures.refused, kCopies / 5);
}

TEST(DamagedFiles, TrajectoryJson) {
  const ScratchFolder folder;
  const std::string good =
      R"({"joint_names": ["a", "b"], "points": [
 {"t": 0, "positions": [0, 0.1], "velocities": [0, 0], "accelerations": [0.5, 0.25]},
 {"t": 0.5, "positions": [0.0625, 0.13125], "velocities": [0.25, 0.125], "accelerations": [0, 0]},
 {"t": 1, "positions": [0.125, 0.1625], "velocities": [0, 0], "accelerations": [0, 0]}]})";
  const auto figures = readDamagedCopies(folder, "trajectory.json", good, [](const std::string& path) -> Status {
    const auto trajectory = planning::readTrajectory(path);
    if (!trajectory) return trajectory.error();
    return validate(*trajectory);
  });
  EXPECT_GT(figures.refused, kCopies / 5);
}

}  // namespace
}  // namespace longarm::tests
