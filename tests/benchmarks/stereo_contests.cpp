// Clicks and epipolar curves against OpenCV.
#include <array>
#include <cmath>
#include <memory>

#include <benchmark/benchmark.h>
#include <opencv2/calib3d.hpp>

#include "core/text.h"
#include "tests/benchmarks/gate.h"
#include "tests/vision/stereo_rig.h"
#include "vision/stereo/epipolar.h"
#include "vision/stereo/pair_triangulator.h"

namespace longarm::benchmarks {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using tests::Dice;
using vision::View;

constexpr int kPoints = 100, kSamples = 64;
constexpr double kNoise = 0.5, kNear = 0.3, kFar = 10;

// A stereo head of the report's kind: 254 mm apart, slightly toed in, f = 800 px, lenses in both.
struct Head {
  Head() {
    auto camera = tests::pinhole("left");
    camera.distortion = {-0.25, 0.08, 1e-3, -5e-4, 0};
    left = tests::viewOf(camera, {0, 0, 0});
    camera.name = "right";
    right = tests::viewOf(camera, {0.254, 0.003, 0.002}, {0.01, -0.10, 0.005});
    const auto& c = camera;
    K = cv::Matx33d(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1);
    D = cv::Vec4d(c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3]);
    const Pose X_RL = right.X_WC.inverse() * left.X_WC;
    cv::Matx33d R;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 4; ++j) P1(i, j) = i == j ? 1 : 0;
      for (int j = 0; j < 3; ++j) P2(i, j) = R(i, j) = X_RL.linear()(i, j);
      P2(i, 3) = t[i] = X_RL.translation()[i];
    }
    cv::Rodrigues(R, rotvec);
  }
  View left, right;
  cv::Matx33d K;
  cv::Vec4d D;
  cv::Matx34d P1, P2;          // of normalised coordinates
  cv::Vec3d rotvec, t;
};

struct Clicks {
  Clicks(const Head& head, int count, std::uint64_t seed) {
    Dice dice(seed);
    for (int i = 0; i < count; ++i) {
      const Vector3d p = tests::pointSeenByAll({&head.left, &head.right}, 1, 3, &dice);
      truth.push_back(p);
      a.push_back(head.left.project(p).value() + dice.normal2(kNoise));
      b.push_back(head.right.project(p).value() + dice.normal2(kNoise));
    }
  }
  std::vector<Vector3d> truth;
  std::vector<Vector2d> a, b;
};

Vector3d locateByOpenCv(const Head& head, const Vector2d& a, const Vector2d& b) {
  const std::vector<cv::Point2d> raw_a{{a.x(), a.y()}}, raw_b{{b.x(), b.y()}};
  std::vector<cv::Point2d> ideal_a, ideal_b;
  cv::undistortPoints(raw_a, ideal_a, head.K, head.D);
  cv::undistortPoints(raw_b, ideal_b, head.K, head.D);
  cv::Mat H;
  cv::triangulatePoints(head.P1, head.P2, ideal_a, ideal_b, H);
  return Vector3d(H.at<double>(0), H.at<double>(1), H.at<double>(2)) / H.at<double>(3);
}

// Trace of the smallest covariance that any unbiased estimator can reach (Cramer and Rao).
double floorVariance(const Head& head, const Vector3d& p) {
  Matrix3d information = Matrix3d::Zero();
  for (const View* view : {&head.left, &head.right}) {
    const Matrix3d R_CW = view->X_WC.linear().transpose();
    const auto at = view->camera.projectWithJacobian(view->X_WC.inverse() * p);
    const Eigen::Matrix<double, 2, 3> J = at->d_point * R_CW;
    information += J.transpose() * J / (kNoise * kNoise);
  }
  return information.inverse().trace();
}

