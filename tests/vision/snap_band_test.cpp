// Snap to corners and edges; the band beside an epipolar curve; what misses say about the calibration.
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/vision/stereo_rig.h"
#include "vision/match/snap.h"
#include "vision/stereo/epipolar_band.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::MatchPicture;
using vision::SnapKind;
using vision::snapPick;
using vision::View;

// A bright quarter plane on dark ground, its corner at `corner`, turned by `angle`, as a lens would blur it.
MatchPicture cornerPicture(const Vector2d& corner, double angle, Dice* dice, double noise) {
  cv::Mat image(80, 80, CV_8UC1);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      double sum = 0;
      for (int i = 0; i < 8; ++i) {
        for (int k = 0; k < 8; ++k) {
          const Vector2d p = Vector2d(column - 0.4375 + i / 8.0, row - 0.4375 + k / 8.0) - corner;
          const double x = std::cos(angle) * p.x() + std::sin(angle) * p.y(), y = -std::sin(angle) * p.x() + std::cos(angle) * p.y();
          sum += x > 0 && y > 0 ? 1 : 0;
        }
      }
      image.at<unsigned char>(row, column) = cv::saturate_cast<unsigned char>(60 + 120 * sum / 64);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(), 0.7);
  for (auto* p = image.data; p != image.data + image.total(); ++p) *p = cv::saturate_cast<unsigned char>(*p + dice->normal(noise));
  return MatchPicture::from(image).value();
}

TEST(Snap, FindsCornersToAFractionOfAPixel) {
  Dice dice(8);
  double squares = 0;
  const int trials = 60;
  for (int i = 0; i < trials; ++i) {
    const Vector2d corner(40 + dice.uniform(-1, 1), 40 + dice.uniform(-1, 1));
    const auto picture = cornerPicture(corner, dice.uniform(0, 6.28), &dice, 2);
    const auto snapped = snapPick(picture, corner + Vector2d(dice.uniform(-3, 3), dice.uniform(-3, 3)));
    ASSERT_TRUE(snapped);
    ASSERT_EQ(snapped->kind, SnapKind::kCorner);
    squares += (snapped->pixel - corner).squaredNorm() / 2 / trials;
  }
  EXPECT_LT(std::sqrt(squares), 0.3);
}

TEST(Snap, FindsEdgesToAThirdOfAPixel) {
  Dice dice(18);
  double squares = 0;
  const int trials = 60;
  for (int i = 0; i < trials; ++i) {
    const double angle = dice.uniform(0, 6.28);
    const Vector2d along(std::cos(angle), std::sin(angle)), across(-along.y(), along.x());
    const Vector2d corner = Vector2d(40, 40) - 30 * along + dice.uniform(-1, 1) * across;   // far from the pick
    const auto picture = cornerPicture(corner, angle, &dice, 2);
    const auto snapped = snapPick(picture, Vector2d(40, 40) + dice.uniform(-3, 3) * across);
    ASSERT_TRUE(snapped);
    ASSERT_EQ(snapped->kind, SnapKind::kEdge);
    squares += std::pow((snapped->pixel - corner).dot(across), 2) / trials;
    EXPECT_GT(std::abs(snapped->along.dot(along)), 0.98);
  }
  EXPECT_LT(std::sqrt(squares), 0.3);
}

TEST(Snap, LeavesPicksWithoutACornerOrEdgeAlone) {
  Dice dice(28);
  const auto picture = cornerPicture({10, 10}, 0, &dice, 3);
  EXPECT_FALSE(snapPick(picture, {50, 50}));
  EXPECT_FALSE(snapPick(picture, {-5, 50}));
  EXPECT_FALSE(snapPick(picture, {std::nan(""), 50}));
  vision::SnapOptions nothing;
  nothing.corners = nothing.edges = false;
  EXPECT_FALSE(snapPick(picture, {10, 10}, nothing));
}

