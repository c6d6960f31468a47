// The camera model against OpenCV, against itself, and at the edge of its range.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "tests/vision/stereo_rig.h"
#include "vision/camera/camera_model.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::CameraModel;

constexpr double kPixelTol = 1e-9;   // two formulas of the same model, no iteration

CameraModel randomCamera(Dice* dice) {
  CameraModel camera = lensCamera();
  camera.fx = dice->uniform(300, 3000);
  camera.fy = camera.fx * dice->uniform(0.95, 1.05);
  camera.cx = dice->uniform(250, 390);
  camera.cy = dice->uniform(180, 300);
  camera.distortion = {dice->uniform(-0.35, 0.2), dice->uniform(-0.1, 0.15), dice->uniform(-0.003, 0.003),
                       dice->uniform(-0.003, 0.003), dice->uniform(-0.02, 0.02)};
  return camera;
}

Vector2d byOpenCv(const CameraModel& camera, const Vector3d& p) {
  const auto& d = camera.distortion;
  const cv::Matx33d K(camera.fx, camera.skew, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Mat coefficients = (cv::Mat_<double>(1, 5) << d[0], d[1], d[2], d[3], d[4]);
  const std::vector<cv::Point3d> points = {{p.x(), p.y(), p.z()}};
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(), cv::Vec3d(), K, coefficients, pixels);
  return {pixels[0].x, pixels[0].y};
}

// Normalised coordinates well inside the monotone range.
Vector2d insideRange(const CameraModel& camera, Dice* dice, double share = 0.9) {
  const double limit = share * std::min(camera.monotoneRadius(), 0.7);
  const double angle = dice->uniform(-M_PI, M_PI), radius = limit * std::sqrt(dice->uniform(0, 1));
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

TEST(CameraModel, EqualsOpenCvWithoutSkew) {
  Dice dice(1);
  for (int i = 0; i < 1000; ++i) {
    const CameraModel camera = randomCamera(&dice);
    const Vector2d n = insideRange(camera, &dice);
    const double z = dice.uniform(0.2, 10);
    const Vector3d p(n.x() * z, n.y() * z, z);
    const auto pixel = camera.project(p);
    ASSERT_TRUE(pixel.ok()) << pixel.error().message;
    EXPECT_LT((*pixel - byOpenCv(camera, p)).norm(), kPixelTol) << "case " << i;
  }
}

TEST(CameraModel, TheReportsPrintedYRowWouldBeOffByAPixel) {
  CameraModel camera = lensCamera();
  camera.fx = camera.fy = 800;
  camera.distortion = {0, 0, 0.002, -0.001, 0};
  const Vector2d n(0.4, 0.3);
  const double r2 = n.squaredNorm(), p2 = camera.distortion[3];
  const double as_printed = n.y() + 2 * p2 * n.x() * n.y() + p2 * (r2 + 2 * n.x() * n.x());
  const double ours = camera.distort(n).y();
  EXPECT_NEAR(800 * std::abs(ours - as_printed), 1.14, 0.01);
}

TEST(CameraModel, SkewMovesTheColumnByTheDistortedRow) {
  CameraModel camera = lensCamera();
  const Vector2d straight = camera.pixelOfNormalised({0.2, -0.3});
  camera.skew = -15.7;
  const Vector2d skewed = camera.pixelOfNormalised({0.2, -0.3});
  EXPECT_NEAR(skewed.x() - straight.x(), -15.7 * camera.distort({0.2, -0.3}).y(), 1e-12);
  EXPECT_EQ(skewed.y(), straight.y());
  EXPECT_EQ(camera.K()(0, 1), -15.7);
}

TEST(CameraModel, RayOfAPixelProjectsBackToIt) {
  Dice dice(2);
  for (int i = 0; i < 2000; ++i) {
    CameraModel camera = randomCamera(&dice);
    camera.skew = dice.uniform(-20, 20);
    const Vector2d n = insideRange(camera, &dice, 0.98);
    const Vector2d pixel = camera.pixelOfNormalised(n);
    const auto back = camera.normalisedOfPixel(pixel);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_LT((camera.pixelOfNormalised(*back) - pixel).norm(), kPixelTol) << "case " << i;
    const auto ray = camera.rayOfPixel(pixel);
    ASSERT_TRUE(ray.ok());
    EXPECT_NEAR(ray->norm(), 1, 1e-12);
    EXPECT_LT((camera.project(3.7 * *ray).value() - pixel).norm(), kPixelTol);
  }
}

TEST(CameraModel, EveryPixelOfThePictureHasARay) {
  const CameraModel camera = lensCamera();
  for (int v = 0; v < camera.height; v += 7) {
    for (int u = 0; u < camera.width; u += 7) {
      EXPECT_TRUE(camera.rayOfPixel({u, v}).ok()) << u << ", " << v;
    }
  }
}

TEST(CameraModel, JacobianEqualsDifferences) {
  Dice dice(3);
  for (int i = 0; i < 200; ++i) {
    CameraModel camera = randomCamera(&dice);
    camera.skew = dice.uniform(-20, 20);
    const Vector2d n = insideRange(camera, &dice, 0.8);
    const Vector3d p(n.x() * 2, n.y() * 2, 2);
    const auto at = camera.projectWithJacobian(p);
    ASSERT_TRUE(at.ok());
    EXPECT_LT((at->pixel - camera.project(p).value()).norm(), 1e-12);
    const double h = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = h * Vector3d::Unit(axis);
      const Vector2d slope = (camera.project(p + step).value() - camera.project(p - step).value()) / (2 * h);
      EXPECT_LT((slope - at->d_point.col(axis)).norm(), 1e-6 * (1 + slope.norm())) << "axis " << axis;
    }
  }
}