Accuracy clickAccuracy(const Head& head) {
  const int count = 200000;
  const Clicks clicks(head, count, 2);
  const vision::PairTriangulator pair(head.left, head.right);
  double ours2 = 0, theirs2 = 0, floor2 = 0;
  int inside = 0;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    vision::PairPoint point;
    if (!pair.locate(clicks.a[k], clicks.b[k], &point)) return {false, "refused a good pair"};
    const Vector3d error = point.xyz - clicks.truth[k];
    ours2 += error.squaredNorm();
    theirs2 += (locateByOpenCv(head, clicks.a[k], clicks.b[k]) - clicks.truth[k]).squaredNorm();
    floor2 += floorVariance(head, clicks.truth[k]);
    inside += error.dot(point.covariance.ldlt().solve(error)) < 7.815 ? 1 : 0;
  }
  const double rms = std::sqrt(ours2 / floor2), share = 100.0 * inside / count;
  return {rms <= 1.01 && share >= 93 && share <= 97,
          "rms " + formatFixed(rms, 4) + " of the Cramer-Rao floor (peer " + formatFixed(std::sqrt(theirs2 / floor2), 4) +
              ", limit 1.01); 95 % ellipsoid holds " + formatFixed(share, 1) + " %"};
}

Contest clickContest(const std::shared_ptr<Head>& head) {
  auto clicks = std::make_shared<Clicks>(*head, kPoints, 1);
  auto pair = std::make_shared<vision::PairTriangulator>(head->left, head->right);
  auto next = std::make_shared<std::size_t>(0);
  Contest contest{"click", "OpenCV undistortPoints x 2 + triangulatePoints, without covariance", {}, {}, 10, 25, false, {}};
  contest.ours = [=] {
    vision::PairPoint point;
    pair->locate(clicks->a[*next], clicks->b[*next], &point);
    benchmark::DoNotOptimize(point);
    *next = (*next + 1) % kPoints;
  };
  contest.theirs = [=] {
    Vector3d point = locateByOpenCv(*head, clicks->a[*next], clicks->b[*next]);
    benchmark::DoNotOptimize(point);
    *next = (*next + 1) % kPoints;
  };
  contest.accuracy = [head] { return clickAccuracy(*head); };
  return contest;
}

std::vector<Vector3d> locateAllByOpenCv(const Head& head, const std::vector<cv::Point2d>& raw_a, const std::vector<cv::Point2d>& raw_b) {
  std::vector<cv::Point2d> ideal_a, ideal_b;
  cv::undistortPoints(raw_a, ideal_a, head.K, head.D);
  cv::undistortPoints(raw_b, ideal_b, head.K, head.D);
  cv::Mat H;
  cv::triangulatePoints(head.P1, head.P2, ideal_a, ideal_b, H);
  std::vector<Vector3d> points;
  for (int i = 0; i < H.cols; ++i) {
    points.push_back(Vector3d(H.at<double>(0, i), H.at<double>(1, i), H.at<double>(2, i)) / H.at<double>(3, i));
  }
  return points;
}

Accuracy batchAccuracy(const Head& head) {
  const int count = 100000;
  const Clicks clicks(head, count, 4);
  std::vector<Vector3d> points;
  const std::size_t located = vision::PairTriangulator(head.left, head.right).locateAll(clicks.a, clicks.b, &points);
  double ours2 = 0, floor2 = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    ours2 += (points[i] - clicks.truth[i]).squaredNorm();
    floor2 += floorVariance(head, clicks.truth[i]);
  }
  const double rms = std::sqrt(ours2 / floor2);
  return {located == points.size() && rms <= 1.01, "rms " + formatFixed(rms, 4) + " of the Cramer-Rao floor (limit 1.01)"};
}

Contest batchContest(const std::shared_ptr<Head>& head) {
  constexpr int kBatch = 1000;
  auto clicks = std::make_shared<Clicks>(*head, kBatch, 1);
  auto pair = std::make_shared<vision::PairTriangulator>(head->left, head->right);
  auto raw = std::make_shared<std::array<std::vector<cv::Point2d>, 2>>();
  for (int i = 0; i < kBatch; ++i) {
    const auto k = static_cast<std::size_t>(i);
    (*raw)[0].emplace_back(clicks->a[k].x(), clicks->a[k].y());
    (*raw)[1].emplace_back(clicks->b[k].x(), clicks->b[k].y());
  }
  auto points = std::make_shared<std::vector<Vector3d>>();
  Contest contest{"batch", "OpenCV undistortPoints x 2 + triangulatePoints, 1000 pairs", {}, {}, 100, 1000, false, {}};
  contest.ours = [=] { benchmark::DoNotOptimize(pair->locateAll(clicks->a, clicks->b, points.get())); };
  contest.theirs = [=] {
    auto located = locateAllByOpenCv(*head, (*raw)[0], (*raw)[1]);
    benchmark::DoNotOptimize(located.data());
  };
  contest.accuracy = [head] { return batchAccuracy(*head); };
  return contest;
}

