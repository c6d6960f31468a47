// Small files made to break readers, each through every reader there is.
#include <algorithm>
#include <map>
#include <vector>

#include "core/resource_path.h"
#include "planning/robot/robot_model.h"
#include "planning/trajectory/trajectory_file.h"
#include "planning/world/mesh_file.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"
#include "tests/fuzz/damaged_copies.h"
#include "tests/support/test_data.h"
#include "vision/camera/camera_file.h"
#include "vision/snapshot/image_file.h"
#include "vision/snapshot/views_file.h"

namespace longarm::tests {
namespace {

template <typename T>
Status asStatus(const Result<T>& result) {
  return result ? Status() : Status(result.error());
}

std::map<std::string, Reader> everyReader() {
  const std::string urdf = resourcePath("robots/longarm_one/longarm_one.urdf").value();
  return {
      {"urdf", [](const std::string& p) { return asStatus(planning::RobotModel::load(p)); }},
      {"srdf", [urdf](const std::string& p) { return asStatus(planning::RobotModel::load(urdf, p)); }},
      {"workcell", [](const std::string& p) { return asStatus(planning::loadWorkcell(p)); }},
      {"scenario", [](const std::string& p) { return asStatus(planning::loadScenario(p)); }},
      {"mesh", [](const std::string& p) { return asStatus(planning::loadMesh(p)); }},
      {"trajectory", [](const std::string& p) { return asStatus(planning::readTrajectory(p)); }},
      {"camera", [](const std::string& p) { return asStatus(vision::readCameraFile(p)); }},
      {"zoom camera", [](const std::string& p) { return asStatus(vision::readCameraFile(p, 0.5)); }},
      {"picture", [](const std::string& p) { return asStatus(vision::loadImage(p)); }},
      {"views", [](const std::string& p) { return asStatus(vision::readViewsFile(p)); }},
      {"picks", [](const std::string& p) { return asStatus(vision::readPicksFile(p)); }},
  };
}

std::vector<std::string> hostileFiles() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(dataFolder() + "/hostile")) {
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(HostileFiles, EveryReaderAnswersEveryOneInBoundedTime) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto files = hostileFiles();
  EXPECT_GT(files.size(), 20u);
  for (const auto& [name, reader] : everyReader()) {
    for (const auto& path : files) {
      DamageFigures figures;
      const auto start = std::chrono::steady_clock::now();
      judge(reader(path), path, name + " reads " + path, &figures);
      EXPECT_LT(std::chrono::steady_clock::now() - start, kLongest) << name << " reads " << path;
    }
  }
}

TEST(HostileFiles, BombsAndTrapsAreRefusedByTheReaderTheyAreMadeFor) {
  LONGARM_SKIP_WITHOUT_DATA();
  auto readers = everyReader();
  const std::pair<const char*, const char*> traps[] = {
      {"bomb30k.png", "picture"}, {"bomb.stl", "mesh"},       {"bomb.ply", "mesh"},        {"idx.obj", "mesh"},
      {"usemtl-crash.obj", "mesh"}, {"lol.xml", "camera"},      {"xxe.xml", "camera"},       {"deep10000.xml", "camera"},
      {"lol.yaml", "camera"},     {"deep100000.yaml", "views"}, {"deep100000.yaml", "workcell"}, {"lol.yaml", "scenario"},
      {"deep100000.json", "trajectory"}, {"loop.urdf", "urdf"}, {"twoparents.urdf", "urdf"}, {"nan.urdf", "urdf"},
      {"lol.xml", "urdf"},        {"xxe.xml", "urdf"},          {"a.cvyml", "camera"}};
  for (const auto& [file, reader] : traps) {
    const auto answer = readers.at(reader)(dataFolder() + "/hostile/" + file);
    EXPECT_FALSE(answer.ok()) << reader << " takes " << file;
  }
}

TEST(HostileFiles, FoldersEmptyAndMissingFilesAreSentences) {
  const ScratchFolder folder;
  const std::string empty = folder.write("empty", "");
  for (const auto& [name, reader] : everyReader()) {
    for (const std::string& path : {empty, folder.path().string(), folder.file("missing")}) {
      DamageFigures figures;
      judge(reader(path), path, name + " reads " + path, &figures);
      EXPECT_EQ(figures.taken, 0) << name << " takes " << path;
    }
  }
}

}  // namespace
}  // namespace longarm::tests
