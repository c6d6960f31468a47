#include <clocale>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "planning/trajectory/trajectory_file.h"

namespace longarm::planning {
namespace {

Trajectory sample() {
  Trajectory t;
  t.joint_names = {"arm_1_joint", "arm_2_joint"};
  for (int i = 0; i < 4; ++i) {
    const double v = i == 0 || i == 3 ? 0 : 0.1;
    t.points.push_back({0.02 * i, Eigen::Vector2d(0.1 * i, 1.0 / 3 * i), Eigen::Vector2d(v, -v), Eigen::Vector2d(0.5, 1e-7)});
  }
  return t;
}

std::string temporary(const std::string& name) { return (std::filesystem::temp_directory_path() / name).string(); }

std::string refusal(const nlohmann::json& json) {
  const auto result = trajectoryFromJson(json);
  return result.ok() ? "" : result.error().message;
}

TEST(TrajectoryFile, ReadsBackWhatItWroteBitForBit) {
  const std::string path = temporary("longarm_trajectory_file_test.json");
  const Trajectory written = sample();
  ASSERT_TRUE(writeTrajectory(path, written).ok());
  const auto read = readTrajectory(path);
  ASSERT_TRUE(read.ok()) << read.error().message;
  ASSERT_EQ(read->points.size(), written.points.size());
  for (std::size_t i = 0; i < written.points.size(); ++i) {
    EXPECT_EQ(read->points[i].t, written.points[i].t);
    EXPECT_EQ(read->points[i].positions, written.points[i].positions);
    EXPECT_EQ(read->points[i].velocities, written.points[i].velocities);
    EXPECT_EQ(read->points[i].accelerations, written.points[i].accelerations);
  }
  std::filesystem::remove(path);
}

TEST(TrajectoryFile, NamesKeyPointAndValueOfWhatIsWrong) {
  auto json = toJson(sample());
  json["points"][2]["positions"][1] = "x";
  EXPECT_NE(refusal(json).find("points[2]: positions[1] must be a number, is \"x\""), std::string::npos) << refusal(json);
  json = toJson(sample());
  json["points"][1].erase("velocities");
  EXPECT_NE(refusal(json).find("points[1]: \"velocities\""), std::string::npos);
  json = toJson(sample());
  json["points"][3]["t"] = 0.01;
  EXPECT_NE(refusal(json).find("t = 0.01"), std::string::npos);
  json = toJson(sample());
  json["points"][3]["velocities"][0] = 0.2;
  EXPECT_NE(refusal(json).find("arm_1_joint moves at 0.2"), std::string::npos);
  EXPECT_NE(refusal(nlohmann::json::array()).find("must be an object"), std::string::npos);
  EXPECT_NE(refusal({{"joint_names", {"a"}}, {"points", nlohmann::json::array()}}).find("points"), std::string::npos);
}

TEST(TrajectoryFile, NamesTheFileThatIsMissingOrNoJson) {
  EXPECT_NE(readTrajectory("/no/such.json").error().message.find("/no/such.json"), std::string::npos);
  const std::string path = temporary("longarm_trajectory_bad.json");
  ASSERT_TRUE(writeFileAtomically(path, std::string(100000, '[')).ok());
  EXPECT_NE(readTrajectory(path).error().message.find("nested deeper"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(TrajectoryFile, SurvivesAThousandDamagedCopies) {
  const std::string good = toJson(sample()).dump();
  const std::string path = temporary("longarm_trajectory_fuzz.json");
  std::mt19937_64 engine(5);
  int accepted = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string text = good;
    const int edits = 1 + static_cast<int>(engine() % 4);
    for (int k = 0; k < edits; ++k) text[engine() % text.size()] = static_cast<char>(engine() % 256);
    if (engine() % 5 == 0) text.resize(engine() % text.size());
    ASSERT_TRUE(writeFileAtomically(path, text).ok());
    const auto read = readTrajectory(path);
    if (read.ok()) {
      ++accepted;
      EXPECT_TRUE(validate(*read).ok());
    } else {
      EXPECT_FALSE(read.error().message.empty());
    }
  }
  EXPECT_LT(accepted, 700);   // a changed digit may well be a good file
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace longarm::planning
