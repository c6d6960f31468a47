// Fixtures: the linear solution, its decomposition, refinement and refusals.
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "calibration/fixture/calibrate_fixture.h"
#include "calibration/fixture/dlt.h"
#include "calibration/intrinsics/corners_file.h"
#include "tests/calibration/synthetic.h"

namespace longarm::tests {
namespace {

using calibration::BoardView;
using calibration::calibrateFixture;
using calibration::FixtureResult;

// Fixture of the report's kind: camera 1.2 m away, slightly turned.
const Pose kFixturePose = poseOf({0.15, -0.2, 0.05}, {0.02, -0.03, 1.2});

BoardView fixturePicture(Random* random, double noise, double depth = 0.3) {
  return picture(cameraOf(800, 805, 320, 240), kFixturePose, slidingPanel(depth), random, noise);
}

TEST(Dlt, RecoversAThousandRandomCamerasWithTheOriginOnEitherSide) {
  Random random(31);
  int behind = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    auto camera = cameraOf(random.uniform(300, 3000), random.uniform(300, 3000), random.uniform(200, 440), random.uniform(150, 330));
    camera.skew = random.uniform(-20, 20);
    Pose X_CW = Pose::Identity();
    X_CW.linear() = random.rotation();
    X_CW.translation() = random.vector();
    behind += X_CW.translation().z() < 0 ? 1 : 0;
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 30; ++i) {
      const double z = random.uniform(1, 3);
      points.push_back(X_CW.inverse() * Eigen::Vector3d(z * random.uniform(-0.4, 0.4), z * random.uniform(-0.3, 0.3), z));
    }
    const BoardView view = picture(camera, X_CW, points);
    const auto solution = calibration::solveDlt(view.corners);
    EXPECT_EQ(solution.rank, 11);
    const auto found = calibration::decompose(solution.C, view.corners);
    ASSERT_TRUE(found.ok()) << found.error().message;
    const double f = camera.fx;
    EXPECT_LT(std::abs(found->camera.fx - camera.fx) / f, 1e-10);
    EXPECT_LT(std::abs(found->camera.fy - camera.fy) / f, 1e-10);
    EXPECT_LT(std::abs(found->camera.skew - camera.skew) / f, 1e-10);
    EXPECT_LT(std::abs(found->camera.cx - camera.cx) / f, 1e-10);
    EXPECT_LT(std::abs(found->camera.cy - camera.cy) / f, 1e-10);
    EXPECT_LT((found->X_CW.matrix() - X_CW.matrix()).cwiseAbs().maxCoeff(), 1e-9);
  }
  EXPECT_GT(behind, 300) << "the sign rule was exercised";
}

TEST(Dlt, RanksAreThoseOfTheTable) {
  Random random(32);
  const auto camera = cameraOf(800, 805, 320, 240);
  const auto rankOf = [&](const std::vector<Eigen::Vector3d>& points) {
    return calibration::solveDlt(picture(camera, kFixturePose, points).corners).rank;
  };
  std::vector<Eigen::Vector3d> cloud;
  for (int i = 0; i < 5; ++i) cloud.push_back(random.vector(0.2));
  EXPECT_EQ(rankOf(cloud), 10) << "five points";
  cloud.push_back(random.vector(0.2));
  EXPECT_EQ(rankOf(cloud), 11) << "six points";
  EXPECT_EQ(rankOf(slidingPanel(0)), 8) << "a plane";
  auto critical = slidingPanel(0);
  const Eigen::Vector3d centre = kFixturePose.inverse().translation();
  for (int i = 1; i < 10; ++i) critical.push_back(centre + (Eigen::Vector3d(0.05, 0.05, 0) - centre) * (1 - 0.05 * i));
  EXPECT_EQ(rankOf(critical), 10) << "a plane and a line through the camera";
}

