// The verb `target` on real photographs, as a script would use it.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "core/resource_path.h"
#include "core/text.h"
#include "tests/app/command.h"
#include "tests/support/test_data.h"
#include "tests/vision/chessboard_pairs.h"

namespace longarm::tests {
namespace {

std::string example(const std::string& name) { return resourcePath("examples/chessboard/" + name).value(); }

// Rows of one edge, picked in both pictures.
void writeEdge(std::ostream& out, const std::string& name, const std::vector<Eigen::Vector2d>& left,
               const std::vector<Eigen::Vector2d>& right, std::size_t a, std::size_t b) {
  int vertex = 0;
  for (const std::size_t corner : {a, b}) {
    out << name << ",line," << vertex << ",left," << formatNumber(left[corner].x()) << "," << formatNumber(left[corner].y()) << "\n"
        << name << ",line," << vertex << ",right," << formatNumber(right[corner].x()) << "," << formatNumber(right[corner].y()) << "\n";
    ++vertex;
  }
}

bool writeBoard(std::ostream& out, const std::string& number) {
  const std::string folder = dataFolder() + "/opencv_stereo_chess/";
  const auto left = chessboardCorners(folder + "left" + number + ".jpg");
  auto right = chessboardCorners(folder + "right" + number + ".jpg");
  if (left.size() != 54 || right.size() != 54) return false;
  alignCorners(left, &right);
  const auto columns = static_cast<std::size_t>(kBoardColumns), rows = static_cast<std::size_t>(kBoardRows);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const std::string name = "pair" + number + "_" + std::to_string(i);
    if (i % columns + 1 < columns) writeEdge(out, name + "_along", left, right, i, i + 1);
    if (i / columns + 1 < rows) writeEdge(out, name + "_across", left, right, i, i + columns);
  }
  return true;
}

TEST(TargetPhotographs, EveryEdgeOfThirteenChessboardsIs30Millimetres) {
  LONGARM_SKIP_WITHOUT_DATA();
  std::ostringstream picks;
  picks << "feature,kind,vertex,view,u,v\n";
  for (const auto& number : chessboardPairs()) ASSERT_TRUE(writeBoard(picks, number)) << number;
  const std::string path = testing::TempDir() + "photographs_" + std::to_string(::getpid()) + ".csv";
  std::ofstream(path) << picks.str();
  const auto result = longarm("target --views " + example("views.yaml") + " --picks " + path + " --json");
  std::filesystem::remove(path);
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  ASSERT_EQ(json["features"].size(), 13u * 93u);
  double sum = 0, worst = 0;
  for (const auto& feature : json["features"]) {
    ASSERT_TRUE(feature.contains("length")) << feature.dump();
    const double length = feature["length"].get<double>();
    sum += length;
    worst = std::max(worst, std::abs(length - kSquare));
    EXPECT_GT(feature["length_sigma"].get<double>(), 0);
  }
  EXPECT_NEAR(sum / (13 * 93), kSquare, 0.2e-3);
  EXPECT_LT(worst, 1.5e-3);
}

// The command of the user's guide.
TEST(TargetPhotographs, TheShippedExampleMeasuresTheBoard) {
  const auto result = longarm("target --views " + example("views.yaml") + " --picks " + example("picks.csv") + " --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  ASSERT_EQ(json["features"].size(), 4u);
  const double expected[4] = {8 * kSquare, 5 * kSquare, std::hypot(8, 5) * kSquare, kSquare};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(json["features"][i]["length"].get<double>(), expected[i], 1e-3) << json["features"][i]["name"];
  }
  const auto table = longarm("target --views " + example("views.yaml") + " --picks " + example("picks.csv"));
  EXPECT_NE(table.out.find("long_side: length 2"), std::string::npos) << table.out;
}

TEST(TargetPhotographs, TheShippedExamplesCurvePassesThroughTheOtherPick) {
  const auto result = longarm("epipolar --views " + example("views.yaml") +
                              " --from left --pixel 513.79,86.55 --to right --depth 0.3,1 --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  double nearest = 1e9;
  const auto json = result.json();
  const auto& curve = json["curve_px"];
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const Eigen::Vector2d a(curve[i - 1][0], curve[i - 1][1]), b(curve[i][0], curve[i][1]), at(380.81, 93.13);
    const double s = std::clamp((at - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (a + s * (b - a) - at).norm());
  }
  EXPECT_LT(nearest, 0.5);
}

TEST(TargetPhotographs, DebiansPictureIsUndistortedWithTheShippedCamera) {
  const std::string picture = "/usr/share/doc/opencv-doc/examples/data/left01.jpg";
  if (!std::filesystem::exists(picture)) GTEST_SKIP() << "skipped: opencv-doc is not installed";
  const std::string out = testing::TempDir() + "straight_" + std::to_string(::getpid()) + ".png";
  const auto result = longarm("undistort --camera " + example("left.yaml") + " --in " + picture + " --out " + out + " --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  EXPECT_EQ(result.json()["camera"]["camera_matrix"]["data"][0], 533.52331);
  EXPECT_EQ(result.json()["camera"]["distortion_coefficients"]["data"][0], 0);
  EXPECT_EQ(chessboardCorners(out).size(), 54u);
  std::filesystem::remove(out);
}

}  // namespace
}  // namespace longarm::tests
