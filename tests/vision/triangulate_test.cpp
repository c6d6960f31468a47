// Points from picks: exact without noise, as uncertain as stated with it, refused where nothing is known.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/vision/stereo_rig.h"

namespace longarm::tests {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using vision::Sighting;
using vision::triangulate;
using vision::View;

constexpr double kExact = 1e-10;   // [m], a minimum found to the last bits

std::string refusal(const std::vector<Sighting>& sightings, ErrorCode code) {
  const auto point = triangulate(sightings);
  if (point.ok()) return "measured";
  EXPECT_EQ(point.error().code, code) << point.error().message;
  return point.error().message;
}

TEST(Triangulate, IsExactWithoutNoise) {
  const StereoRig rig;
  const std::vector<const View*> views = {&rig.left, &rig.right};
  Dice dice(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d truth = pointSeenByAll(views, 0.4, 6, &dice);
    const auto point = triangulate(sightingsOf(views, truth));
    ASSERT_TRUE(point.ok()) << point.error().message;
    EXPECT_LT((point->xyz - truth).norm(), kExact) << "case " << i << " at z " << truth.z();
    EXPECT_LT(point->miss_m, 1e-9);
    EXPECT_LT(point->reprojection_rms_px, 1e-8);
    EXPECT_TRUE(point->warnings.empty()) << point->warnings.front();
  }
}

TEST(Triangulate, IsExactFromManyViews) {
  Dice dice(2);
  std::vector<View> all;
  for (int i = 0; i < 8; ++i) {
    all.push_back(viewOf(lensCamera("view" + std::to_string(i)), dice.normal3(0.2), dice.normal3(0.06)));
  }
  for (std::size_t count = 2; count <= all.size(); ++count) {
    std::vector<const View*> views;
    for (std::size_t i = 0; i < count; ++i) views.push_back(&all[i]);
    for (int i = 0; i < 50; ++i) {
      const Vector3d truth = pointSeenByAll(views, 1, 4, &dice);
      const auto point = triangulate(sightingsOf(views, truth));
      ASSERT_TRUE(point.ok()) << count << " views: " << point.error().message;
      EXPECT_LT((point->xyz - truth).norm(), kExact) << count << " views";
    }
  }
}

TEST(Triangulate, WorksInAnyParentFrame) {
  StereoRig rig;
  const Pose X_PW = poseFrom({120, -40, 7}, {0.3, -0.5, 0.2, 0.7});
  const Vector3d truth(0.2, -0.1, 1.7);
  const auto sightings = sightingsOf({&rig.left, &rig.right}, truth);
  const auto here = triangulate(sightings);
  ASSERT_TRUE(here.ok());
  StereoRig moved;
  moved.left.X_WC = X_PW * rig.left.X_WC;
  moved.right.X_WC = X_PW * rig.right.X_WC;
  const auto there = triangulate({{&moved.left, sightings[0].pixel, 0}, {&moved.right, sightings[1].pixel, 0}});
  ASSERT_TRUE(there.ok());
  EXPECT_LT((there->xyz - X_PW * here->xyz).norm(), 1e-9);
  const Matrix3d turned = X_PW.linear() * here->covariance * X_PW.linear().transpose();
  EXPECT_LT((there->covariance - turned).norm(), 1e-6 * turned.norm());
}

// Mean of e^T C^-1 e over trials is 3 when the stated covariance C is right.
double meanNees(const std::vector<const View*>& views, double near_m, double far_m, int trials, std::uint64_t seed,
                double* outside = nullptr) {
  Dice dice(seed);
  double sum = 0;
  int count = 0, beyond = 0;
  for (int i = 0; i < trials; ++i) {
    const Vector3d truth = pointSeenByAll(views, near_m, far_m, &dice);
    const auto point = triangulate(sightingsOf(views, truth, &dice, views.front()->sigma_px));
    if (!point.ok()) continue;
    const Vector3d error = point->xyz - truth;
    const double nees = error.dot(point->covariance.ldlt().solve(error));
    sum += nees;
    beyond += nees > 7.815 ? 1 : 0;    // 95 % of chi-square with 3 degrees of freedom
    ++count;
  }
  EXPECT_EQ(count, trials) << "none of these is refused";
  if (outside != nullptr) *outside = static_cast<double>(beyond) / count;
  return sum / count;
}

TEST(Triangulate, StatesTheUncertaintyItHas) {
  const StereoRig rig;
  double outside = 0;
  const double nees = meanNees({&rig.left, &rig.right}, 0.8, 2.5, 5000, 3, &outside);
  EXPECT_GT(nees, 2.7);
  EXPECT_LT(nees, 3.3);
  EXPECT_GT(outside, 0.03);
  EXPECT_LT(outside, 0.07);
}

TEST(Triangulate, StatesTheUncertaintyItHasWithThreeViews) {
  const StereoRig rig;
  const View third = viewOf(lensCamera("third"), {0.1, -0.3, 0.1}, {-0.1, 0.02, 0});
  const double nees = meanNees({&rig.left, &rig.right, &third}, 1, 2.5, 3000, 4);
  EXPECT_GT(nees, 2.7);
  EXPECT_LT(nees, 3.3);
}

TEST(Triangulate, PoseCovarianceOfTheViewsIsCarried) {
  StereoRig rig;
  Vector6d sigmas;
  sigmas << 1e-3, 2e-3, 1e-3, 1e-3, 5e-4, 1e-3;   // [rad], [m]
  rig.right.pose_covariance = sigmas.cwiseAbs2().asDiagonal();
  Dice dice(5);
  double sum = 0;
  int beyond = 0;
  const int trials = 3000;
  for (int i = 0; i < trials; ++i) {
    const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 1, 2.5, &dice);
    View actual = rig.right;   // where the right camera really is
    actual.X_WC.linear() = expSO3(dice.normal3(1).cwiseProduct(sigmas.head<3>())) * actual.X_WC.linear();
    actual.X_WC.translation() += dice.normal3(1).cwiseProduct(sigmas.tail<3>());
    const auto seen = actual.project(truth);
    ASSERT_TRUE(seen.ok());
    const auto point = triangulate({{&rig.left, rig.left.project(truth).value() + dice.normal2(0.5), 0},
                                    {&rig.right, *seen + dice.normal2(0.5), 0}});
    ASSERT_TRUE(point.ok()) << point.error().message;
    const Vector3d error = point->xyz - truth;
    const double nees = error.dot(point->covariance.ldlt().solve(error));
    sum += nees;
    beyond += nees > 7.815 ? 1 : 0;
  }
  EXPECT_GT(sum / trials, 2.7);
  EXPECT_LT(sum / trials, 3.3);
  EXPECT_GT(beyond, 0.03 * trials) << "the 95 % ellipsoid holds 93 to 97 %, calibration error included";
  EXPECT_LT(beyond, 0.07 * trials);
}

