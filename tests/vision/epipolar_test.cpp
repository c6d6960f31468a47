// The epipolar curve against projected points, its clipping and its ticks; paths drawn into pictures.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/vision/stereo_rig.h"
#include "vision/stereo/epipolar.h"
#include "vision/stereo/project_polyline.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using vision::epipolarCurve;
using vision::EpipolarCurve;
using vision::EpipolarOptions;
using vision::View;

double depthIn(const View& view, const Vector3d& p_W) { return (view.X_WC.inverse() * p_W).z(); }

// Largest distance of a polyline from its own chord between the ends.
double sagOf(const EpipolarCurve& curve) {
  const Vector2d a = curve.points.front().pixel, chord = curve.points.back().pixel - a;
  double sag = 0;
  for (const auto& point : curve.points) {
    const Vector2d off = point.pixel - a;
    sag = std::max(sag, std::abs(off.x() * chord.y() - off.y() * chord.x()) / chord.norm());
  }
  return sag;
}

TEST(EpipolarCurve, PassesThroughAThousandProjectedPoints) {
  const StereoRig rig;
  Dice dice(1);
  double worst_px = 0, worst_depth = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 0.3, 15, &dice);
    const auto curve = epipolarCurve(rig.left, rig.left.project(truth).value(), rig.right);
    ASSERT_TRUE(curve.ok()) << curve.error().message;
    const Vector2d pixel = rig.right.project(truth).value();
    const auto nearest = curve->nearest(pixel);
    ASSERT_TRUE(nearest.has_value()) << "case " << i;
    worst_px = std::max(worst_px, (nearest->pixel - pixel).norm());
    worst_depth = std::max(worst_depth, std::abs(1 / nearest->depth - 1 / depthIn(rig.left, truth)));
  }
  EXPECT_LT(worst_px, 0.05);
  EXPECT_LT(worst_depth, 1e-3) << "of inverse depth [1/m]";
}

TEST(EpipolarCurve, LiesInThePictureAndBeforeBothCameras) {
  const StereoRig rig;
  Dice dice(2);
  int visible = 0;
  for (int i = 0; i < 500; ++i) {
    const View turned = viewOf(lensCamera("turned"), dice.normal3(0.5), dice.normal3(0.8));
    const Vector2d pixel(dice.uniform(0, 639), dice.uniform(0, 479));
    const auto curve = epipolarCurve(rig.left, pixel, turned);
    ASSERT_TRUE(curve.ok()) << curve.error().message;
    visible += curve->points.empty() ? 0 : 1;
    const Vector3d ray = rig.left.camera.rayOfPixel(pixel).value();
    for (const auto& point : curve->points) {
      ASSERT_TRUE(turned.camera.containsPixel(point.pixel, 1e-6)) << point.pixel.transpose();
      ASSERT_GE(point.depth, 0.15 - 1e-9);
      ASSERT_LE(point.depth, 20 + 1e-9);
      const Vector3d p_W = rig.left.X_WC * Vector3d(ray * (point.depth / ray.z()));
      ASSERT_GT(depthIn(turned, p_W), 0);
      ASSERT_LT((turned.project(p_W).value() - point.pixel).norm(), 1e-6);
    }
    for (std::size_t k = 1; k < curve->points.size(); ++k) {
      ASSERT_GT(curve->points[k].depth, curve->points[k - 1].depth) << "from near to far";
    }
  }
  EXPECT_GT(visible, 100);
}

TEST(EpipolarCurve, IsClippedWhereThePictureEnds) {
  const StereoRig rig(false);
  const auto curve = epipolarCurve(rig.left, {320, 240}, rig.right);
  ASSERT_TRUE(curve.ok());
  ASSERT_FALSE(curve->points.empty());
  // u = 320 - 800 * 0.25 / z: -0.5 at z = 0.62402 m
  EXPECT_NEAR(curve->points.front().pixel.x(), -0.5, 1e-6);
  EXPECT_NEAR(curve->points.front().depth, 200 / 320.5, 1e-6);
  EXPECT_NEAR(curve->points.back().depth, 20, 1e-9);
  for (const auto& point : curve->points) EXPECT_NEAR(point.pixel.y(), 240, 1e-9);
}