TEST(CameraModel, MonotoneRadiusIsTheFirstRootOfTheSlope) {
  CameraModel camera = lensCamera();
  camera.distortion = {-0.4, 0, 0, 0, 0};
  EXPECT_NEAR(camera.monotoneRadius(), 0.9129, 1e-4);      // 1 / sqrt(1.2)
  camera.distortion = {0.1, 0.05, 0, 0, 0};
  EXPECT_EQ(camera.monotoneRadius(), std::numeric_limits<double>::infinity());
  Dice dice(4);
  for (int i = 0; i < 500; ++i) {
    camera.distortion = {dice.uniform(-0.6, 0.3), dice.uniform(-0.4, 0.4), 0, 0, i % 2 == 0 ? 0 : dice.uniform(-0.3, 0.3)};
    const auto& d = camera.distortion;
    const auto slope = [&](double r) {
      const double s = r * r;
      return 1 + s * (3 * d[0] + s * (5 * d[1] + s * 7 * d[4]));
    };
    const double radius = camera.monotoneRadius();
    const double end = std::isfinite(radius) ? radius : 20;
    for (int k = 0; k < 400; ++k) EXPECT_GT(slope(end * k / 400), 0) << "case " << i;
    if (std::isfinite(radius)) {
      EXPECT_NEAR(slope(radius), 0, 1e-9) << "case " << i;
    }
  }
}

TEST(CameraModel, PointsBehindOrBeyondTheLensAreRefusedWithTheirValue) {
  CameraModel camera = lensCamera("left");
  const auto behind = camera.project({0.1, 0.1, -0.5});
  ASSERT_FALSE(behind.ok());
  EXPECT_EQ(behind.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(behind.error().message.find("behind camera \"left\""), std::string::npos) << behind.error().message;
  EXPECT_NE(behind.error().message.find("-0.5"), std::string::npos) << behind.error().message;
  camera.distortion = {-0.4, 0, 0, 0, 0};
  const auto beyond = camera.project({2, 0, 1});
  ASSERT_FALSE(beyond.ok());
  EXPECT_NE(beyond.error().message.find("0.913"), std::string::npos) << beyond.error().message;
  const auto no_ray = camera.rayOfPixel({100000, 240});
  ASSERT_FALSE(no_ray.ok());
  EXPECT_EQ(no_ray.error().code, ErrorCode::kDegenerate);
  EXPECT_FALSE(camera.project({std::nan(""), 0, 1}).ok());
  EXPECT_FALSE(camera.rayOfPixel({std::nan(""), 0}).ok());
}

TEST(CameraModel, TheRangesEdgeHasARayAndNothingBeyondIt) {
  CameraModel camera = pinhole();
  camera.distortion = {-0.4, 0, 0, 0, 0};
  const double radius = camera.monotoneRadius();
  const double edge = camera.pixelOfNormalised({radius, 0}).x();
  const auto inside = camera.rayOfPixel({edge - 1e-3, camera.cy});
  ASSERT_TRUE(inside.ok()) << inside.error().message;
  EXPECT_LT((camera.project(*inside).value() - Vector2d(edge - 1e-3, camera.cy)).norm(), 1e-6);
  EXPECT_FALSE(camera.rayOfPixel({edge + 1e-3, camera.cy}).ok());
}

TEST(CameraModel, PictureBordersAreHalfAPixelOut) {
  const CameraModel camera = lensCamera();
  EXPECT_TRUE(camera.containsPixel({-0.5, 479.5}));
  EXPECT_FALSE(camera.containsPixel({-0.51, 0}));
  EXPECT_TRUE(camera.containsPixel({-5, 0}, 5));
  EXPECT_FALSE(camera.containsPixel({std::nan(""), 0}));
}

TEST(CameraModel, ValidationNamesTheFieldAndItsValue) {
  const auto reason = [](auto change) {
    CameraModel camera = lensCamera("left");
    change(camera);
    const auto status = validate(camera);
    return status.ok() ? std::string("valid") : status.error().message;
  };
  EXPECT_EQ(reason([](CameraModel&) {}), "valid");
  const std::string focal = reason([](CameraModel& c) { c.fx = -3.5; });
  EXPECT_NE(focal.find("fx is -3.5"), std::string::npos) << focal;
  EXPECT_NE(reason([](CameraModel& c) { c.fy = std::nan(""); }).find("fy"), std::string::npos);
  EXPECT_NE(reason([](CameraModel& c) { c.skew = 1e4; }).find("skew is 10000"), std::string::npos);
  EXPECT_NE(reason([](CameraModel& c) { c.cx = 1e9; }).find("cx"), std::string::npos);
  EXPECT_NE(reason([](CameraModel& c) { c.distortion[4] = INFINITY; }).find("k3"), std::string::npos);
  EXPECT_NE(reason([](CameraModel& c) { c.width = 70000; }).find("image_width is 70000"), std::string::npos);
}

}  // namespace
}  // namespace longarm::tests
