// Lines by matched ends and by the planes they span; features as JSON.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/vision/stereo_rig.h"
#include "vision/stereo/line.h"
#include "vision/stereo/measure.h"

namespace longarm::tests {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::estimateLine;
using vision::Feature;
using vision::View;

TEST(Line, MatchedEndsGiveDirectionAndLength) {
  const StereoRig rig;
  const Vector3d a(-0.1, 0.05, 1.4), b(0.2, -0.05, 1.6);
  const auto line = estimateLine("pipe", sightingsOf({&rig.left, &rig.right}, a), sightingsOf({&rig.left, &rig.right}, b));
  ASSERT_TRUE(line.ok()) << line.error().message;
  EXPECT_EQ(line->parent, "head");
  EXPECT_NEAR(line->length(), (b - a).norm(), 1e-9);
  EXPECT_LT((line->direction() - (b - a).normalized()).norm(), 1e-9);
  EXPECT_GT(line->lengthSigma(), 0);
  EXPECT_EQ(line->vertices[0].views, (std::vector<std::string>{"left", "right"}));
}

// Share of 2-sigma misses and ratio of empirical to stated sigma of the length, with and without a common
// error of the right camera's pose.
double lengthSigmaRatio(double pose_sigma_rad) {
  StereoRig rig;
  rig.right.pose_covariance.topLeftCorner<3, 3>() = Matrix3d::Identity() * pose_sigma_rad * pose_sigma_rad;
  const Vector3d a(-0.1, 0.05, 1.4), b(0.2, -0.05, 1.6);
  Dice dice(7);
  double sum2 = 0, stated = 0;
  const int trials = 3000;
  for (int i = 0; i < trials; ++i) {
    View actual = rig.right;
    actual.X_WC.linear() = expSO3(dice.normal3(pose_sigma_rad)) * actual.X_WC.linear();
    std::vector<std::vector<vision::Sighting>> ends;
    for (const Vector3d& end : {a, b}) {
      ends.push_back({{&rig.left, rig.left.project(end).value() + dice.normal2(0.5), 0},
                      {&rig.right, actual.project(end).value() + dice.normal2(0.5), 0}});
    }
    const auto line = estimateLine("pipe", ends[0], ends[1]);
    if (!line.ok()) return -1;
    sum2 += std::pow(line->length() - (b - a).norm(), 2);
    stated += line->lengthSigma();
  }
  return std::sqrt(sum2 / trials) / (stated / trials);
}

TEST(Line, LengthSigmaIsWhatLengthsScatter) { EXPECT_NEAR(lengthSigmaRatio(0), 1, 0.06); }

TEST(Line, ACommonPoseErrorIsNotCountedTwice) { EXPECT_NEAR(lengthSigmaRatio(2e-3), 1, 0.08); }

TEST(Line, RefusalsNameTheEnd) {
  const StereoRig rig(false);
  const auto good = sightingsOf({&rig.left, &rig.right}, {0, 0, 1.5});
  const auto far = sightingsOf({&rig.left, &rig.right}, {0, 0, 200});
  const auto line = estimateLine("pipe", good, far);
  ASSERT_FALSE(line.ok());
  EXPECT_EQ(line.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(line.error().message.find("vertex 1"), std::string::npos) << line.error().message;
  const auto same = estimateLine("pipe", good, good);
  ASSERT_FALSE(same.ok());
  EXPECT_NE(same.error().message.find("coincide"), std::string::npos) << same.error().message;
}

vision::LineSighting onLine(const View& view, const Vector3d& a, const Vector3d& b) {
  return {&view, view.project(a).value(), view.project(b).value()};
}

TEST(Line, PlanesMeetInTheLineWhateverPiecesAreSeen) {
  const StereoRig rig;
  const Vector3d a(0.05, -0.2, 1.4), b(0.12, 0.2, 1.6);
  const auto at = [&](double s) -> Vector3d { return a + s * (b - a); };
  const auto line = vision::lineFromPlanes(onLine(rig.left, at(0.1), at(0.7)), onLine(rig.right, at(0.3), at(1)));
  ASSERT_TRUE(line.ok()) << line.error().message;
  EXPECT_LT((line->point_a - at(0.1)).norm(), 1e-9);
  EXPECT_LT((line->point_b - at(0.7)).norm(), 1e-9);
  EXPECT_GT(line->quality, 0.1);
}

TEST(Line, ALineAlongTheBaselineIsRefusedByItsPlanes) {
  const StereoRig rig(false);
  const auto line = vision::lineFromPlanes(onLine(rig.left, {-0.2, 0.1, 1.5}, {0.2, 0.1, 1.5}),
                                           onLine(rig.right, {-0.2, 0.1, 1.5}, {0.2, 0.1, 1.5}));
  ASSERT_FALSE(line.ok());
  EXPECT_EQ(line.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(line.error().message.find("baseline"), std::string::npos) << line.error().message;
  const auto short_picks = vision::lineFromPlanes({&rig.left, {10, 10}, {11, 10}}, {&rig.right, {10, 10}, {50, 60}});
  ASSERT_FALSE(short_picks.ok());
  EXPECT_EQ(short_picks.error().code, ErrorCode::kInvalidInput);
}

TEST(Measure, EveryKindNeedsItsVertices) {
  const StereoRig rig;
  const auto point = sightingsOf({&rig.left, &rig.right}, {0, 0, 1.5});
  EXPECT_TRUE(vision::measureFeature("p", vision::FeatureKind::kPoint, {point}).ok());
  const auto two = vision::measureFeature("p", vision::FeatureKind::kPoint, {point, point});
  ASSERT_FALSE(two.ok());
  EXPECT_EQ(two.error().code, ErrorCode::kInvalidInput);
}

TEST(FeatureJson, ReadsBackWhatItPrints) {
  const StereoRig rig;
  const auto line = estimateLine("pipe \"A\"", sightingsOf({&rig.left, &rig.right}, {-0.1, 0.05, 1.4}),
                                 sightingsOf({&rig.left, &rig.right}, {0.2, -0.05, 1.6}));
  ASSERT_TRUE(line.ok());
  const auto json = toJson(*line);
  EXPECT_EQ(json["kind"], "line");
  EXPECT_EQ(json["vertices"][0]["covariance"].size(), 9u);
  EXPECT_NEAR(json["length"].get<double>(), line->length(), 1e-12);
  const auto back = vision::featureFromJson(json);
  ASSERT_TRUE(back.ok()) << back.error().message;
  EXPECT_EQ(back->name, line->name);
  EXPECT_EQ(back->vertices[1].xyz, line->vertices[1].xyz);
  EXPECT_EQ(back->vertices[1].covariance, line->vertices[1].covariance);
}

}  // namespace
}  // namespace longarm::tests
