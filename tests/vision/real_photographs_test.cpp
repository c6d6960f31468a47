// Measuring in real photographs whose truth is known.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "core/resource_path.h"
#include "core/text.h"
#include "tests/support/test_data.h"
#include "tests/vision/chessboard_pairs.h"
#include "tests/vision/middlebury_data.h"
#include "tests/vision/stereo_rig.h"
#include "vision/snapshot/views_file.h"
#include "vision/stereo/epipolar.h"
#include "vision/stereo/pair_triangulator.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::triangulate;
using vision::View;

vision::ViewSet publishedViews() {
  const auto path = resourcePath("examples/chessboard/views.yaml");
  EXPECT_TRUE(path.ok());
  auto views = vision::readViewsFile(*path);
  EXPECT_TRUE(views.ok()) << views.error().message;
  return views.ok() ? *views : vision::ViewSet{};
}

struct EdgeFigures {
  int count = 0;
  double sum = 0, worst = 0;
  void add(double length) {
    ++count;
    sum += length;
    worst = std::max(worst, std::abs(length - kSquare));
  }
};

void addEdges(const std::vector<Vector3d>& corners, EdgeFigures* figures) {
  for (int row = 0; row < kBoardRows; ++row) {
    for (int column = 0; column < kBoardColumns; ++column) {
      const auto at = [&](int r, int c) { return corners[static_cast<std::size_t>(r * kBoardColumns + c)]; };
      if (column + 1 < kBoardColumns) figures->add((at(row, column + 1) - at(row, column)).norm());
      if (row + 1 < kBoardRows) figures->add((at(row + 1, column) - at(row, column)).norm());
    }
  }
}

TEST(Photographs, EveryEdgeOfTheChessboardIs30Millimetres) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::string folder = dataFolder() + "/opencv_stereo_chess/";
  const auto views = publishedViews();
  ASSERT_NE(views.find("left"), nullptr);
  EdgeFigures edges;
  double epipolar_sum = 0, epipolar_worst = 0;
  for (const auto& number : chessboardPairs()) {
    const auto left = chessboardCorners(folder + "left" + number + ".jpg");
    auto right = chessboardCorners(folder + "right" + number + ".jpg");
    ASSERT_EQ(left.size(), 54u) << number;
    ASSERT_EQ(right.size(), 54u) << number;
    alignCorners(left, &right);
    std::vector<Vector3d> corners;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const auto point = triangulate({{views.find("left"), left[i], 0}, {views.find("right"), right[i], 0}});
      ASSERT_TRUE(point.ok()) << number << ": " << point.error().message;
      corners.push_back(point->xyz);
      const auto curve = epipolarCurve(*views.find("left"), left[i], *views.find("right"));
      ASSERT_TRUE(curve.ok());
      const double off = (curve->nearest(right[i])->pixel - right[i]).norm();
      epipolar_sum += off;
      epipolar_worst = std::max(epipolar_worst, off);
    }
    addEdges(corners, &edges);
  }
  ASSERT_EQ(edges.count, 13 * (6 * 8 + 5 * 9));
  EXPECT_NEAR(edges.sum / edges.count, 0.030, 0.2e-3);
  EXPECT_LT(edges.worst, 1.5e-3);
  EXPECT_LT(epipolar_sum / (13 * 54), 0.15) << "px between corners and curves of their partners";
  EXPECT_LT(epipolar_worst, 0.9);
  RecordProperty("mean_mm", formatFixed(1e3 * edges.sum / edges.count, 4));
  RecordProperty("worst_mm", formatFixed(1e3 * edges.worst, 4));
}