TEST(EpipolarCurve, LeavesThePictureAndComesBackAsASecondPiece) {
  const StereoRig rig;
  // Near the lower edge the lens bends this curve out of the picture and in again.
  const Vector3d truth(3.92713, 3.32453, 9.87229);
  const auto curve = epipolarCurve(rig.left, rig.left.project(truth).value(), rig.right);
  ASSERT_TRUE(curve.ok());
  int pieces = 1;
  for (std::size_t k = 1; k < curve->points.size(); ++k) {
    if (!curve->points[k].begins_piece) continue;
    ++pieces;
    EXPECT_NEAR(curve->points[k - 1].pixel.y(), 479.5, 1e-6);
    EXPECT_NEAR(curve->points[k].pixel.y(), 479.5, 1e-6);
    const Vector2d between = 0.5 * (curve->points[k - 1].pixel + curve->points[k].pixel);
    const Vector2d nearest = curve->nearest(between)->pixel;
    EXPECT_LT(std::min((nearest - curve->points[k - 1].pixel).norm(), (nearest - curve->points[k].pixel).norm()), 1e-9)
        << "nothing in the gap";
  }
  EXPECT_EQ(pieces, 2);
  EXPECT_FALSE(curve->points.front().begins_piece);
  const Vector2d pixel = rig.right.project(truth).value();
  EXPECT_LT((curve->nearest(pixel)->pixel - pixel).norm(), 0.05);
}

TEST(EpipolarCurve, IsEmptyWhereNothingCanBeSeen) {
  const StereoRig rig(false);
  EpipolarOptions near_only;
  near_only.max_depth = 0.3;
  const auto near_curve = epipolarCurve(rig.left, {0, 240}, rig.right, near_only);
  ASSERT_TRUE(near_curve.ok());
  EXPECT_TRUE(near_curve->points.empty() && near_curve->ticks.empty());
  EXPECT_FALSE(near_curve->nearest({3, 4}).has_value());
  const View away = viewOf(pinhole("away"), {0.2, 0, 0}, {0, M_PI, 0});
  const auto back = epipolarCurve(rig.left, {320, 240}, away);
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(back->points.empty());
}

TEST(EpipolarCurve, TicksStandAtRoundDepthsOnTheCurve) {
  const StereoRig rig;
  const auto curve = epipolarCurve(rig.left, {350, 200}, rig.right);
  ASSERT_TRUE(curve.ok());
  ASSERT_GE(curve->ticks.size(), 4u);
  for (const auto& tick : curve->ticks) {
    const double digit = tick.depth / std::pow(10, std::floor(std::log10(tick.depth) + 1e-9));
    EXPECT_TRUE(std::abs(digit - 1) < 1e-9 || std::abs(digit - 2) < 1e-9 || std::abs(digit - 5) < 1e-9) << tick.depth;
    EXPECT_LT((curve->nearest(tick.pixel)->pixel - tick.pixel).norm(), 0.05);
    EXPECT_NEAR(curve->nearest(tick.pixel)->depth, tick.depth, 0.01 * tick.depth);
  }
}

TEST(EpipolarCurve, AStraightLineWouldBeVisiblyWrong) {
  // One lens of k1 = -0.25 bends a long line near the border by pixels.
  vision::CameraModel lens = pinhole("lens");
  lens.fx = lens.fy = 500;
  lens.distortion = {-0.25, 0, 0, 0, 0};
  const View left = viewOf(lens, {0, 0, 0}), right = viewOf(lens, {0.3, 0, 0});
  const auto curve = epipolarCurve(left, left.camera.pixelOfNormalised({0.5, 0.35}), right);
  ASSERT_TRUE(curve.ok());
  const double length = (curve->points.back().pixel - curve->points.front().pixel).norm();
  EXPECT_GT(length, 300);
  EXPECT_GT(sagOf(*curve), 4) << "over " << length << " px";
  const auto straight = epipolarCurve(StereoRig(false).left, {400, 100}, StereoRig(false).right);
  EXPECT_LT(sagOf(*straight), 1e-9);
}

TEST(EpipolarCurve, SkewIsTaken) {
  StereoRig rig;
  rig.left.camera.skew = 12;
  rig.right.camera.skew = -15.7;
  Dice dice(3);
  for (int i = 0; i < 100; ++i) {
    const Vector3d truth = pointSeenByAll({&rig.left, &rig.right}, 0.5, 5, &dice);
    const auto curve = epipolarCurve(rig.left, rig.left.project(truth).value(), rig.right);
    ASSERT_TRUE(curve.ok());
    const Vector2d pixel = rig.right.project(truth).value();
    EXPECT_LT((curve->nearest(pixel)->pixel - pixel).norm(), 0.05);
  }
}

