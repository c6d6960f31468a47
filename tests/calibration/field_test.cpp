// What the operator's wizards rest on: uncertainty over the picture, plumb lines, dots, fixture files, boards of all kinds.
#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/fixture/dot_finder.h"
#include "calibration/intrinsics/board_detector.h"
#include "calibration/intrinsics/calibrate_intrinsics.h"
#include "calibration/intrinsics/lens_uncertainty.h"
#include "calibration/intrinsics/plumb_line.h"
#include "tests/calibration/synthetic.h"
#include "tests/support/test_data.h"
#include "vision/snapshot/image_file.h"

namespace longarm::tests {
namespace {

using calibration::BoardKind;
using calibration::BoardSpec;
using calibration::Dot;
using calibration::DotMatch;
using calibration::Fixture;
using calibration::PlumbLine;

vision::CameraModel lens() {
  auto camera = cameraOf(533, 530, 331, 236);
  camera.distortion = {-0.28, 0.09, 0.001, -0.0004, 0};
  return camera;
}

// ---- uncertainty -------------------------------------------------------------------------------------------------

TEST(LensUncertainty, IsWhatRepeatedCalibrationsShow) {
  Random random(71);
  calibration::IntrinsicsOptions options;
  options.lens.distortion = 4;
  options.robust = false;
  const auto once = [&] {
    std::vector<calibration::BoardView> views;
    while (views.size() < 10) {
      auto view = picture(lens(), boardPose(&random), board(), &random, 0.3);
      if (std::all_of(view.corners.begin(), view.corners.end(), [](const auto& c) { return lens().containsPixel(c.pixel, -2); })) views.push_back(view);
    }
    return calibration::calibrateIntrinsics(views, 640, 480, options);
  };
  const int runs = 60;
  std::vector<double> squares(35, 0), predicted(35, 0);
  for (int run = 0; run < runs; ++run) {
    const auto found = once();
    ASSERT_TRUE(found.ok()) << found.error().message;
    const auto map = calibration::lensUncertainty(found->camera, found->covariance, 7, 5);
    ASSERT_TRUE(map.ok()) << map.error().message;
    // Where the truth sees the rays of the found camera, the best turn taken out by least squares.
    Eigen::MatrixXd A(70, 3);
    Eigen::VectorXd b(70);
    for (int i = 0; i < 35; ++i) {
      const Eigen::Vector2d n = lens().normalisedOfPixel(map->pixels[static_cast<std::size_t>(i)]).value();
      calibration::LensProjection at;
      ASSERT_TRUE(calibration::projectWithDerivatives(lens(), n.homogeneous(), &at));
      A.block<2, 3>(2 * i, 0) = at.d_point * -skew(n.homogeneous());
      b.segment<2>(2 * i) = found->camera.pixelOfNormalised(n) - map->pixels[static_cast<std::size_t>(i)];
    }
    const Eigen::VectorXd left = b - A * A.colPivHouseholderQr().solve(b);
    for (int i = 0; i < 35; ++i) {
      squares[static_cast<std::size_t>(i)] += left.segment<2>(2 * i).squaredNorm() / 2 / runs;
      predicted[static_cast<std::size_t>(i)] += map->sigma_px[static_cast<std::size_t>(i)] * map->sigma_px[static_cast<std::size_t>(i)] / runs;
    }
  }
  double ratio = 0;
  for (std::size_t i = 0; i < 35; ++i) ratio += squares[i] / predicted[i] / 35;
  EXPECT_NEAR(ratio, 1, 0.3) << "mean squared error over its prediction";
}

TEST(LensUncertainty, RefusesACameraWithoutSize) {
  EXPECT_FALSE(calibration::lensUncertainty(cameraOf(500, 500, 320, 240, 0, 0), calibration::LensMatrix::Zero()).ok());
}

// ---- plumb lines -------------------------------------------------------------------------------------------------

std::vector<PlumbLine> straightEdges(const vision::CameraModel& camera, Random* random, double noise) {
  std::vector<PlumbLine> out;
  const double ends[6][4] = {{-0.5, -0.38, 0.5, -0.36}, {-0.5, 0.38, 0.5, 0.35}, {-0.5, -0.36, -0.48, 0.36}, {0.5, -0.36, 0.52, 0.36}, {-0.5, 0.2, 0.4, -0.38}, {-0.3, 0.38, 0.5, 0.1}};
  for (const auto& e : ends) {
    PlumbLine line;
    for (int i = 0; i <= 12; ++i) {
      const Eigen::Vector2d n(e[0] + (e[2] - e[0]) * i / 12, e[1] + (e[3] - e[1]) * i / 12);
      line.push_back(camera.pixelOfNormalised(n) + Eigen::Vector2d(random->normal(noise), random->normal(noise)));
    }
    out.push_back(line);
  }
  return out;
}

TEST(PlumbLine, FindsTheDistortionFromStraightEdges) {
  Random random(72);
  vision::CameraModel start = lens();
  start.distortion = {};
  auto truth = lens();
  truth.distortion[2] = truth.distortion[3] = 0;
  const auto found = calibration::straightenLines(start, straightEdges(truth, &random, 0), 2);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_NEAR(found->camera.distortion[0], -0.28, 1e-4);
  EXPECT_NEAR(found->camera.distortion[1], 0.09, 1e-3);
  EXPECT_GT(found->rms_before_px, 1);
  EXPECT_LT(found->rms_px, 1e-3);
}

TEST(PlumbLine, NoisyClicksStayWithinFourSigmaAndAreToldHonestly) {
  Random random(73);
  vision::CameraModel start = lens();
  start.distortion = {};
  double nees = 0;
  const int runs = 60;
  for (int run = 0; run < runs; ++run) {
    auto truth = lens();
    truth.distortion[2] = truth.distortion[3] = 0;
    const auto found = calibration::straightenLines(start, straightEdges(truth, &random, 0.5), 1);
    ASSERT_TRUE(found.ok()) << found.error().message;
    nees += found->sigma_px * found->sigma_px / 0.25 / runs;
  }
  EXPECT_NEAR(nees, 1, 0.25) << "noise of a point across its line";
}

TEST(PlumbLine, TooFewPointsAndLinesThroughTheMiddleAreRefusedInASentence) {
  vision::CameraModel camera = cameraOf(500, 500, 320, 240);
  const auto few = calibration::straightenLines(camera, {{{10, 10}, {200, 12}}}, 1);
  ASSERT_FALSE(few.ok());
  EXPECT_NE(few.error().message.find("three or more"), std::string::npos) << few.error().message;
  const auto middle = calibration::straightenLines(camera, {{{20, 240}, {320, 240}, {620, 240}, {420, 240}}, {{320, 20}, {320, 240}, {320, 460}, {320, 300}}}, 1);
  ASSERT_FALSE(middle.ok());
  EXPECT_EQ(middle.error().code, ErrorCode::kDegenerate);
  EXPECT_FALSE(calibration::straightenLines(camera, {}, 3).ok());
}

// ---- dots and fixtures -------------------------------------------------------------------------------------------

// Discs of 8 x 8 samples a pixel, so that their centres are exact.
cv::Mat dotsAt(const std::vector<Eigen::Vector2d>& centres, double radius) {
  cv::Mat image(480, 640, CV_32F, cv::Scalar(220));
  for (const auto& c : centres) {
    const int reach = static_cast<int>(radius) + 3, u0 = static_cast<int>(std::lround(c.x())), v0 = static_cast<int>(std::lround(c.y()));
    for (int v = std::max(0, v0 - reach); v <= std::min(479, v0 + reach); ++v) {
      for (int u = std::max(0, u0 - reach); u <= std::min(639, u0 + reach); ++u) {
        int inside = 0;
        for (int s = 0; s < 64; ++s) inside += std::hypot(u - 0.4375 + 0.125 * (s % 8) - c.x(), v - 0.4375 + 0.125 * (s / 8) - c.y()) < radius ? 1 : 0;
        image.at<float>(v, u) = std::min(image.at<float>(v, u), 220.0F - 190.0F * static_cast<float>(inside) / 64);
      }
    }
  }
  cv::GaussianBlur(image, image, {5, 5}, 0.8);
  image.convertTo(image, CV_8U);
  return image;
}

Fixture panelFixture() {
  Fixture fixture;
  fixture.name = "panel";
  for (const auto& p : slidingPanel(0.4)) fixture.points.push_back({std::to_string(fixture.points.size() + 1), p});
  return fixture;
}

TEST(DotFinder, FindsDotsToAFewHundredthsOfAPixel) {
  std::vector<Eigen::Vector2d> truth;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 5; ++c) truth.emplace_back(90.3 + 101.7 * c, 80.8 + 90.2 * r);
  }
  const auto dots = calibration::findDots(dotsAt(truth, 8));
  ASSERT_TRUE(dots.ok()) << dots.error().message;
  ASSERT_EQ(dots->size(), truth.size());
  for (const auto& c : truth) {
    const auto dot = calibration::dotAt(*dots, c, 5);
    ASSERT_TRUE(dot.has_value());
    EXPECT_LT(((*dots)[*dot].pixel - c).norm(), 0.06);
  }
  EXPECT_TRUE(calibration::findDots(cv::Mat(480, 640, CV_8U, cv::Scalar(128)))->empty());
  EXPECT_FALSE(calibration::findDots(cv::Mat()).ok());
}