// Depths uniform in inverse depth, as ours.
void curveByOpenCv(const Head& head, const Vector2d& pixel, const cv::TermCriteria* to_the_end,
                   std::vector<cv::Point2d>* curve) {
  const std::vector<cv::Point2d> raw{{pixel.x(), pixel.y()}};
  std::vector<cv::Point2d> ideal;
  if (to_the_end != nullptr) {
    cv::undistortPoints(raw, ideal, head.K, head.D, cv::noArray(), cv::noArray(), *to_the_end);
  } else {
    cv::undistortPoints(raw, ideal, head.K, head.D);
  }
  std::vector<cv::Point3d> ray(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    const double z = 1 / (1 / kNear + (1 / kFar - 1 / kNear) * i / (kSamples - 1));
    ray[static_cast<std::size_t>(i)] = {ideal[0].x * z, ideal[0].y * z, z};
  }
  cv::projectPoints(ray, head.rotvec, head.t, head.K, head.D, *curve);
}

Accuracy curveAccuracy(const Head& head) {
  const Clicks clicks(head, 1000, 3);
  // OpenCV's usual five rounds leave up to a tenth of a pixel near corners: it is compared after fifty.
  const cv::TermCriteria to_the_end(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 50, 1e-12);
  double worst = 0;
  for (const auto& pixel : clicks.a) {
    double u[kSamples], v[kSamples];
    bool visible[kSamples];
    if (!vision::sampleEpipolarCurve(head.left, pixel, head.right, kNear, kFar, kSamples, u, v, visible)) {
      return {false, "refused a good pixel"};
    }
    std::vector<cv::Point2d> curve;
    curveByOpenCv(head, pixel, &to_the_end, &curve);
    for (int i = 0; i < kSamples; ++i) {
      const auto& other = curve[static_cast<std::size_t>(i)];
      if (visible[i]) worst = std::max(worst, std::hypot(u[i] - other.x, v[i] - other.y));
    }
  }
  return {worst <= 0.01, "at most " + formatNumber(worst) + " px from OpenCV's (limit 0.01)"};
}

Contest curveContest(const std::shared_ptr<Head>& head) {
  auto clicks = std::make_shared<Clicks>(*head, kPoints, 1);
  auto next = std::make_shared<std::size_t>(0);
  Contest contest{"epipolar_curve", "OpenCV undistortPoints + projectPoints, 64 points", {}, {}, 8, 40, false, {}};
  contest.ours = [=] {
    double u[kSamples], v[kSamples];
    bool visible[kSamples];
    vision::sampleEpipolarCurve(head->left, clicks->a[*next], head->right, kNear, kFar, kSamples, u, v, visible);
    benchmark::DoNotOptimize(u);
    benchmark::DoNotOptimize(v);
    benchmark::DoNotOptimize(visible);
    *next = (*next + 1) % kPoints;
  };
  contest.theirs = [=] {
    std::vector<cv::Point2d> curve;
    curveByOpenCv(*head, clicks->a[*next], nullptr, &curve);
    benchmark::DoNotOptimize(curve.data());
    *next = (*next + 1) % kPoints;
  };
  contest.accuracy = [head] { return curveAccuracy(*head); };
  return contest;
}

}  // namespace

std::vector<Contest> stereoContests() {
  cv::setNumThreads(1);
  const auto head = std::make_shared<Head>();
  return {clickContest(head), batchContest(head), curveContest(head)};
}

}  // namespace longarm::benchmarks