TEST(Dlt, TheRightPseudoInverseLeavesTheNoiseOnly) {
  Random random(33);
  std::vector<double> rms;
  for (int i = 0; i < 50; ++i) {
    const BoardView view = fixturePicture(&random, 0.5);
    const auto solution = calibration::solveDlt(view.corners);
    double sum = 0;
    for (const auto& c : view.corners) {
      const Eigen::Vector2d clean = pixelOf(cameraOf(800, 805, 320, 240), kFixturePose * c.xyz);
      sum += ((solution.C * c.xyz.homogeneous()).hnormalized() - clean).squaredNorm() / (2.0 * static_cast<double>(view.corners.size()));
    }
    rms.push_back(std::sqrt(sum));
  }
  std::sort(rms.begin(), rms.end());
  EXPECT_LT(rms[25], 0.15) << "equation (12) as printed gives 83 px here";
  EXPECT_LT(rms.back(), 0.3);
}

TEST(Lens, EqualsOpenCvForAThousandPoints) {
  Random random(34);
  auto camera = cameraOf(800, 790, 322, 238);
  camera.distortion = {-0.2, 0.05, 0.002, -0.001, 0};
  const cv::Mat K = (cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const cv::Mat d = (cv::Mat_<double>(1, 4) << -0.2, 0.05, 0.002, -0.001);
  std::vector<cv::Point3d> points;
  for (int i = 0; i < 1000; ++i) {
    const double z = random.uniform(0.5, 3);
    points.emplace_back(z * random.uniform(-0.5, 0.5), z * random.uniform(-0.4, 0.4), z);
  }
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K, d, pixels);
  for (std::size_t i = 0; i < points.size(); ++i) {
    calibration::LensProjection ours;
    ASSERT_TRUE(calibration::projectWithDerivatives(camera, {points[i].x, points[i].y, points[i].z}, &ours));
    EXPECT_LT((ours.pixel - Eigen::Vector2d(pixels[i].x, pixels[i].y)).norm(), 1e-9);
  }
}

TEST(Lens, DistortUndoesUndistortInsideTheMonotoneRange) {
  Random random(35);
  auto camera = cameraOf(800, 790, 322, 238);
  camera.distortion = {-0.35, 0.12, 0.001, -0.001, 0};
  const double limit = std::min(0.75, 0.95 * camera.monotoneRadius());
  for (int i = 0; i < 1000; ++i) {
    const double angle = random.uniform(0, 6.28), r = limit * std::sqrt(random.uniform(0, 1));
    const Eigen::Vector2d pixel = camera.pixelOfNormalised({r * std::cos(angle), r * std::sin(angle)});
    const auto n = camera.normalisedOfPixel(pixel);
    ASSERT_TRUE(n.ok()) << n.error().message;
    EXPECT_LT((camera.pixelOfNormalised(*n) - pixel).norm(), 1e-9);
  }
}

TEST(Lens, DerivativesEqualDifferences) {
  auto camera = cameraOf(800, 790, 322, 238);
  camera.skew = -4;
  camera.distortion = {-0.2, 0.05, 0.002, -0.001, 0.01};
  const Eigen::Vector3d p(0.3, -0.2, 1.1);
  calibration::LensProjection at;
  ASSERT_TRUE(calibration::projectWithDerivatives(camera, p, &at));
  for (int i = 0; i < calibration::kLensParameters; ++i) {
    auto plus = camera, minus = camera;
    auto v = calibration::lensVector(camera);
    const double h = 1e-5 * std::max(1.0, std::abs(v[i]));
    v[i] += h;
    calibration::setLensVector(v, &plus);
    v[i] -= 2 * h;
    calibration::setLensVector(v, &minus);
    const Eigen::Vector2d difference = (pixelOf(plus, p) - pixelOf(minus, p)) / (2 * h);
    EXPECT_LT((difference - at.d_lens.col(i)).norm(), 1e-6 * (1 + difference.norm())) << calibration::lensParameterName(i);
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(i);
    EXPECT_LT(((pixelOf(camera, p + h) - pixelOf(camera, p - h)) / 2e-6 - at.d_point.col(i)).norm(), 1e-4);
  }
}

