// Stereo pairs and comparisons of calibrations.
#include <algorithm>

#include <gtest/gtest.h>

#include "calibration/intrinsics/board_detector.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/compare_cameras.h"
#include "calibration/intrinsics/stereo_pair.h"
#include "tests/calibration/synthetic.h"
#include "tests/support/test_data.h"
#include "vision/snapshot/image_file.h"

namespace longarm::tests {
namespace {

using calibration::BoardPair;
using calibration::calibrateStereo;
using calibration::StereoOptions;

const Pose kRightFromLeft = poseOf({0.0067, 0.0045, -0.0035}, {-0.0998, 0.0011, 0.0001});

vision::CameraModel lens(double fx, double cx) {
  auto camera = cameraOf(fx, fx - 1, cx, 240);
  camera.distortion = {-0.28, 0.09, 0.001, -0.0003, 0};
  return camera;
}

std::vector<BoardPair> pairsOf(Random* random, int count, double noise) {
  std::vector<BoardPair> out;
  for (int k = 0; k < count; ++k) {
    const Pose X_LK = poseOf({0, 0, 0}, {0.04, 0, 0}) * boardPose(random, 0.5, 0.7);
    BoardPair pair{picture(lens(533, 341), X_LK, board(), random, noise), picture(lens(537, 327), kRightFromLeft * X_LK, board(), random, noise)};
    pair.left.name = "left" + std::to_string(k);
    pair.right.name = "right" + std::to_string(k);
    out.push_back(pair);
  }
  return out;
}

vision::CameraFile fileOf(const vision::CameraModel& camera) { return {camera, {}, {}}; }

TEST(Stereo, NoiseFreePairsGiveThePoseBackWhateverEndTheNumberingStarts) {
  Random random(91);
  auto pairs = pairsOf(&random, 8, 0);
  for (const std::size_t k : {1u, 4u}) {
    auto& corners = pairs[k].right.corners;
    const auto original = corners;
    for (std::size_t i = 0; i < corners.size(); ++i) corners[i].xyz = original[corners.size() - 1 - i].xyz;
  }
  const auto found = calibrateStereo(pairs, fileOf(lens(533, 341)), fileOf(lens(537, 327)));
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT((found->X_LR.matrix() - kRightFromLeft.inverse().matrix()).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(found->rms_px, 1e-7);
}

TEST(Stereo, CovarianceIsHonestAndAMovedPairIsLeftOut) {
  Random random(92);
  Vector6d nees = Vector6d::Zero();
  const int runs = 60;
  for (int run = 0; run < runs; ++run) {
    const auto found = calibrateStereo(pairsOf(&random, 6, 0.3), fileOf(lens(533, 341)), fileOf(lens(537, 327)));
    ASSERT_TRUE(found.ok());
    const Pose truth = kRightFromLeft.inverse();
    Vector6d e;
    e << logSO3(found->X_LR.linear() * truth.linear().transpose()), found->X_LR.translation() - truth.translation();
    nees += e.cwiseAbs2().cwiseQuotient(found->covariance.diagonal()) / runs;
  }
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(nees[i], 1, 0.55) << i;
  auto pairs = pairsOf(&random, 8, 0.3);
  for (auto& c : pairs[3].right.corners) c.pixel += Eigen::Vector2d(6, -9);
  const auto found = calibrateStereo(pairs, fileOf(lens(533, 341)), fileOf(lens(537, 327)));
  ASSERT_TRUE(found.ok());
  EXPECT_FALSE(found->pairs[3].used);
  EXPECT_NE(found->pairs[3].why, "");
  EXPECT_LT((found->X_LR.translation() - kRightFromLeft.inverse().translation()).norm(), 1e-3);
}

TEST(Stereo, TheOrderOfPairsAndCornersDoesNotMatter) {
  Random random(93);
  auto pairs = pairsOf(&random, 6, 0.3);
  for (const bool refine : {false, true}) {
    StereoOptions options;
    options.refine = refine;
    const auto first = calibrateStereo(pairs, fileOf(lens(533, 341)), fileOf(lens(537, 327)), options);
    ASSERT_TRUE(first.ok()) << first.error().message;
    for (int shuffle = 0; shuffle < 3; ++shuffle) {
      std::shuffle(pairs.begin(), pairs.end(), random.engine());
      for (auto& pair : pairs) {
        std::shuffle(pair.left.corners.begin(), pair.left.corners.end(), random.engine());
        std::shuffle(pair.right.corners.begin(), pair.right.corners.end(), random.engine());
      }
      const auto again = calibrateStereo(pairs, fileOf(lens(533, 341)), fileOf(lens(537, 327)), options);
      ASSERT_TRUE(again.ok()) << again.error().message;
      EXPECT_LT((again->X_LR.matrix() - first->X_LR.matrix()).cwiseAbs().maxCoeff(), 1e-6);
    }
  }
}

TEST(Stereo, NothingSeenByBothIsRefused) {
  EXPECT_FALSE(calibrateStereo({}, fileOf(lens(533, 341)), fileOf(lens(537, 327))).ok());
}

std::vector<calibration::BoardView> realViews(const std::string& side) {
  calibration::BoardSpec spec;
  spec.square = 0.03;
  std::vector<calibration::BoardView> out;
  for (const char* number : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14"}) {
    const auto image = vision::loadImage(dataFolder() + "/opencv_stereo_chess/" + side + number + ".jpg");
    if (!image) continue;
    auto view = calibration::detectBoard(*image, spec, side + number);
    if (view) out.push_back(*view);
  }
  return out;
}

TEST(RealStereo, IntrinsicsAndPoseAreWithinBouguetsThreeSigma) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto left = realViews("left"), right = realViews("right");
  ASSERT_EQ(left.size(), 13u);
  ASSERT_EQ(right.size(), 13u);
  const auto a = calibration::calibrateIntrinsics(left, 640, 480), b = calibration::calibrateIntrinsics(right, 640, 480);
  ASSERT_TRUE(a.ok() && b.ok());
  std::vector<BoardPair> pairs;
  for (std::size_t k = 0; k < left.size(); ++k) pairs.push_back({left[k], right[k]});
  for (const bool refine : {false, true}) {
    StereoOptions options;
    options.refine = refine;
    const auto found = calibrateStereo(pairs, {a->camera, {}, Eigen::MatrixXd(a->covariance)}, {b->camera, {}, Eigen::MatrixXd(b->covariance)}, options);
    ASSERT_TRUE(found.ok()) << found.error().message;
    const Pose T_RL = found->X_LR.inverse();
    const Eigen::Vector3d om = logSO3(T_RL.linear()), t = 1e3 * T_RL.translation();
    std::printf("refine %d: om %.5f %.5f %.5f  T %.3f %.3f %.3f mm  rms %.3f px per point, used %d\n", refine, om.x(), om.y(), om.z(), t.x(), t.y(), t.z(),
                std::sqrt(2.0) * found->rms_px, static_cast<int>(std::count_if(found->pairs.begin(), found->pairs.end(), [](const auto& p) { return p.used; })));
    EXPECT_NEAR(om.x(), 0.00669, 0.00270);
    EXPECT_NEAR(om.y(), 0.00452, 0.00308);
    EXPECT_NEAR(om.z(), -0.00350, 0.00029);
    EXPECT_NEAR(t.x(), -99.80198, 0.142);
    EXPECT_NEAR(t.y(), 1.12443, 0.114);
    EXPECT_NEAR(t.z(), 0.05041, 0.498);
    if (!refine) continue;
    EXPECT_NEAR(found->left.fx, 533.52331, 0.831);
    EXPECT_NEAR(found->left.fy, 533.52699, 0.841);
    EXPECT_NEAR(found->left.cx, 341.60376, 1.239);
    EXPECT_NEAR(found->left.cy, 235.19287, 1.205);
    EXPECT_NEAR(found->right.fx, 536.81377, 0.876);
    EXPECT_NEAR(found->right.fy, 536.47649, 0.865);
    EXPECT_NEAR(found->right.cx, 326.28657, 1.314);
    EXPECT_NEAR(found->right.cy, 250.10121, 1.166);
  }
}

TEST(Compare, TheSameCameraDiffersByNothing) {
  const auto same = calibration::compareCameras(fileOf(lens(533, 341)), fileOf(lens(533, 341)), 1);
  ASSERT_TRUE(same.ok()) << same.error().message;
  EXPECT_LT(same->max_px, 1e-9);
  EXPECT_EQ(static_cast<int>(same->map.size()), same->columns * same->rows);
}

TEST(Compare, AShiftedPrincipalPointIsPixelsAndMillimetres) {
  auto a = cameraOf(500, 500, 320, 240), b = a;
  b.cx += 5;
  const auto found = calibration::compareCameras(fileOf(a), fileOf(b), 2);
  ASSERT_TRUE(found.ok());
  EXPECT_NEAR(found->rms_px, 5, 1e-9);
  EXPECT_NEAR(found->max_mm, 20, 1e-6) << "5 px of f = 500 at 2 m";
  EXPECT_NEAR(found->turn.y(), -0.01, 2.5e-3);
  EXPECT_LT(found->after_turn_rms_px, 2) << "a turn explains most of it";
}

TEST(Compare, SizesAndFramesMustAgree) {
  const auto small = calibration::compareCameras(fileOf(cameraOf(500, 500, 160, 120, 320, 240)), fileOf(cameraOf(500, 500, 320, 240)), 1);
  ASSERT_FALSE(small.ok());
  EXPECT_NE(small.error().message.find("320 x 240"), std::string::npos) << small.error().message;
  EXPECT_FALSE(calibration::compareCameras(fileOf(lens(533, 341)), fileOf(lens(533, 341)), 1, true).ok());
  EXPECT_FALSE(calibration::compareCameras(fileOf(lens(533, 341)), fileOf(lens(533, 341)), -1).ok());
}

}  // namespace
}  // namespace longarm::tests