// Lindstrom, "Triangulation made easy", CVPR 2010, niter2: the closed-form least-squares correction of two ideal pixels.
void correctByLindstrom(const Matrix3d& E, Vector3d* x0, Vector3d* x1) {
  Eigen::Matrix<double, 2, 3> S;
  S << 1, 0, 0, 0, 1, 0;
  const Eigen::Matrix2d E2 = S * E * S.transpose();
  Eigen::Vector2d n = S * E * *x1, m = S * E.transpose() * *x0;
  const double a = n.dot(E2 * m), b = (n.squaredNorm() + m.squaredNorm()) / 2, c = x0->dot(E * *x1);
  const double d = std::sqrt(b * b - a * c), l = c / (b + d);
  const Eigen::Vector2d dx = l * n, dm = l * m;
  n -= E2 * dm;
  m -= E2.transpose() * dx;
  const double scale = l * 2 * d / (n.squaredNorm() + m.squaredNorm());
  *x0 -= S.transpose() * (scale * n);
  *x1 -= S.transpose() * (scale * m);
}

TEST(Triangulate, AgreesWithTheClosedFormOfTwoIdealViews) {
  StereoRig rig(false);
  rig.right.X_WC.linear() = expSO3({0.02, -0.12, 0.03});
  const Pose X_LR = rig.left.X_WC.inverse() * rig.right.X_WC;
  const Vector3d t = X_LR.translation();
  Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  const Matrix3d E = cross * X_LR.linear();   // x0^T E x1 = 0
  const auto& camera = rig.left.camera;
  Dice dice(12);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 0.8, 4, &dice);
    const auto sightings = sightingsOf({&rig.left, &rig.right}, truth, &dice, 1);
    const auto point = triangulate(sightings);
    ASSERT_TRUE(point.ok());
    Vector3d x0((sightings[0].pixel.x() - camera.cx) / camera.fx, (sightings[0].pixel.y() - camera.cy) / camera.fy, 1);
    Vector3d x1((sightings[1].pixel.x() - camera.cx) / camera.fx, (sightings[1].pixel.y() - camera.cy) / camera.fy, 1);
    correctByLindstrom(E, &x0, &x1);
    const Vector3d v = X_LR.linear() * x1, normal = x0.cross(v);
    const Vector3d closed = rig.left.X_WC * Vector3d(t.cross(v).dot(normal) / normal.squaredNorm() * x0);
    EXPECT_LT((point->xyz - closed).norm(), 1e-6 * closed.norm()) << "case " << i;
  }
}