TEST(Fixture, NoiseFreeCameraComesBackExactlyWithSkewAndDistortion) {
  auto camera = cameraOf(800, 805, 320, 240);
  camera.skew = -6.28;
  camera.distortion = {-0.2, 0.06, 0.001, -0.0015, 0};
  const auto found = calibrateFixture(picture(camera, kFixturePose, slidingPanel()), 640, 480);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_LT((calibration::lensVector(found->camera) - calibration::lensVector(camera)).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT((found->X_WC.matrix() - kFixturePose.inverse().matrix()).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT(found->rms_px, 1e-8);
  EXPECT_GT(found->dlt_rms_px, 0.1) << "the linear solution knows no distortion";
}

TEST(Fixture, TheOrderOfPointsDoesNotMatter) {
  Random random(37);
  auto points = fixturePicture(&random, 0.5);
  const auto first = calibrateFixture(points, 640, 480);
  ASSERT_TRUE(first.ok()) << first.error().message;
  for (int shuffle = 0; shuffle < 5; ++shuffle) {
    std::shuffle(points.corners.begin(), points.corners.end(), random.engine());
    const auto again = calibrateFixture(points, 640, 480);
    ASSERT_TRUE(again.ok()) << again.error().message;
    const auto lens = calibration::lensVector(first->camera), other = calibration::lensVector(again->camera);
    EXPECT_LT(((other - lens).array() / (1 + lens.array().abs())).abs().maxCoeff(), 1e-6);
    EXPECT_LT((again->X_WC.matrix() - first->X_WC.matrix()).cwiseAbs().maxCoeff(), 1e-6);
  }
}

// Empirical over predicted sigma, and mean of error^2 / variance, of `runs` fixtures with 0.5 px noise.
void checkHonesty(int runs, double low, double high, double nees_margin) {
  Random random(36);
  const auto camera = cameraOf(800, 805, 320, 240);
  Eigen::Matrix<double, 10, 1> squares = Eigen::Matrix<double, 10, 1>::Zero(), predicted = squares, nees = squares;
  calibration::LensChoice lens;
  lens.distortion = 0;
  const int used[4] = {calibration::kFx, calibration::kFy, calibration::kCx, calibration::kCy};
  for (int run = 0; run < runs; ++run) {
    const auto found = calibrateFixture(fixturePicture(&random, 0.5), 0, 0, lens);
    ASSERT_TRUE(found.ok()) << found.error().message;
    Eigen::Matrix<double, 10, 1> error;
    error.head<4>() << found->camera.fx - 800, found->camera.fy - 805, found->camera.cx - 320, found->camera.cy - 240;
    const Pose X_WC = kFixturePose.inverse();
    error.segment<3>(4) = logSO3(found->X_WC.linear() * X_WC.linear().transpose());
    error.tail<3>() = found->X_WC.translation() - X_WC.translation();
    Eigen::Matrix<double, 10, 1> variance;
    for (int i = 0; i < 4; ++i) variance[i] = found->covariance(used[i], used[i]);
    variance.tail<6>() = found->covariance.diagonal().tail<6>();
    squares += error.cwiseAbs2() / runs;
    predicted += variance / runs;
    nees += error.cwiseAbs2().cwiseQuotient(variance) / runs;
  }
  for (int i = 0; i < 10; ++i) {
    EXPECT_GT(std::sqrt(squares[i] / predicted[i]), low) << i;
    EXPECT_LT(std::sqrt(squares[i] / predicted[i]), high) << i;
    EXPECT_NEAR(nees[i], 1, nees_margin) << i;
  }
}

TEST(Fixture, PredictedSigmaIsWhatThreeHundredRunsShow) { checkHonesty(300, 0.85, 1.15, 0.25); }

TEST(FixtureCampaign, CovarianceIsHonestToTenPercent) { checkHonesty(4000, 0.95, 1.05, 0.1); }

void expectRefused(const Result<FixtureResult>& result, const std::string& word) {
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
}

TEST(Fixture, ADotHiddenInPartIsLeftOutAndTold) {
  Random random(38);
  BoardView points = fixturePicture(&random, 0.1);
  const auto clean = calibrateFixture(points, 640, 480);
  ASSERT_TRUE(clean.ok()) << clean.error().message;
  EXPECT_EQ(std::count(clean->left_out.begin(), clean->left_out.end(), true), 0);
  points.corners[17].pixel += Eigen::Vector2d(-1.6, 0.4);          // seen by half
  const auto result = calibrateFixture(points, 640, 480);
  ASSERT_TRUE(result.ok()) << result.error().message;
  EXPECT_EQ(std::count(result->left_out.begin(), result->left_out.end(), true), 1);
  EXPECT_TRUE(result->left_out[17]);
  EXPECT_NEAR(result->residual_px[17], 1.65, 0.4);
  EXPECT_LT(std::abs(result->camera.fx - clean->camera.fx), 0.5 * std::sqrt(clean->covariance(0, 0))) << "it moves nothing";
  ASSERT_FALSE(result->warnings.empty());
  EXPECT_NE(result->warnings.back().find("1 of 140 points misses by more than 4 sigma"), std::string::npos) << result->warnings.back();
}

TEST(Fixture, RefusesFivePointsAPlaneALineAndMirrors) {
  Random random(37);
  BoardView view = fixturePicture(&random, 0.3);
  BoardView five = view;
  five.corners.resize(5);
  expectRefused(calibrateFixture(five, 0, 0), "only 5 points");
  expectRefused(calibrateFixture(fixturePicture(&random, 0.3, 0), 0, 0), "coplanar");
  BoardView line;
  for (const auto& c : view.corners) {
    if (c.xyz.y() == 0 && c.xyz.z() == 0) line.corners.push_back(c);
  }
  expectRefused(calibrateFixture(line, 0, 0), line.corners.size() < 6 ? "only" : "collinear");
  BoardView upwards = view, left_handed = view;
  for (auto& c : upwards.corners) c.pixel.y() = 479 - c.pixel.y();
  for (auto& c : left_handed.corners) c.xyz.x() = -c.xyz.x();
  expectRefused(calibrateFixture(upwards, 0, 0), "mirrored");
  expectRefused(calibrateFixture(left_handed, 0, 0), "mirrored");
}

TEST(Fixture, NamesTheLinesOfSwappedLabels) {
  Random random(38);
  BoardView view = fixturePicture(&random, 0.3);
  std::swap(view.corners[10].pixel, view.corners[90].pixel);
  const auto result = calibrateFixture(view, 640, 480);
  expectRefused(result, "swapped");
  EXPECT_NE(result.error().message.find("line 12"), std::string::npos) << result.error().message;
  EXPECT_NE(result.error().message.find("line 92"), std::string::npos) << result.error().message;
}

TEST(Fixture, ADepthThatDrownsInNoiseIsRefusedAWeakOneWarnedOf) {
  Random random(39);
  EXPECT_FALSE(calibrateFixture(fixturePicture(&random, 0.5, 0.002), 0, 0).ok());
  const auto weak = calibrateFixture(fixturePicture(&random, 0.5, 0.03), 0, 0);
  ASSERT_TRUE(weak.ok()) << weak.error().message;
  EXPECT_FALSE(weak->warnings.empty());
}

TEST(Fixture, FilesNameLineColumnAndValue) {
  const auto bad = calibration::parseFixturePoints("x,y,z,u,v\n0,0,0,1,2\n0,0,1,12,4x\n", "points.csv");
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().message.find("points.csv: line 3: column v: \"4x\""), std::string::npos) << bad.error().message;
  const auto comma = calibration::parseFixturePoints("x,y,z,u,v\r\n0,0,0,1,5,2\r\n", "p.csv");
  ASSERT_FALSE(comma.ok());
  EXPECT_NE(comma.error().message.find("6 columns"), std::string::npos) << comma.error().message;
  const auto twice = calibration::parseFixturePoints("x,y,z,u,v\n0,0,0,1,5\n0,0,0,2,6\n", "p.csv");
  ASSERT_FALSE(twice.ok());
  EXPECT_NE(twice.error().message.find("already given"), std::string::npos) << twice.error().message;
  const auto header = calibration::parseFixturePoints("x,y,u,v\n0,0,0,1\n", "p.csv");
  ASSERT_FALSE(header.ok());
  EXPECT_NE(header.error().message.find("\"z\""), std::string::npos) << header.error().message;
  EXPECT_TRUE(calibration::parseFixturePoints("\xEF\xBB\xBFv,u,x,y,z\r\n2,1,0,0,0\r\n", "p.csv").ok()) << "any order of columns";
}

}  // namespace
}  // namespace longarm::tests