TEST(DotFinder, SixClicksMatchTheWholePanel) {
  Fixture fixture = panelFixture();
  const auto camera = cameraOf(600, 598, 322, 241);
  const Pose X_CW = poseOf({0.25, -0.3, 0.05}, {0.02, -0.01, 1.05});
  std::vector<Eigen::Vector2d> truth;
  for (const auto& point : fixture.points) truth.push_back(camera.project(X_CW * point.xyz).value());
  const auto dots = calibration::findDots(dotsAt(truth, 4));
  ASSERT_TRUE(dots.ok());
  std::vector<DotMatch> by_hand;
  for (const std::size_t i : {0U, 6U, 34U, 28U, 105U, 139U, 111U, 133U}) by_hand.push_back({i, truth[i], true});
  const auto matches = calibration::matchFixture(fixture, *dots, by_hand, 640, 480);
  ASSERT_TRUE(matches.ok()) << matches.error().message;
  EXPECT_GT(matches->size(), 80U) << "of 140 points, " << dots->size() << " dots";
  for (const auto& match : *matches) EXPECT_LT((match.pixel - truth[match.point]).norm(), 1.0) << fixture.points[match.point].name;
}

TEST(DotFinder, SevenClicksMatchThroughABentLens) {
  Fixture fixture;
  for (int step = 0; step < 3; ++step) {
    for (int i = 0; i < 32; ++i) {
      fixture.points.push_back({std::to_string(fixture.points.size()), {-0.22 + 0.16 * step + 0.04 * (i % 4), 0.14 - 0.04 * (i / 4), 0.06 * step}});
    }
  }
  auto camera = cameraOf(741, 740, 322, 238);
  camera.distortion = {-0.28, 0.1, 0.0004, -0.0003, 0};
  for (const double turn : {-0.3, -0.1, 0.2}) {
    const Pose X_CW = poseOf({3.0, 0.05, turn}, {0, 0, 0.72});
    std::vector<Eigen::Vector2d> truth;
    std::vector<calibration::Dot> dots;
    for (const auto& point : fixture.points) {
      const auto pixel = camera.project(X_CW * point.xyz);
      ASSERT_TRUE(pixel.ok());
      truth.push_back(*pixel);
      dots.push_back({*pixel, 6});
    }
    std::vector<DotMatch> by_hand;
    for (const std::size_t i : {0U, 31U, 35U, 60U, 64U, 95U, 18U}) by_hand.push_back({i, truth[i], true});
    const auto matches = calibration::matchFixture(fixture, dots, by_hand, 640, 480);
    ASSERT_TRUE(matches.ok()) << matches.error().message;
    EXPECT_EQ(matches->size(), fixture.points.size()) << "turned by " << turn;
    for (const auto& match : *matches) EXPECT_LT((match.pixel - truth[match.point]).norm(), 1e-9) << match.point;
  }
}