TEST(Triangulate, DepthSigmaIsTheTextbooksWithinOnePercent) {
  const auto sigmaZ = [](double z, double sigma_px) {
    StereoRig rig(false, 0.25);
    rig.left.sigma_px = rig.right.sigma_px = sigma_px;
    const auto point = triangulate(sightingsOf({&rig.left, &rig.right}, {0.125, 0, z}));
    return point.ok() ? std::sqrt(point->covariance(2, 2)) : -1;
  };
  // Z^2 sigma sqrt(2) / (f b) with f 800 px, b 0.25 m.
  EXPECT_NEAR(sigmaZ(1.5, 0.5), 7.95e-3, 0.01 * 7.95e-3);
  EXPECT_NEAR(sigmaZ(3, 1), 63.6e-3, 0.01 * 63.6e-3);
}

TEST(Triangulate, ASightingsOwnSigmaCounts) {
  const StereoRig rig;
  auto sightings = sightingsOf({&rig.left, &rig.right}, {0.1, 0, 1.5});
  const auto usual = triangulate(sightings);
  sightings[0].sigma_px = sightings[1].sigma_px = 2 * rig.left.sigma_px;
  const auto doubled = triangulate(sightings);
  ASSERT_TRUE(usual.ok() && doubled.ok());
  EXPECT_LT((doubled->covariance - 4 * usual->covariance).norm(), 1e-9 * doubled->covariance.norm());
}

TEST(Triangulate, AWrongPickDoesLessHarmWithHuber) {
  const StereoRig rig;
  const View third = viewOf(lensCamera("third"), {0.1, -0.3, 0.1}, {-0.1, 0.02, 0});
  const View fourth = viewOf(lensCamera("fourth"), {-0.2, 0.2, 0.1}, {0.1, 0.02, 0});
  const Vector3d truth(0.1, 0.05, 1.5);
  auto sightings = sightingsOf({&rig.left, &rig.right, &third, &fourth}, truth);
  sightings[1].pixel.x() += 20;
  vision::TriangulationOptions robust;
  robust.huber_sigmas = 1.345;
  const auto plain = triangulate(sightings), huber = triangulate(sightings, robust);
  ASSERT_TRUE(plain.ok() && huber.ok());
  EXPECT_LT((huber->xyz - truth).norm(), 0.3 * (plain->xyz - truth).norm());
  EXPECT_FALSE(plain->warnings.empty()) << "the picks disagree";
}

TEST(Triangulate, AMissIsReportedInMetresNotRefused) {
  const StereoRig rig(false);
  auto sightings = sightingsOf({&rig.left, &rig.right}, {0.125, 0, 2});
  sightings[1].pixel.y() += 8;
  const auto point = triangulate(sightings);
  ASSERT_TRUE(point.ok()) << point.error().message;
  EXPECT_NEAR(point->miss_m, 8.0 / 800 * 2, 2e-4);       // 8 px at 2 m
  EXPECT_NEAR(point->reprojection_rms_px, 4 / std::sqrt(2.0), 0.01);   // 4 px in each view
  ASSERT_FALSE(point->warnings.empty());
  EXPECT_NE(point->warnings.front().find("disagree"), std::string::npos) << point->warnings.front();
}