TEST(EpipolarBand, HoldsTheTrueMatchesAsOftenAsStated) {
  StereoRig rig;
  rig.right.pose_covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * 2e-3 * 2e-3;
  rig.right.pose_covariance.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() * 1e-3 * 1e-3;
  rig.left.intrinsics_covariance(3, 3) = rig.left.intrinsics_covariance(4, 4) = 1.5 * 1.5;
  Dice dice(38);
  double squares = 0;
  int trials = 0;
  while (trials < 1500) {
    View left = rig.left, right = rig.right;
    left.camera.cx += dice.normal(1.5);
    left.camera.cy += dice.normal(1.5);
    right.X_WC.linear() = expSO3(dice.normal3(2e-3)) * right.X_WC.linear();
    right.X_WC.translation() += dice.normal3(1e-3);
    const Vector3d p = pointSeenByAll({&rig.left, &rig.right}, 1, 2, &dice);
    const auto a = left.project(p), b = right.project(p);
    if (!a || !b || !right.camera.containsPixel(*b, -15)) continue;   // the curve must not leave the picture there
    ++trials;
    const Vector2d pick = *a + dice.normal2(rig.left.sigma_px);
    const auto curve = vision::epipolarCurve(rig.left, pick, rig.right);
    ASSERT_TRUE(curve.ok() && curve->points.size() > 2);
    const auto band = vision::epipolarBand(rig.left, pick, rig.right, *curve);
    ASSERT_TRUE(band.ok()) << band.error().message;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < band->size(); ++k) {
      if ((curve->points[k].pixel - *b).norm() < (curve->points[nearest].pixel - *b).norm()) nearest = k;
    }
    squares += std::pow((curve->nearest(*b)->pixel - *b).norm() / (*band)[nearest], 2);
  }
  EXPECT_NEAR(std::sqrt(squares / trials), 1, 0.08);
}

TEST(EpipolarMiss, IsZeroForTrueMatchesAndSharedByBothPictures) {
  const StereoRig rig;
  const Vector3d p(0.1, -0.05, 1.4);
  const Vector2d a = rig.left.project(p).value(), b = rig.right.project(p).value();
  EXPECT_NEAR(vision::epipolarMiss(rig.left, a, rig.right, b).value(), 0, 1e-6);
  const auto above = vision::epipolarMiss(rig.left, a, rig.right, b + Vector2d(0, 2)), below = vision::epipolarMiss(rig.left, a, rig.right, b - Vector2d(0, 2));
  EXPECT_NEAR(std::abs(*above), 2 / std::sqrt(2.0), 0.05) << "shared between two pictures";
  EXPECT_LT(*above * *below, 0) << "the sign tells the side";
  EXPECT_EQ(vision::epipolarMiss(rig.left, a, rig.left, a).error().code, ErrorCode::kDegenerate);
}

TEST(MissStatistic, WarnsOfAKnockedCameraOnlyAfterSomePicks) {
  vision::MissStatistic usual, knocked;
  Dice dice(48);
  for (int i = 0; i < 20; ++i) {
    usual.add(dice.normal(0.7));
    knocked.add(4.5 + dice.normal(0.7));
    if (i == 1) { EXPECT_EQ(knocked.warning(), ""); }
  }
  EXPECT_EQ(usual.warning(), "");
  EXPECT_NE(knocked.warning().find("calibrate"), std::string::npos);
  EXPECT_NEAR(knocked.meanPx(), 4.5, 0.5);
  knocked.add(std::nan(""));
  EXPECT_EQ(knocked.count(), 20);
}

// The promise of the whole chain: with pick noise and calibration errors the 95 % ellipsoid holds the truth.
TEST(Ellipsoid, HoldsTheTruthIn95PercentWithCalibrationErrorsIncluded) {
  StereoRig rig;
  rig.right.pose_covariance.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() * 1e-3 * 1e-3;
  rig.right.pose_covariance.bottomRightCorner<3, 3>() = Eigen::Matrix3d::Identity() * 5e-4 * 5e-4;
  for (auto* view : {&rig.left, &rig.right}) view->intrinsics_covariance.diagonal().head<5>() << 4, 4, 0, 1, 1;
  Dice dice(58);
  int held = 0;
  const int trials = 2000;
  for (int i = 0; i < trials; ++i) {
    View left = rig.left, right = rig.right;
    right.X_WC.linear() = expSO3(dice.normal3(1e-3)) * right.X_WC.linear();
    right.X_WC.translation() += dice.normal3(5e-4);
    for (auto* view : {&left, &right}) {
      view->camera.fx += dice.normal(2);
      view->camera.fy += dice.normal(2);
      view->camera.cx += dice.normal(1);
      view->camera.cy += dice.normal(1);
    }
    const Vector3d p = pointSeenByAll({&rig.left, &rig.right}, 0.8, 2, &dice);
    const auto a = left.project(p), b = right.project(p);
    ASSERT_TRUE(a.ok() && b.ok());
    const auto point = vision::triangulate({{&rig.left, *a + dice.normal2(0.5), 0}, {&rig.right, *b + dice.normal2(0.5), 0}});
    ASSERT_TRUE(point.ok()) << point.error().message;
    const Vector3d error = point->xyz - p;
    held += error.dot(point->covariance.ldlt().solve(error)) < 7.815 ? 1 : 0;
  }
  EXPECT_GE(held, 0.93 * trials);
  EXPECT_LE(held, 0.97 * trials);
}

}  // namespace
}  // namespace longarm::tests