TEST(FixtureFile, ReadsTablesListsAndPanels) {
  const auto csv = calibration::parseFixture("name,x,y,z\na,0,0,0\nb,1,0,0\nc,0,1,0\nd,0,0,1\ne,1,1,0\nf,1,0,1\n", "posts.csv");
  ASSERT_TRUE(csv.ok()) << csv.error().message;
  EXPECT_EQ(csv->points[3].name, "d");
  EXPECT_EQ(csv->name, "posts");
  const auto list = calibration::parseFixture("points: [[0,0,0],[1,0,0],[0,1,0],{name: top, xyz: [0,0,1]},[1,1,0],[1,0,1]]", "bench.yaml");
  ASSERT_TRUE(list.ok()) << list.error().message;
  EXPECT_EQ(list->points[3].name, "top");
  const auto panel = calibration::parseFixture("name: slide\npanel: {columns: 4, rows: 3, pitch: 0.1, depths: [0, 0.15, 0.3]}", "slide.yaml");
  ASSERT_TRUE(panel.ok()) << panel.error().message;
  ASSERT_EQ(panel->points.size(), 36U);
  EXPECT_NEAR((panel->points[35].xyz - Eigen::Vector3d(0.3, 0.2, 0.3)).norm(), 0, 1e-12);
}