TEST(EpipolarCurve, BadInputIsRefused) {
  StereoRig rig;
  const auto message = [](const Result<EpipolarCurve>& curve) {
    if (curve.ok()) return std::string("drawn");
    EXPECT_EQ(curve.error().code, ErrorCode::kInvalidInput);
    return curve.error().message;
  };
  EXPECT_NE(message(epipolarCurve(rig.left, {1e6, 0}, rig.right)).find("left"), std::string::npos);
  EpipolarOptions options;
  options.min_depth = 3;
  options.max_depth = 2;
  EXPECT_NE(message(epipolarCurve(rig.left, {320, 240}, rig.right, options)).find("3 to 2 m"), std::string::npos);
  options = {};
  options.max_sag_px = 0;
  EXPECT_NE(message(epipolarCurve(rig.left, {320, 240}, rig.right, options)).find("max_sag_px"), std::string::npos);
  rig.right.parent = "wrist";
  EXPECT_NE(message(epipolarCurve(rig.left, {320, 240}, rig.right)).find("wrist"), std::string::npos);
}

TEST(EpipolarCurve, QuickSamplesEqualProjectedPoints) {
  StereoRig rig;
  rig.right.camera.skew = 3;
  const Vector2d pixel(250, 300);
  const Vector3d ray = rig.left.camera.rayOfPixel(pixel).value();
  for (const int n : {2, 3, 64, 127, 128, 129, 300}) {
    const auto size = static_cast<std::size_t>(n);
    std::vector<double> u(size), v(size);
    std::vector<std::uint8_t> visible(size);
    ASSERT_TRUE(sampleEpipolarCurve(rig.left, pixel, rig.right, 0.3, 10, n, u.data(), v.data(),
                                    reinterpret_cast<bool*>(visible.data())));
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const double depth = 1 / (1 / 0.3 + (1 / 10.0 - 1 / 0.3) * i / (n - 1));
      const auto truth = rig.right.project(rig.left.X_WC * Vector3d(ray * (depth / ray.z())));
      ASSERT_EQ(truth.ok(), visible[k] != 0) << "sample " << i << " of " << n;
      if (truth.ok()) {
        EXPECT_LT((*truth - Vector2d(u[k], v[k])).norm(), 1e-9);
      }
    }
  }
  double u[2], v[2];
  bool visible[2];
  EXPECT_FALSE(sampleEpipolarCurve(rig.left, {1e7, 0}, rig.right, 0.3, 10, 2, u, v, visible));
}

TEST(ProjectPolyline, FollowsTheLensAndIsCutBehindTheCamera) {
  const StereoRig rig;
  const std::vector<Vector3d> path = {{-0.5, 0.3, 1}, {0.6, 0.3, 1.5}, {0.2, 0, -1}};
  const auto pieces = vision::projectPolyline(rig.left, path);
  ASSERT_GE(pieces.size(), 1u);
  const auto distanceToPieces = [&](const Vector2d& pixel) {
    double best = 1e9;
    for (const auto& piece : pieces) {
      for (std::size_t i = 1; i < piece.size(); ++i) {
        const Vector2d chord = piece[i] - piece[i - 1];
        const double s = std::clamp((pixel - piece[i - 1]).dot(chord) / std::max(chord.squaredNorm(), 1e-12), 0.0, 1.0);
        best = std::min(best, (piece[i - 1] + s * chord - pixel).norm());
      }
    }
    return best;
  };
  for (int i = 0; i <= 200; ++i) {
    const Vector3d p = path[0] + (path[1] - path[0]) * i / 200.0;
    const auto pixel = rig.left.project(p);
    if (pixel.ok() && rig.left.camera.containsPixel(*pixel)) {
      EXPECT_LT(distanceToPieces(*pixel), 0.26) << "step " << i;
    }
  }
  for (const auto& piece : pieces) {
    for (const auto& pixel : piece) EXPECT_TRUE(rig.left.camera.containsPixel(pixel, 21)) << pixel.transpose();
  }
  EXPECT_TRUE(vision::projectPolyline(rig.left, {{0, 0, -1}, {1, 0, -2}}).empty());
  EXPECT_TRUE(vision::projectPolyline(rig.left, {}).empty());
}

}  // namespace
}  // namespace longarm::tests
