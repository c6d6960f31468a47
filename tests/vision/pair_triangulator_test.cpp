// The quick way must agree with the thorough one.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/vision/stereo_rig.h"
#include "vision/stereo/pair_triangulator.h"

namespace longarm::tests {
namespace {

using Eigen::Vector3d;
using vision::PairPoint;
using vision::PairTriangulator;
using vision::View;

TEST(PairTriangulator, IsExactWithoutNoise) {
  const StereoRig rig;
  const PairTriangulator pair(rig.left, rig.right);
  Dice dice(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 0.4, 6, &dice);
    PairPoint point;
    ASSERT_TRUE(pair.locate(rig.left.project(truth).value(), rig.right.project(truth).value(), &point));
    EXPECT_LT((point.xyz - truth).norm(), 1e-10) << "case " << i;
    EXPECT_LT(point.miss_m, 1e-9);
  }
}

TEST(PairTriangulator, AgreesWithTriangulateFarBelowTheNoise) {
  for (const bool lens : {false, true}) {
    StereoRig rig(lens);
    rig.right.sigma_px = 0.8;
    const PairTriangulator pair(rig.left, rig.right);
    Dice dice(2);
    for (int i = 0; i < 1000; ++i) {
      const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 0.8, 4, &dice);
      const auto sightings = sightingsOf({&rig.left, &rig.right}, truth, &dice, 0.5);
      const auto thorough = triangulate(sightings);
      PairPoint quick;
      ASSERT_TRUE(thorough.ok());
      ASSERT_TRUE(pair.locate(sightings[0].pixel, sightings[1].pixel, &quick));
      const Vector3d apart = quick.xyz - thorough->xyz;
      EXPECT_LT(std::sqrt(apart.dot(thorough->covariance.ldlt().solve(apart))), 0.01) << "sigmas, case " << i;
      EXPECT_LT((quick.covariance - thorough->covariance).norm(), 0.03 * thorough->covariance.norm()) << "case " << i;
      EXPECT_NEAR(quick.miss_m, thorough->miss_m, 1e-9);
      EXPECT_NEAR(quick.parallax, thorough->parallax, 0.02 * thorough->parallax);
    }
  }
}

TEST(PairTriangulator, ManyAtOnceAreWhatEachIsAlone) {
  for (const bool lens : {false, true}) {
    const StereoRig rig(lens);
    const PairTriangulator pair(rig.left, rig.right);
    Dice dice(6);
    std::vector<Eigen::Vector2d> a, b;
    for (int i = 0; i < 1003; ++i) {       // Not a whole number of blocks.
      a.emplace_back(dice.uniform(-60, 700), dice.uniform(-60, 540));
      b.emplace_back(dice.uniform(-60, 700), a.back().y() + dice.normal(6));
    }
    std::vector<Vector3d> points;
    const std::size_t located = pair.locateAll(a, b, &points);
    std::size_t expected = 0;
    int compared = 0;
    ASSERT_EQ(points.size(), a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      PairPoint alone;
      const bool found = pair.locate(a[i], b[i], &alone);
      expected += found ? 1 : 0;
      ASSERT_EQ(found, points[i].allFinite()) << "pair " << i;
      if (!found) continue;
      // Both are within second order of the noise of the same point; rays that miss by more are no pair.
      const Vector3d off = points[i] - alone.xyz;
      const double sigmas = std::sqrt(off.dot(alone.covariance.ldlt().solve(off)));
      const double apart = alone.miss_m / std::sqrt(alone.covariance.eigenvalues().real().minCoeff());
      if (apart > 4) continue;
      ++compared;
      ASSERT_LT(sigmas, 0.02) << "pair " << i << ", rays " << apart << " sigma apart";
    }
    EXPECT_EQ(located, expected);
    EXPECT_GT(compared, 30);
    EXPECT_GT(located, 200U);
    EXPECT_LT(located, 1000U);
  }
}

TEST(PairTriangulator, StatesTheUncertaintyItHas) {
  const StereoRig rig;
  const PairTriangulator pair(rig.left, rig.right);
  Dice dice(3);
  double sum = 0;
  int beyond = 0;
  const int trials = 5000;
  for (int i = 0; i < trials; ++i) {
    const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 0.8, 2.5, &dice);
    const auto sightings = sightingsOf({&rig.left, &rig.right}, truth, &dice, 0.5);
    PairPoint point;
    ASSERT_TRUE(pair.locate(sightings[0].pixel, sightings[1].pixel, &point));
    const Vector3d error = point.xyz - truth;
    const double nees = error.dot(point.covariance.ldlt().solve(error));
    sum += nees;
    beyond += nees > 7.815 ? 1 : 0;
  }
  EXPECT_GT(sum / trials, 2.7);
  EXPECT_LT(sum / trials, 3.3);
  EXPECT_GT(beyond, 0.03 * trials);
  EXPECT_LT(beyond, 0.07 * trials);
}

TEST(PairTriangulator, RefusesWhatTriangulateRefuses) {
  const StereoRig rig;
  const PairTriangulator pair(rig.left, rig.right);
  Dice dice(4);
  int refused = 0, differ = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d a(dice.uniform(-50, 690), dice.uniform(-50, 530));
    const Eigen::Vector2d b(dice.uniform(-50, 690), a.y() + dice.normal(6));
    const auto thorough = vision::triangulate({{&rig.left, a, 0}, {&rig.right, b, 0}});
    PairPoint quick;
    const bool located = pair.locate(a, b, &quick);
    refused += located ? 0 : 1;
    differ += located == thorough.ok() ? 0 : 1;
    if (located) {
      EXPECT_TRUE(quick.xyz.allFinite() && quick.covariance.allFinite());
    }
  }
  EXPECT_GT(refused, 300);
  EXPECT_LE(differ, 30) << "they differ only at the very limits";
}

TEST(PairTriangulator, ViewsOfDifferentParentsAreOurOwnMistake) {
  StereoRig rig;
  rig.right.parent = "wrist";
  EXPECT_THROW(PairTriangulator(rig.left, rig.right), std::logic_error);
}

}  // namespace
}  // namespace longarm::tests
