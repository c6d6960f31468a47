// Planes and boxes: exact without noise, as uncertain as stated with it, refused where they are degenerate.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/vision/stereo_rig.h"
#include "vision/stereo/measure.h"

namespace longarm::tests {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using vision::Feature;
using vision::FeatureKind;
using vision::Sighting;
using vision::View;

constexpr double kDegree = 0.017453292519943295;
using Corners = std::vector<Vector3d>;
using Views = std::vector<const View*>;

Result<Feature> measured(FeatureKind kind, const Corners& corners, const Views& views, Dice* dice = nullptr) {
  std::vector<std::vector<Sighting>> vertices;
  for (const auto& corner : corners) vertices.push_back(sightingsOf(views, corner, dice, 0.5));
  return vision::measureFeature("it", kind, vertices);
}

// The box of the worked figures: 0.30 x 0.20 x 0.15 m at 1.5 m.
const Vector3d kSize(0.30, 0.20, 0.15);
Matrix3d boxAttitude() { return expSO3({-0.6, 0.6, 0}); }
Corners boxCorners(double shear = 0) {
  const Matrix3d R = boxAttitude();
  const Vector3d o(0.05, 0.02, 1.5);
  const Vector3d second = expSO3(R.col(2) * shear) * R.col(1);
  return {o, o + kSize[0] * R.col(0), o + kSize[1] * second, o + kSize[2] * R.col(2)};
}

// Two lines of 0.3 m that enclose an angle, 1.2 m before the pair.
Corners planeCorners(double enclosed) {
  const Matrix3d R = expSO3({0.5, 0.3, 0.1});
  const Vector3d a(0.05, 0, 1.2);
  return {a + 0.3 * R.col(0), a, a + 0.3 * (std::cos(enclosed) * R.col(0) + std::sin(enclosed) * R.col(1))};
}

TEST(Plane, IsExactWithoutNoiseAndLooksAtTheCameras) {
  const StereoRig rig;
  const Corners corners = planeCorners(90 * kDegree);
  const auto plane = measured(FeatureKind::kPlane, corners, {&rig.left, &rig.right});
  ASSERT_TRUE(plane.ok()) << plane.error().message;
  ASSERT_TRUE(plane->plane);
  const Vector3d normal = expSO3({0.5, 0.3, 0.1}).col(2);
  EXPECT_NEAR(std::abs(plane->plane->normal.dot(normal)), 1, 1e-12);
  EXPECT_GT(plane->plane->normal.dot(-plane->plane->center), 0) << "points away from the cameras";
  for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((plane->plane->corners[i] - corners[i]).norm(), 1e-9);
  EXPECT_LT((plane->plane->corners[3] - (corners[0] + corners[2] - corners[1])).norm(), 1e-9);
  EXPECT_LT((plane->plane->center - 0.5 * (corners[0] + corners[2])).norm(), 1e-9);
}

// Measured and predicted RMS error of the normal [deg].
std::pair<double, double> normalErrors(double enclosed, int trials, double pose_sigma = 0) {
  StereoRig rig(false);
  rig.right.pose_covariance.topLeftCorner<3, 3>() = Matrix3d::Identity() * pose_sigma * pose_sigma;
  const Vector3d truth = expSO3({0.5, 0.3, 0.1}).col(2);
  Dice dice(11);
  double sum = 0, predicted = 0;
  for (int i = 0; i < trials; ++i) {
    View actual = rig.right;
    actual.X_WC.linear() = expSO3(dice.normal3(pose_sigma)) * actual.X_WC.linear();
    std::vector<std::vector<Sighting>> vertices;
    for (const auto& corner : planeCorners(enclosed)) {
      vertices.push_back({{&rig.left, rig.left.project(corner).value() + dice.normal2(0.5), 0},
                          {&rig.right, actual.project(corner).value() + dice.normal2(0.5), 0}});
    }
    const auto plane = vision::measureFeature("it", FeatureKind::kPlane, vertices);
    if (!plane.ok()) return {-1, -1};
    sum += std::pow(std::acos(std::min(1.0, std::abs(plane->plane->normal.dot(truth)))) / kDegree, 2);
    predicted += std::pow(plane->plane->angleError() / kDegree, 2);
  }
  return {std::sqrt(sum / trials), std::sqrt(predicted / trials)};
}

TEST(Plane, NormalIsAsUncertainAsTheTableSays) {
  const std::pair<double, double> rows[] = {{90, 1.62}, {60, 1.60}, {30, 2.34}, {15, 4.23}};
  for (const auto& [enclosed, rms] : rows) {
    const auto [actual, predicted] = normalErrors(enclosed * kDegree, 1500);
    EXPECT_NEAR(predicted, rms, 0.1 * rms) << enclosed << " degrees enclosed";
    EXPECT_NEAR(actual, predicted, 0.06 * predicted) << enclosed << " degrees enclosed";
  }
}

TEST(Plane, ASharedPoseErrorTurnsTheNormalAsStated) {
  const auto [actual, predicted] = normalErrors(90 * kDegree, 1500, 4e-3);
  EXPECT_NEAR(actual, predicted, 0.08 * predicted);
}

TEST(Plane, ANarrowAngleIsRefusedAndAPoorOneWarned) {
  const StereoRig rig(false);
  const auto narrow = measured(FeatureKind::kPlane, planeCorners(5 * kDegree), {&rig.left, &rig.right});
  ASSERT_FALSE(narrow.ok());
  EXPECT_EQ(narrow.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(narrow.error().message.find("right angle"), std::string::npos) << narrow.error().message;
  const auto in_line = measured(FeatureKind::kPlane, planeCorners(0), {&rig.left, &rig.right});
  ASSERT_FALSE(in_line.ok());
  EXPECT_EQ(in_line.error().code, ErrorCode::kDegenerate);
  const auto poor = measured(FeatureKind::kPlane, planeCorners(15 * kDegree), {&rig.left, &rig.right});
  ASSERT_TRUE(poor.ok()) << poor.error().message;
  ASSERT_FALSE(poor->warnings.empty());
  EXPECT_NE(poor->warnings.back().find("normal"), std::string::npos);
  const auto good = measured(FeatureKind::kPlane, planeCorners(90 * kDegree), {&rig.left, &rig.right});
  EXPECT_TRUE(good->warnings.empty());
}

TEST(Triad, IsExactWithoutNoiseInTwoAndThreeViews) {
  const StereoRig rig;
  const View third = viewOf(lensCamera("third"), {0.1, 0.3, 0.2}, {0.2, 0, 0});
  for (const Views& views : {Views{&rig.left, &rig.right}, Views{&rig.left, &rig.right, &third}}) {
    const Corners corners = boxCorners();
    const auto triad = measured(FeatureKind::kTriad, corners, views);
    ASSERT_TRUE(triad.ok()) << triad.error().message;
    const auto& box = *triad->box;
    EXPECT_TRUE(box.is_box);
    EXPECT_EQ(box.degrees_of_freedom, static_cast<int>(8 * views.size()) - 9);
    EXPECT_LT((box.size - kSize).norm(), 1e-9);
    EXPECT_LT((box.X_WB.linear() - boxAttitude()).norm(), 1e-9);
    EXPECT_LT((box.X_WB.translation() - (corners[0] + boxAttitude() * kSize / 2)).norm(), 1e-9);
    EXPECT_LT(box.orthogonality_error, 1e-7);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((triad->vertices[i].xyz - corners[i]).norm(), 1e-9);
  }
}

TEST(Triad, EdgesMarkedLeftHandedGiveTheSameRightHandedBox) {
  const StereoRig rig;
  Corners corners = boxCorners();
  std::swap(corners[1], corners[2]);
  const auto triad = measured(FeatureKind::kTriad, corners, {&rig.left, &rig.right});
  ASSERT_TRUE(triad.ok()) << triad.error().message;
  EXPECT_NEAR(triad->box->X_WB.linear().determinant(), 1, 1e-9);
  Vector3d size = triad->box->size;
  std::sort(size.data(), size.data() + 3);
  EXPECT_LT((size - Vector3d(0.15, 0.20, 0.30)).norm(), 1e-9);
  EXPECT_LT((triad->box->X_WB.translation() - (boxCorners()[0] + boxAttitude() * kSize / 2)).norm(), 1e-9);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((triad->vertices[i].xyz - corners[i]).norm(), 1e-9);
}

struct BoxStatistics {
  Vector3d rms_mm = Vector3d::Zero(), predicted_mm = Vector3d::Zero();
  double direction_deg = 0, chi2 = 0, rejected = 0;
};

BoxStatistics boxStatistics(int trials, double shear = 0) {
  const StereoRig rig(false);
  Dice dice(5);
  BoxStatistics out;
  Vector3d squares = Vector3d::Zero();
  double angles = 0;
  for (int i = 0; i < trials; ++i) {
    const auto triad = measured(FeatureKind::kTriad, boxCorners(shear), {&rig.left, &rig.right}, &dice);
    if (!triad.ok()) {
      ADD_FAILURE() << triad.error().message;
      return out;
    }
    squares += (1e3 * (triad->box->size - kSize)).cwiseAbs2();
    out.predicted_mm += 1e3 * triad->box->sizeSigma() / trials;
    angles += std::pow(angleBetween(triad->box->X_WB.linear(), boxAttitude()), 2) / 1.5;
    out.chi2 += triad->box->chi2 / trials;
    out.rejected += (triad->box->is_box ? 0.0 : 1.0) / trials;
  }
  out.rms_mm = (squares / trials).cwiseSqrt();
  out.direction_deg = std::sqrt(angles / trials) / kDegree;
  return out;
}

TEST(Triad, SizesAreAsGoodAsTheTableSays) {
  const auto s = boxStatistics(800);
  const Vector3d table(1.6, 1.25, 1.95);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(s.rms_mm[i], table[i], 0.1 * table[i]) << "edge " << i + 1;
    EXPECT_NEAR(s.predicted_mm[i], s.rms_mm[i], 0.1 * s.rms_mm[i]) << "edge " << i + 1;
    EXPECT_LE(s.rms_mm[i], 2.0) << "edge " << i + 1;
  }
  EXPECT_NEAR(s.direction_deg, 0.45, 0.06);
}

TEST(Triad, TheTestOfRightAnglesIsCalibrated) {
  const auto s = boxStatistics(1200);
  EXPECT_NEAR(s.chi2, 7, 0.35);
  EXPECT_GE(s.rejected, 0.03);
  EXPECT_LE(s.rejected, 0.08);
}

TEST(Triad, AShearOfTenDegreesIsFoundAndMeasuredFreely) {
  EXPECT_GE(boxStatistics(200, 10 * kDegree).rejected, 0.9);
  const StereoRig rig(false);
  const Corners corners = boxCorners(15 * kDegree);
  const auto triad = measured(FeatureKind::kTriad, corners, {&rig.left, &rig.right});
  ASSERT_TRUE(triad.ok()) << triad.error().message;
  EXPECT_FALSE(triad->box->is_box);
  EXPECT_NEAR(triad->box->orthogonality_error, 15 * kDegree, 1e-6);
  ASSERT_FALSE(triad->warnings.empty());
  EXPECT_NE(triad->warnings.back().find("parallelepiped"), std::string::npos) << triad->warnings.back();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((triad->vertices[i].xyz - corners[i]).norm(), 1e-9);
}

// Chi-square stays calibrated, and sizes as uncertain as stated, when the right camera's pose and both lenses are off.
TEST(Triad, CalibrationErrorsAreNotTakenForAShear) {
  StereoRig rig;
  const double pose_sigma = 3e-3, focal_sigma = 4;
  rig.right.pose_covariance.topLeftCorner<3, 3>() = Matrix3d::Identity() * pose_sigma * pose_sigma;
  for (auto* view : {&rig.left, &rig.right}) {
    view->intrinsics_covariance(0, 0) = view->intrinsics_covariance(1, 1) = focal_sigma * focal_sigma;
  }
  Dice dice(21);
  const int trials = 600;
  double chi2 = 0, squares = 0, stated = 0;
  for (int i = 0; i < trials; ++i) {
    View left = rig.left, right = rig.right;
    right.X_WC.linear() = expSO3(dice.normal3(pose_sigma)) * right.X_WC.linear();
    for (auto* view : {&left, &right}) {
      view->camera.fx += dice.normal(focal_sigma);
      view->camera.fy += dice.normal(focal_sigma);
    }
    std::vector<std::vector<Sighting>> vertices;
    for (const auto& corner : boxCorners()) {
      vertices.push_back({{&rig.left, left.project(corner).value() + dice.normal2(0.5), 0},
                          {&rig.right, right.project(corner).value() + dice.normal2(0.5), 0}});
    }
    const auto triad = vision::measureFeature("it", FeatureKind::kTriad, vertices);
    ASSERT_TRUE(triad.ok()) << triad.error().message;
    chi2 += triad->box->chi2 / trials;
    squares += std::pow(triad->box->size[0] - kSize[0], 2) / trials;
    stated += std::pow(triad->box->sizeSigma()[0], 2) / trials;
  }
  EXPECT_NEAR(chi2, 7, 0.6);
  EXPECT_NEAR(std::sqrt(squares / stated), 1, 0.1);
}

void expectRefused(const Corners& corners, const Views& views, const std::string& word) {
  const auto triad = measured(FeatureKind::kTriad, corners, views);
  ASSERT_FALSE(triad.ok()) << "expected a refusal about \"" << word << "\"";
  EXPECT_EQ(triad.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(triad.error().message.find(word), std::string::npos) << triad.error().message;
}

TEST(Triad, DegenerateTriadsAreRefusedWithWhatToDo) {
  const StereoRig rig(false);
  const Views views{&rig.left, &rig.right};
  const Vector3d o(0.05, 0.02, 1.5);
  expectRefused({o, o + Vector3d(0.3, 0, 0.02), o + Vector3d(0.1, 0.2, 0.05), o + Vector3d(-0.2, 0.2, 0.03)}, views, "one plane");
  const Vector3d away = o / o.norm();
  expectRefused({o, o + 0.03 * away, o + Vector3d(0.2, 0, 0), o + Vector3d(0, 0.2, 0)}, views, "points at the camera");
  expectRefused({o, o, o + Vector3d(0.2, 0, 0), o + Vector3d(0, 0.2, 0)}, views, "edge 1");
}

TEST(Triad, TooSmallForItsDistanceIsRefused) {
  StereoRig rig(false);
  for (auto* view : {&rig.left, &rig.right}) view->sigma_px = 14;
  Corners corners = boxCorners();
  for (auto& corner : corners) corner = corners[0] + 0.5 * (corner - corners[0]);
  expectRefused(corners, {&rig.left, &rig.right}, "too short for these views");
}

TEST(Sketch, PicksOffThePictureMakeNoFeature) {
  const StereoRig rig(false);
  auto vertices = std::vector<std::vector<Sighting>>{sightingsOf({&rig.left, &rig.right}, {0, 0, 1.5})};
  vertices[0][1].pixel.x() = -30;
  const auto point = vision::measureFeature("it", FeatureKind::kPoint, vertices);
  ASSERT_FALSE(point.ok());
  EXPECT_EQ(point.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(point.error().message.find("off the picture of view \"right\""), std::string::npos) << point.error().message;
}

TEST(ShapeJson, PlanesAndBoxesReadBackWhatTheyPrint) {
  const StereoRig rig;
  const auto plane = measured(FeatureKind::kPlane, planeCorners(80 * kDegree), {&rig.left, &rig.right});
  const auto triad = measured(FeatureKind::kTriad, boxCorners(), {&rig.left, &rig.right});
  ASSERT_TRUE(plane.ok() && triad.ok());
  const auto plane_json = toJson(*plane), triad_json = toJson(*triad);
  for (const char* key : {"center", "normal", "corners", "angle_error_deg"}) EXPECT_TRUE(plane_json.contains(key)) << key;
  EXPECT_EQ(plane_json["corners"].size(), 4u);
  EXPECT_EQ(triad_json["box"]["pose"]["parent"], "head");
  EXPECT_TRUE(triad_json.contains("orthogonality_error_deg"));
  const auto plane_back = vision::featureFromJson(plane_json), triad_back = vision::featureFromJson(triad_json);
  ASSERT_TRUE(plane_back.ok()) << plane_back.error().message;
  ASSERT_TRUE(triad_back.ok()) << triad_back.error().message;
  EXPECT_LT((plane_back->plane->normal - plane->plane->normal).norm(), 1e-15);
  EXPECT_EQ(plane_back->plane->normal_covariance, plane->plane->normal_covariance);
  EXPECT_EQ(triad_back->box->size, triad->box->size);
  EXPECT_LT((triad_back->box->X_WB.matrix() - triad->box->X_WB.matrix()).norm(), 1e-12);
  auto damaged = triad_json;
  damaged["box"]["size"][1] = -0.2;
  const auto refused = vision::featureFromJson(damaged);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("box.size"), std::string::npos) << refused.error().message;
}

}  // namespace
}  // namespace longarm::tests
