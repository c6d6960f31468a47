// Intrinsics from boards: synthetic truth, honest covariance, bad views, and Bouguet's published calibration.
#include <algorithm>

#include <gtest/gtest.h>

#include "calibration/intrinsics/board_detector.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/corners_file.h"
#include "calibration/intrinsics/coverage.h"
#include "calibration/intrinsics/next_view.h"
#include "tests/calibration/synthetic.h"
#include "tests/support/test_data.h"
#include "vision/snapshot/image_file.h"

namespace longarm::tests {
namespace {

using calibration::BoardView;
using calibration::calibrateIntrinsics;
using calibration::IntrinsicsOptions;
using calibration::IntrinsicsResult;

vision::CameraModel truth() {
  auto camera = cameraOf(533, 530, 341, 236);
  camera.distortion = {-0.28, 0.09, 0.001, -0.0004, 0};
  return camera;
}

bool fits(const BoardView& view) {
  return std::all_of(view.corners.begin(), view.corners.end(), [](const auto& c) {
    return c.pixel.x() > 3 && c.pixel.y() > 3 && c.pixel.x() < 636 && c.pixel.y() < 476;
  });
}

std::vector<BoardView> views(Random* random, const vision::CameraModel& camera, int count, double noise, double tilt = 0.6) {
  std::vector<BoardView> out;
  while (static_cast<int>(out.size()) < count) {
    BoardView view = picture(camera, boardPose(random, tilt), board(), random, noise);
    if (!fits(view)) continue;
    view.name = "view" + std::to_string(out.size());
    out.push_back(view);
  }
  return out;
}

TEST(Intrinsics, NoiseFreeBoardsGiveTheCameraBack) {
  Random random(41);
  const auto found = calibrateIntrinsics(views(&random, truth(), 12, 0), 640, 480);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT((calibration::lensVector(found->camera) - calibration::lensVector(truth())).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(found->rms_px, 1e-8);
}

TEST(Intrinsics, AnAlmostPerfectLensGetsNoDistortion) {
  Random random(42);
  const auto found = calibrateIntrinsics(views(&random, cameraOf(700, 700, 320, 240), 12, 0.2, 0.6), 640, 480);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LE(found->estimated.count(), 5) << "at most one coefficient by chance";
  EXPECT_LT(std::abs(found->camera.fx - 700), 5 * std::sqrt(found->covariance(0, 0)));
}

TEST(Intrinsics, EstimatesExactlyWhatIsAskedFor) {
  Random random(43);
  const auto pictures = views(&random, truth(), 10, 0.1);
  for (const int n : {0, 2, 4, 5}) {
    for (const bool skew : {false, true}) {
      IntrinsicsOptions options;
      options.lens.distortion = n;
      options.lens.skew = skew;
      options.robust = false;
      const auto found = calibrateIntrinsics(pictures, 640, 480, options);
      ASSERT_TRUE(found.ok()) << found.error().message;
      EXPECT_EQ(found->estimated.count(), 4 + n + (skew ? 1 : 0));
      EXPECT_EQ(found->camera.skew != 0, skew);
      for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(found->camera.distortion[i] != 0, static_cast<int>(i) < n);
    }
  }
}

void checkHonesty(int runs, double margin) {
  Random random(44);
  IntrinsicsOptions options;
  options.lens.distortion = 4;
  options.robust = false;
  calibration::LensVector nees = calibration::LensVector::Zero();
  for (int run = 0; run < runs; ++run) {
    const auto found = calibrateIntrinsics(views(&random, truth(), 10, 0.3), 640, 480, options);
    ASSERT_TRUE(found.ok()) << found.error().message;
    const calibration::LensVector error = calibration::lensVector(found->camera) - calibration::lensVector(truth());
    for (const int i : found->estimated.indices()) nees[i] += error[i] * error[i] / found->covariance(i, i) / runs;
  }
  for (int i = 0; i < calibration::kLensParameters; ++i) {
    if (i == calibration::kSkew || i == calibration::kK3) continue;
    EXPECT_NEAR(nees[i], 1, margin) << calibration::lensParameterName(i);
  }
}

TEST(Intrinsics, CovarianceIsHonestInASample) { checkHonesty(150, 0.4); }
TEST(IntrinsicsCampaign, CovarianceIsHonestToTenPercent) { checkHonesty(3000, 0.1); }

TEST(Intrinsics, OneWrongViewDoesNotSpoilTheCamera) {
  Random random(45);
  auto pictures = views(&random, truth(), 12, 0.2);
  for (auto& c : pictures[4].corners) c.pixel += Eigen::Vector2d(random.normal(3), random.normal(3));
  const auto found = calibrateIntrinsics(pictures, 640, 480);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_FALSE(found->views[4].used);
  EXPECT_NE(found->views[4].why, "");
  for (std::size_t k = 0; k < pictures.size(); ++k) EXPECT_EQ(found->views[k].used, k != 4) << k;
  const calibration::LensVector error = calibration::lensVector(found->camera) - calibration::lensVector(truth());
  for (const int i : found->estimated.indices()) EXPECT_LT(std::abs(error[i]), 4 * std::sqrt(found->covariance(i, i))) << i;
}

TEST(Intrinsics, TheOrderOfViewsAndCornersDoesNotMatter) {
  Random random(46);
  auto pictures = views(&random, truth(), 10, 0.3);
  const auto first = calibrateIntrinsics(pictures, 640, 480);
  for (int shuffle = 0; shuffle < 3; ++shuffle) {
    std::shuffle(pictures.begin(), pictures.end(), random.engine());
    for (auto& view : pictures) std::shuffle(view.corners.begin(), view.corners.end(), random.engine());
    const auto again = calibrateIntrinsics(pictures, 640, 480);
    ASSERT_TRUE(first.ok() && again.ok());
    const calibration::LensVector a = calibration::lensVector(first->camera), b = calibration::lensVector(again->camera);
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(Intrinsics, SquareViewsAndASingleOneAreRefusedInASentence) {
  Random random(47);
  std::vector<BoardView> square;
  for (int i = 0; i < 12; ++i) {
    const Pose X = poseOf({0, 0, 0}, {random.uniform(-0.2, -0.05), random.uniform(-0.12, -0.04), random.uniform(0.5, 0.7)});
    square.push_back(picture(truth(), X, board(), &random, 0.2));
  }
  const auto flat = calibrateIntrinsics(square, 640, 480);
  ASSERT_FALSE(flat.ok()) << flat->camera.fx << " +- " << std::sqrt(flat->covariance(0, 0));
  EXPECT_EQ(flat.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(flat.error().message.find("tilted"), std::string::npos) << flat.error().message;
  const auto one = calibrateIntrinsics(views(&random, truth(), 1, 0.2), 640, 480);
  ASSERT_FALSE(one.ok());
  EXPECT_EQ(one.error().code, ErrorCode::kDegenerate);
  EXPECT_FALSE(calibrateIntrinsics({}, 640, 480).ok());
}

TEST(Intrinsics, FewAndSimilarViewsAreWarnedOf) {
  Random random(48);
  const auto few = calibrateIntrinsics(views(&random, truth(), 4, 0.1), 640, 480);
  ASSERT_TRUE(few.ok()) << few.error().message;
  EXPECT_FALSE(few->warnings.empty());
}

TEST(Intrinsics, APixelOutsideThePictureNamesViewAndLine) {
  Random random(49);
  auto pictures = views(&random, truth(), 4, 0.1);
  pictures[2].corners[7].pixel.x() = 700;
  const auto found = calibrateIntrinsics(pictures, 640, 480);
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(found.error().message.find("line 9"), std::string::npos) << found.error().message;
  EXPECT_NE(found.error().message.find("view2"), std::string::npos) << found.error().message;
}

TEST(Intrinsics, TheNextViewIsInThePictureAndTeachesMost) {
  Random random(50);
  const auto pictures = views(&random, truth(), 6, 0.2, 0.15);
  const auto found = calibrateIntrinsics(pictures, 640, 480);
  ASSERT_TRUE(found.ok()) << found.error().message;
  const auto next = calibration::nextView(pictures, *found);
  ASSERT_TRUE(next.has_value());
  EXPECT_GT(next->gain_bits, 1);
  ASSERT_EQ(next->outline_px.size(), 4u);
  for (const auto& p : next->outline_px) EXPECT_TRUE(found->camera.containsPixel(p));
  auto more = pictures;
  BoardView advised = picture(truth(), next->X_CK, board(), &random, 0.2);
  advised.name = "advised";
  more.push_back(advised);
  const auto better = calibrateIntrinsics(more, 640, 480);
  ASSERT_TRUE(better.ok());
  EXPECT_LT(better->covariance(0, 0), found->covariance(0, 0));
}

// Pictures of one side, found with a half-window (0: chosen).
std::vector<BoardView> realViews(const std::string& side, int half_window) {
  calibration::BoardSpec spec;
  spec.square = 0.03;
  spec.half_window = half_window;
  std::vector<BoardView> out;
  for (const char* number : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14"}) {
    const auto image = vision::loadImage(dataFolder() + "/opencv_stereo_chess/" + side + number + ".jpg");
    if (!image) continue;
    auto view = calibration::detectBoard(*image, spec, side + number);
    if (view) out.push_back(*view);
  }
  return out;
}

// Bouguet's published values and 3 sigma: fc, cc, kc (k1 k2 p1 p2).
struct Published {
  double fc[2], fc3[2], cc[2], cc3[2];
};

void expectPublished(const IntrinsicsResult& found, const Published& p) {
  EXPECT_NEAR(found.camera.fx, p.fc[0], p.fc3[0]);
  EXPECT_NEAR(found.camera.fy, p.fc[1], p.fc3[1]);
  EXPECT_NEAR(found.camera.cx, p.cc[0], p.cc3[0]);
  EXPECT_NEAR(found.camera.cy, p.cc[1], p.cc3[1]);
}

const Published kLeft = {{533.00371, 533.15260}, {1.07629, 1.10913}, {341.58612, 234.25940}, {1.24041, 1.33065}};
const Published kRight = {{536.98262, 536.56938}, {1.19786, 1.15677}, {326.47209, 249.33257}, {1.36588, 1.34252}};

TEST(RealPictures, BothCamerasAreWithinBouguetsThreeSigma) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto left = realViews("left", 0), right = realViews("right", 0);
  ASSERT_EQ(left.size(), 13u);
  ASSERT_EQ(right.size(), 13u);
  const auto a = calibrateIntrinsics(left, 640, 480), b = calibrateIntrinsics(right, 640, 480);
  ASSERT_TRUE(a.ok() && b.ok());
  expectPublished(*a, kLeft);
  expectPublished(*b, kRight);
  const double left_kc[4] = {-0.28947, 0.10326, 0.00103, -0.00029}, right_kc[4] = {-0.28936, 0.10677, -0.00078, 0.00020};
  const double three_sigma[4] = {0.006, 0.03, 0.0006, 0.0007};  // ours: the page gives none for kc
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(a->camera.distortion[i], left_kc[i], three_sigma[i]) << i;
    EXPECT_NEAR(b->camera.distortion[i], right_kc[i], three_sigma[i]) << i;
  }
  EXPECT_LT(a->rms_px * std::sqrt(2.0), 0.21);
  EXPECT_LT(b->rms_px * std::sqrt(2.0), 0.21);
}

TEST(RealPictures, AWindowThatReachesTheNeighboursIsFlaggedAndDoesNoHarm) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto found = calibrateIntrinsics(realViews("left", 11), 640, 480);
  ASSERT_TRUE(found.ok()) << found.error().message;
  expectPublished(*found, kLeft);
  ASSERT_GE(found->views.size(), 2u);
  EXPECT_EQ(found->views[1].name, "left02");
  EXPECT_TRUE(!found->views[1].used || found->views[1].outliers >= 3) << found->views[1].outliers;
  EXPECT_NE(found->views[1].why, "");
  IntrinsicsOptions plain;
  plain.robust = false;
  const auto spoiled = calibrateIntrinsics(realViews("left", 11), 640, 480, plain);
  ASSERT_TRUE(spoiled.ok());
  EXPECT_GT(spoiled->views[1].rms_px, 3 * found->rms_px) << "the trap is real";
}

TEST(CornersFile, KeepsViewsInOrderAndNamesFaults) {
  const auto two = calibration::parseCorners("view,x,y,z,u,v\nb,0,0,0,1,2\na,0,0,0,3,4\nb,1,0,0,5,6\n", "c.csv");
  ASSERT_TRUE(two.ok());
  ASSERT_EQ(two->size(), 2u);
  EXPECT_EQ((*two)[0].name, "b");
  EXPECT_EQ((*two)[0].corners.size(), 2u);
  const auto bad = calibration::parseCorners("view,x,y,z,u,v\nb,0,0,nan,1,2\n", "c.csv");
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().message.find("c.csv: line 2: column z"), std::string::npos) << bad.error().message;
}

}  // namespace
}  // namespace longarm::tests