// The pictures that Debian's opencv-doc installs, by the paths that the shipped views.yaml names.
TEST(Photographs, TheShippedViewsOpenDebiansPictures) {
  const auto views = publishedViews();
  ASSERT_EQ(views.entries.size(), 2u);
  if (!std::filesystem::exists(views.entries[0].image)) GTEST_SKIP() << "skipped: opencv-doc is not installed";
  const auto left = chessboardCorners(views.entries[0].image);
  auto right = chessboardCorners(views.entries[1].image);
  ASSERT_EQ(left.size(), 54u);
  ASSERT_EQ(right.size(), 54u);
  alignCorners(left, &right);
  std::vector<std::vector<vision::Sighting>> ends;
  for (const std::size_t corner : {std::size_t{0}, std::size_t{53}}) {
    ends.push_back({{&views.entries[0].view, left[corner], 0}, {&views.entries[1].view, right[corner], 0}});
  }
  const auto first = triangulate(ends[0]), last = triangulate(ends[1]);
  ASSERT_TRUE(first.ok() && last.ok());
  EXPECT_NEAR((last->xyz - first->xyz).norm(), std::hypot(8 * kSquare, 5 * kSquare), 0.8e-3) << "the diagonal";
}

class MiddleburyScene : public testing::TestWithParam<const char*> {};

TEST_P(MiddleburyScene, TrueMatchesGiveTheTrueDepth) {
  LONGARM_SKIP_WITHOUT_DATA();
  const MiddleburyData scene = loadMiddlebury(dataFolder() + "/middlebury2014_quarter/" + GetParam());
  ASSERT_FALSE(scene.disparity.empty());
  const View left = scene.view(false), right = scene.view(true);
  const vision::PairTriangulator pair(left, right);
  double worst = 0;
  int count = 0;
  for (int v = 3; v < scene.height; v += 9) {
    for (int u = 3; u < scene.width; u += 9) {
      if (!std::isfinite(scene.at(u, v))) continue;
      const Vector3d truth = scene.truth(u, v);
      const Vector2d match(u - static_cast<double>(scene.at(u, v)), v);
      const auto point = triangulate({{&left, {u, v}, 0}, {&right, match, 0}});
      ASSERT_TRUE(point.ok()) << point.error().message;
      vision::PairPoint quick;
      ASSERT_TRUE(pair.locate({u, v}, match, &quick));
      worst = std::max({worst, (point->xyz - truth).norm(), (quick.xyz - truth).norm()});
      ++count;
    }
  }
  EXPECT_GT(count, 2000);
  EXPECT_LT(worst, 0.5e-3) << "[m]";
}

TEST_P(MiddleburyScene, StatedSigmaAgreesWithTheErrorOfHalfAPixel) {
  LONGARM_SKIP_WITHOUT_DATA();
  const MiddleburyData scene = loadMiddlebury(dataFolder() + "/middlebury2014_quarter/" + GetParam());
  ASSERT_FALSE(scene.disparity.empty());
  const View left = scene.view(false), right = scene.view(true);
  Dice dice(11);
  double sum = 0;
  int count = 0;
  for (int v = 2; v < scene.height; v += 7) {
    for (int u = 2; u < scene.width; u += 7) {
      if (!std::isfinite(scene.at(u, v))) continue;
      const Vector2d match(u - static_cast<double>(scene.at(u, v)), v);
      const auto point = triangulate({{&left, Vector2d(u, v) + dice.normal2(0.5), 0.5},
                                      {&right, match + dice.normal2(0.5), 0.5}});
      ASSERT_TRUE(point.ok()) << point.error().message;
      const Vector3d error = point->xyz - scene.truth(u, v);
      sum += error.dot(point->covariance.ldlt().solve(error));
      ++count;
    }
  }
  EXPECT_GT(count, 3000);
  EXPECT_GT(sum / count, 2.7);
  EXPECT_LT(sum / count, 3.3);
  RecordProperty("nees", formatFixed(sum / count, 3));
}

INSTANTIATE_TEST_SUITE_P(Photographs, MiddleburyScene, testing::Values("Motorcycle", "Recycle"));

}  // namespace
}  // namespace longarm::tests
