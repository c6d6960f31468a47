// Suggested matches in synthetic pictures: right, precise, unsure of repeated patterns, silent without texture.
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/vision/painted_wall.h"
#include "vision/match/suggest.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::Match;
using vision::MatchPicture;
using vision::suggestMatches;
using vision::View;

MatchPicture pictureOf(const PaintedWall& wall, const View& view, Dice* dice = nullptr, double gain = 1, double noise = 0) {
  const auto picture = MatchPicture::from(wall.seenBy(view, dice, gain, noise));
  EXPECT_TRUE(picture.ok());
  return *picture;
}

struct Statistics {
  int points = 0, offered = 0, near = 0;
  double squares = 0, covered = 0;
  double rms() const { return std::sqrt(squares / std::max(1, near)); }
};

// Picks random points of a wall in `from` and looks for them in `to`.
Statistics statisticsOf(const PaintedWall& wall, const View& from, const View& to, int points, double gain, double noise) {
  Dice dice(66);
  const auto from_picture = pictureOf(wall, from, &dice, 1, noise), to_picture = pictureOf(wall, to, &dice, gain, noise);
  Statistics out;
  while (out.points < points) {
    const Vector3d p = wall.at(dice.uniform(-0.7, 0.7), dice.uniform(-0.5, 0.5));
    const auto a = from.project(p), b = to.project(p);
    if (!a || !b || !from.camera.containsPixel(*a, -20) || !to.camera.containsPixel(*b, -20)) continue;
    ++out.points;
    const auto matches = suggestMatches(from, from_picture, *a, to, to_picture, {0.4, 6});
    if (!matches.ok()) {
      ADD_FAILURE() << matches.error().message;
      return out;
    }
    if (matches->empty() || matches->front().score <= vision::kOfferScore) continue;
    ++out.offered;
    const Match& best = matches->front();
    const Vector2d error = best.pixel - *b;
    if (error.norm() > 0.5) continue;
    ++out.near;
    out.squares += error.squaredNorm() / 2;
    out.covered += error.dot(best.covariance.inverse() * error) < 5.99 ? 1 : 0;
  }
  return out;
}

TEST(Match, NoiseAndAnotherBrightnessDoNotHurt) {
  const StereoRig rig(false);
  const auto s = statisticsOf(PaintedWall::textured(1), rig.left, rig.right, 200, 0.7, 0.02);
  EXPECT_GE(s.offered, 140);
  EXPECT_GE(s.near, 0.95 * s.offered);
  EXPECT_LT(s.rms(), 0.15);
  EXPECT_GE(s.covered, 0.9 * s.near) << "the stated covariance is too small";
}

TEST(Match, FollowsTheCurveOfDistortedTurnedViews) {
  const StereoRig rig;
  View rolled = rig.right;
  rolled.X_WC.linear() = rolled.X_WC.linear() * expSO3({0.05, -0.04, 0.5});
  rolled.X_WC.translation() += Vector3d(0.05, 0.1, 0.1);
  for (const View* view : {&rig.right, static_cast<const View*>(&rolled)}) {
    const auto s = statisticsOf(PaintedWall::textured(2), rig.left, *view, 40, 1, 0.01);
    EXPECT_GE(s.offered, 28);
    EXPECT_GE(s.near, 0.95 * s.offered);
    EXPECT_LT(s.rms(), 0.15);
  }
}

TEST(Match, AZoomedCameraIsMatchedWithAWideOne) {
  StereoRig rig(false);
  rig.right.camera.fx = rig.right.camera.fy = 1600;
  for (const auto& [from, to] : {std::pair<const View*, const View*>{&rig.left, &rig.right}, {&rig.right, &rig.left}}) {
    const auto s = statisticsOf(PaintedWall::textured(3), *from, *to, 40, 1, 0.01);
    EXPECT_GE(s.offered, 20);
    EXPECT_GE(s.near, 0.95 * s.offered);
  }
}

TEST(Match, ARepeatedPatternIsNeverSure) {
  const StereoRig rig(false);
  Dice dice(9);
  for (const double noise : {0.0, 0.01}) {
    const PaintedWall wall = PaintedWall::repeated(0.04);
    const auto left = pictureOf(wall, rig.left, &dice, 1, noise), right = pictureOf(wall, rig.right, &dice, 0.9, noise);
    double highest = 0;
    for (int i = 0; i < 50; ++i) {
      const Vector2d pick(dice.uniform(300, 560), dice.uniform(60, 420));
      const auto matches = suggestMatches(rig.left, left, pick, rig.right, right, {0.4, 6});
      ASSERT_TRUE(matches.ok()) << matches.error().message;
      if (!matches->empty()) highest = std::max(highest, matches->front().score);
      if (!matches->empty() && matches->front().likeness > 0.9) { EXPECT_GT(matches->front().ambiguity, 0.6); }
    }
    EXPECT_LT(highest, 0.4) << "noise " << noise;
  }
}

TEST(Match, NothingIsSuggestedWithoutTextureOrOutOfSight) {
  const StereoRig rig(false);
  Dice dice(4);
  cv::Mat flat(480, 640, CV_8UC1);
  for (int row = 0; row < flat.rows; ++row) {
    for (int column = 0; column < flat.cols; ++column) flat.at<unsigned char>(row, column) = cv::saturate_cast<unsigned char>(120 + dice.normal(2));
  }
  const auto picture = MatchPicture::from(flat);
  ASSERT_TRUE(picture.ok());
  const auto none = suggestMatches(rig.left, *picture, {320, 240}, rig.right, *picture);
  ASSERT_TRUE(none.ok()) << none.error().message;
  for (const auto& match : *none) EXPECT_LT(match.score, 0.1);
  const auto unseen = suggestMatches(rig.left, *picture, {0, 240}, rig.right, *picture, {0.2, 0.3});
  ASSERT_TRUE(unseen.ok());
  EXPECT_TRUE(unseen->empty());
}

TEST(Match, RefusesPicturesAndPicksThatDoNotBelong) {
  const StereoRig rig(false);
  const auto picture = MatchPicture::from(cv::Mat(480, 640, CV_8UC1, cv::Scalar(9)));
  const auto small = MatchPicture::from(cv::Mat(240, 320, CV_8UC3, cv::Scalar(9, 9, 9)));
  ASSERT_TRUE(picture.ok() && small.ok());
  EXPECT_FALSE(MatchPicture::from(cv::Mat()).ok());
  EXPECT_FALSE(MatchPicture::from(cv::Mat(10, 10, CV_32FC1)).ok());
  const auto size = suggestMatches(rig.left, *picture, {3, 3}, rig.right, *small);
  ASSERT_FALSE(size.ok());
  EXPECT_NE(size.error().message.find("320 x 240"), std::string::npos) << size.error().message;
  const auto off = suggestMatches(rig.left, *picture, {-3, 3}, rig.right, *picture);
  ASSERT_FALSE(off.ok());
  EXPECT_NE(off.error().message.find("off the picture"), std::string::npos) << off.error().message;
  EXPECT_FALSE(suggestMatches(rig.left, *picture, {3, 3}, rig.right, *picture, {2, 1}).ok());
}

}  // namespace
}  // namespace longarm::tests
