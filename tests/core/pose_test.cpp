#include <random>

#include <gtest/gtest.h>

#include "core/pose.h"

namespace longarm {
namespace {

TEST(Rotation, LogInvertsExpUpToAHalfTurn) {
  std::mt19937 rng(1);
  std::normal_distribution<double> n;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d axis = Eigen::Vector3d(n(rng), n(rng), n(rng)).normalized();
    const double angle = i < 10 ? std::pow(10.0, -i) : 3.14159 * i / 1000.0;
    EXPECT_LT((logSO3(expSO3(axis * angle)) - axis * angle).norm(), 1e-8);
  }
}

TEST(Rotation, ExpIsARotationWithTheAngleAskedFor) {
  const Eigen::Matrix3d R = expSO3({0, 0, 1.5707963267948966});
  EXPECT_LT((R * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(angleBetween(Eigen::Matrix3d::Identity(), R), 1.5707963267948966, 1e-12);
}

TEST(Pose, RpyTurnsAboutFixedAxesXThenYThenZ) {
  const Pose X = poseFromRpy({1, 2, 3}, {0.1, 0.2, 0.3});
  const Eigen::Matrix3d R = expSO3({0, 0, 0.3}) * expSO3({0, 0.2, 0}) * expSO3({0.1, 0, 0});
  EXPECT_LT((X.linear() - R).norm(), 1e-12);
}

TEST(Pose, InterpolationMeetsBothEnds) {
  const Pose a = poseFromRpy({0, 0, 0}, {0.3, 0, 0});
  const Pose b = poseFromRpy({1, 0, 0}, {0, 1.2, 2});
  EXPECT_TRUE(interpolate(a, b, 0).isApprox(a, 1e-12));
  EXPECT_TRUE(interpolate(a, b, 1).isApprox(b, 1e-12));
  EXPECT_TRUE(isRigid(interpolate(a, b, 0.4)));
}

TEST(Pose, RotationWithZIsRightHanded) {
  for (const Eigen::Vector3d& z : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -2, 0), Eigen::Vector3d(1, 1, -1)}) {
    const Eigen::Matrix3d R = rotationWithZ(z);
    EXPECT_LT((R.col(2) - z.normalized()).norm(), 1e-12);
    EXPECT_NEAR(R.determinant(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace longarm