TEST(FixtureFile, EachMistakeIsToldWithItsPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {"points: [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0]]", "6 or more"},
      {"points: [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[0,0,1]]", "same place"},
      {"points: [[0,0,0],[1,0],[0,1,0],[0,0,1],[1,1,0],[0,1,1]]", "points[1]"},
      {"panel: {columns: 4, rows: 3, depths: [0, 0.1]}", "pitch"},
      {"panel: {columns: 4.5, rows: 3, pitch: 0.1, depths: [0, 0.1]}", "whole numbers"},
      {"dots: []", "points"},
      {"points: [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0],[0,0,1200]]", "millimetres"}};
  for (const auto& [text, part] : cases) {
    const auto found = calibration::parseFixture(text, "f.yaml");
    ASSERT_FALSE(found.ok()) << text;
    EXPECT_NE(found.error().message.find(part), std::string::npos) << found.error().message;
  }
}

// ---- boards ------------------------------------------------------------------------------------------------------

// A printed board photographed from a pose: every pixel's ray is met with the board's plane, 4 x 4 samples each.
cv::Mat photograph(const cv::Mat& print, double print_pixels_per_m, const vision::CameraModel& camera, const Pose& X_CK) {
  cv::Mat out(camera.height, camera.width, CV_8U);
  const Pose X_KC = X_CK.inverse();
  for (int v = 0; v < out.rows; ++v) {
    for (int u = 0; u < out.cols; ++u) {
      double sum = 0;
      for (int s = 0; s < 16; ++s) {
        const Eigen::Vector2d pixel(u - 0.375 + 0.25 * (s % 4), v - 0.375 + 0.25 * (s / 4));
        const Eigen::Vector3d d = X_KC.linear() * Eigen::Vector3d((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy, 1);
        const Eigen::Vector3d at = X_KC.translation() - d * (X_KC.translation().z() / d.z());
        const int c = static_cast<int>(std::floor(at.x() * print_pixels_per_m)), r = static_cast<int>(std::floor(at.y() * print_pixels_per_m));
        sum += c >= 0 && r >= 0 && c < print.cols && r < print.rows ? print.at<uchar>(r, c) : 190;
      }
      out.at<uchar>(v, u) = cv::saturate_cast<uchar>(sum / 16);
    }
  }
  return out;
}

std::vector<Pose> poses(const Eigen::Vector2d& middle) {
  std::vector<Pose> out;
  const double tilts[8][2] = {{0.1, 0}, {0.5, 0.1}, {-0.5, 0}, {0, 0.5}, {0.1, -0.5}, {0.4, 0.4}, {-0.4, 0.4}, {0.4, -0.4}};
  for (const auto& t : tilts) {
    out.push_back(poseOf({t[0], t[1], 0.1}, {0.02 * t[1], 0.02 * t[0], 0.62}) * poseOf({0, 0, 0}, {-middle.x(), -middle.y(), 0}));
  }
  return out;
}

void expectCamera(const std::vector<calibration::BoardView>& views, const vision::CameraModel& truth) {
  calibration::IntrinsicsOptions options;
  options.lens.distortion = 0;
  options.lens.skew = false;
  const auto found = calibration::calibrateIntrinsics(views, truth.width, truth.height, options);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT(found->rms_px, 0.15);
  const calibration::LensVector error = calibration::lensVector(found->camera) - calibration::lensVector(truth);
  for (const int i : found->estimated.indices()) {
    EXPECT_LT(std::abs(error[i]), std::max(4 * std::sqrt(found->covariance(i, i)), 0.8)) << calibration::lensParameterName(i);
  }
}

TEST(Boards, ACharucoBoardGivesTheCameraBackAlsoWhenPartlyHidden) {
  BoardSpec spec;
  spec.kind = BoardKind::kCharuco;
  spec.columns = 6;
  spec.rows = 4;
  spec.square = 0.04;
  spec.marker = 0.03;
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_1000);
  const auto printed = cv::aruco::CharucoBoard::create(7, 5, 0.04f, 0.03f, dictionary);
  cv::Mat print;
  printed->draw({1400, 1000}, print, 0, 1);        // 5000 pixels a metre
  const auto camera = cameraOf(620, 618, 318, 242);
  std::vector<calibration::BoardView> views;
  int hidden = 0;
  for (const Pose& X_CK : poses({0.14, 0.1})) {
    cv::Mat image = photograph(print, 5000, camera, X_CK);
    if (++hidden % 3 == 0) image(cv::Rect(0, 0, 250, 480)).setTo(190);
    auto view = calibration::detectBoard(image, spec, "charuco");
    ASSERT_TRUE(view.ok()) << view.error().message;
    if (hidden % 3 != 0) {
      EXPECT_EQ(view->corners.size(), 24U);
    }
    views.push_back(*view);
  }
  expectCamera(views, camera);
}