TEST(Triangulate, RefusesParallelRays) {
  const StereoRig rig(false);
  const std::string far = refusal(sightingsOf({&rig.left, &rig.right}, {0, 0, 100}), ErrorCode::kDegenerate);
  EXPECT_NE(far.find("parallel within 0.14 degrees (need 0.30)"), std::string::npos) << far;
  const auto warned = triangulate(sightingsOf({&rig.left, &rig.right}, {0.125, 0, 20}));
  ASSERT_TRUE(warned.ok());
  ASSERT_FALSE(warned->warnings.empty());
  EXPECT_NE(warned->warnings.front().find("0.7"), std::string::npos) << warned->warnings.front();
  refusal({{&rig.left, {320, 240}, 0}, {&rig.right, {320, 240}, 0}}, ErrorCode::kDegenerate);
}

TEST(Triangulate, RefusesPointsBehindTheCameras) {
  const StereoRig rig(false);
  // Divergent: the left camera looks left of the right camera's ray.
  const std::string behind =
      refusal({{&rig.left, {200, 240}, 0}, {&rig.right, {440, 240}, 0}}, ErrorCode::kDegenerate);
  EXPECT_NE(behind.find("behind view \"left\""), std::string::npos) << behind;
  // One camera looks back at the other: the rays meet before one and behind the other.
  const View back = viewOf(pinhole("back"), {0.25, 0, -1}, {0, M_PI, 0});
  const std::string one = refusal({{&rig.left, rig.left.project({0, 0, 2}).value(), 0}, {&back, {330, 240}, 0}},
                                  ErrorCode::kDegenerate);
  EXPECT_NE(one.find("behind"), std::string::npos) << one;
}

TEST(Triangulate, RefusesViewsFromOnePlace) {
  const View a = viewOf(pinhole("a"), {1, 2, 3}), b = viewOf(pinhole("b"), {1, 2, 3}, {0, 0.2, 0});
  const std::string message = refusal({{&a, {320, 240}, 0}, {&b, {320, 240}, 0}}, ErrorCode::kDegenerate);
  EXPECT_NE(message.find("same place"), std::string::npos) << message;
}

TEST(Triangulate, RefusesWhatIsNoMeasurement) {
  StereoRig rig;
  const auto sightings = sightingsOf({&rig.left, &rig.right}, {0.1, 0, 1.5});
  EXPECT_NE(refusal({sightings[0]}, ErrorCode::kInvalidInput).find("there are 1"), std::string::npos);
  auto bad = sightings;
  bad[0].pixel.x() = std::nan("");
  EXPECT_NE(refusal(bad, ErrorCode::kInvalidInput).find("left"), std::string::npos);
  bad = sightings;
  bad[1].view = nullptr;
  refusal(bad, ErrorCode::kInvalidInput);
  bad = sightings;
  bad[1].pixel = {1e6, 1e6};
  EXPECT_NE(refusal(bad, ErrorCode::kInvalidInput).find("right"), std::string::npos);
  View elsewhere = rig.right;
  elsewhere.parent = "wrist";
  bad = sightings;
  bad[1].view = &elsewhere;
  const std::string parents = refusal(bad, ErrorCode::kInvalidInput);
  EXPECT_NE(parents.find("wrist"), std::string::npos) << parents;
  rig.left.sigma_px = 0;
  EXPECT_NE(refusal(sightings, ErrorCode::kInvalidInput).find("sigma_px"), std::string::npos);
}

TEST(Triangulate, EveryRandomPairOfPicksIsAnsweredWithFiniteNumbersOrARefusal) {
  const StereoRig rig;
  Dice dice(6);
  int measured = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto point = triangulate({{&rig.left, {dice.uniform(-50, 690), dice.uniform(-50, 530)}, 0},
                                    {&rig.right, {dice.uniform(-50, 690), dice.uniform(-50, 530)}, 0}});
    if (!point.ok()) {
      EXPECT_GT(point.error().message.size(), 20u);
      continue;
    }
    ++measured;
    EXPECT_TRUE(point->xyz.allFinite() && point->covariance.allFinite()) << "case " << i;
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix3d>(point->covariance).eigenvalues()[0], 0) << "case " << i;
    EXPECT_TRUE(rig.left.project(point->xyz).ok() && rig.right.project(point->xyz).ok()) << "case " << i;
  }
  EXPECT_GT(measured, 300);
}

}  // namespace
}  // namespace longarm::tests