TEST(Boards, AGridOfCirclesGivesTheCameraBack) {
  BoardSpec spec;
  spec.kind = BoardKind::kCircles;
  spec.columns = 7;
  spec.rows = 5;
  spec.square = 0.04;
  cv::Mat print(1200, 1600, CV_8U, cv::Scalar(240));   // 5000 pixels a metre
  for (int r = 0; r < 5; ++r) {
    for (int c = 0; c < 7; ++c) cv::circle(print, {200 + 200 * c, 200 + 200 * r}, 50, {20}, cv::FILLED);
  }
  const auto camera = cameraOf(620, 618, 318, 242);
  std::vector<calibration::BoardView> views;
  for (const Pose& X_CK : poses({0.16, 0.12})) {
    auto view = calibration::detectBoard(photograph(print, 5000, camera, X_CK), spec, "circles");
    ASSERT_TRUE(view.ok()) << view.error().message;
    EXPECT_EQ(view->corners.size(), 35U);
    views.push_back(*view);
  }
  expectCamera(views, camera);
}

TEST(Boards, ABoardPartlyOutOfThePictureABlurredOneAndOneOfAnotherSizeAreToldWithTheFix) {
  cv::Mat print(450, 600, CV_8U, cv::Scalar(235));
  for (int r = 0; r < 7; ++r) {
    for (int c = 0; c < 10; ++c) {
      if ((r + c) % 2 == 0) print(cv::Rect(50 + 50 * c, 50 + 50 * r, 50, 50)).setTo(25);
    }
  }
  BoardSpec spec;
  ASSERT_TRUE(calibration::detectBoard(print, spec, "whole").ok());
  const auto refusal = [&](const cv::Mat& picture) {
    const auto view = calibration::detectBoard(picture, spec, "picture");
    return view.ok() ? std::string("accepted") : view.error().message;
  };
  EXPECT_NE(refusal(print(cv::Rect(0, 0, 330, 450))).find("wholly in the picture"), std::string::npos) << refusal(print(cv::Rect(0, 0, 330, 450)));
  cv::Mat blurred;
  cv::GaussianBlur(print, blurred, {0, 0}, 30);
  EXPECT_NE(refusal(blurred).find("blurred or empty; hold the board still"), std::string::npos) << refusal(blurred);
  spec.columns = 10;
  spec.rows = 7;
  EXPECT_NE(calibration::otherBoardHint(print, spec).find("a 9x6 board was found"), std::string::npos);
}

TEST(Boards, TheSearchOfLivePicturesFindsWhatTheThoroughOneFinds) {
  LONGARM_SKIP_WITHOUT_DATA();
  int found = 0;
  for (const int number : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14}) {
    const std::string path = dataFolder() + "/opencv_stereo_chess/left" + (number < 10 ? "0" : "") + std::to_string(number) + ".jpg";
    const auto image = vision::loadImage(path);
    ASSERT_TRUE(image.ok()) << image.error().message;
    BoardSpec spec;
    const auto live = calibration::detectBoardLive(*image, spec, "live"), thorough = calibration::detectBoard(*image, spec, "thorough");
    ASSERT_TRUE(thorough.ok()) << path;
    if (!live.ok()) continue;
    ++found;
    double worst = 0, worst_turned = 0;
    for (std::size_t i = 0; i < live->corners.size(); ++i) {
      worst = std::max(worst, (live->corners[i].pixel - thorough->corners[i].pixel).norm());
      worst_turned = std::max(worst_turned, (live->corners[i].pixel - thorough->corners[live->corners.size() - 1 - i].pixel).norm());
    }
    EXPECT_LT(std::min(worst, worst_turned), 1.0) << path;
  }
  EXPECT_EQ(found, 13);
  EXPECT_FALSE(calibration::detectBoardLive(cv::Mat(480, 640, CV_8UC3, cv::Scalar(90, 120, 100)), BoardSpec{}, "grey").ok());
}

}  // namespace
}  // namespace longarm::tests
