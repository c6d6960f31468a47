#include "calibration/intrinsics/compare_cameras.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "calibration/solve/lens_parameters.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr int kColumns = 16, kRows = 12;

Error bad(const std::string& what) { return {ErrorCode::kInvalidInput, what}; }

// B's camera seen from A's: identity unless the poses are used.
Result<Pose> relativePose(const vision::CameraFile& a, const vision::CameraFile& b, bool use_poses) {
  if (!use_poses) return Pose(Pose::Identity());
  if (!a.pose || !b.pose) return bad("the poses are to be compared, but " + std::string(a.pose ? "the second" : "the first") + " file has none");
  if (a.pose->parent != b.pose->parent) {
    return bad("the poses are in different frames, \"" + a.pose->parent + "\" and \"" + b.pose->parent + "\"; bring them into one");
  }
  return Pose(b.pose->pose.inverse() * a.pose->pose);
}

// The turn of directions that brings B's pixels nearest to A's, by Gauss-Newton.
Eigen::Vector3d bestTurn(const vision::CameraModel& b, const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector2d>& pixels) {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  for (int iteration = 0; iteration < 10; ++iteration) {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      LensProjection at;
      const Eigen::Vector3d p = R * points[i];
      if (!projectWithDerivatives(b, p, &at)) continue;
      const Eigen::Matrix<double, 2, 3> J = -at.d_point * skew(p);
      H += J.transpose() * J;
      g += J.transpose() * (pixels[i] - at.pixel);
    }
    const Eigen::Vector3d step = H.ldlt().solve(g);
    if (!step.allFinite()) break;
    R = expSO3(step) * R;
    if (step.norm() < 1e-12) break;
  }
  return logSO3(R);
}

std::optional<double> inSigmas(const vision::CameraFile& a, const vision::CameraFile& b) {
  const LensVector difference = lensVector(b.camera) - lensVector(a.camera);
  double sum = 0;
  int n = 0;
  for (int i = 0; i < kLensParameters; ++i) {
    const double variance = (a.covariance ? (*a.covariance)(i, i) : 0) + (b.covariance ? (*b.covariance)(i, i) : 0);
    if (!(variance > 0)) continue;
    sum += difference[i] * difference[i] / variance;
    ++n;
  }
  return n > 0 ? std::optional<double>(std::sqrt(sum / n)) : std::nullopt;
}

void summarise(CameraComparison* out) {
  const double n = std::max<double>(1, static_cast<double>(out->map.size()));
  double squares = 0, after = 0;
  for (const auto& d : out->map) {
    squares += d.difference_px.squaredNorm();
    after += d.after_turn_px * d.after_turn_px;
    out->max_px = std::max(out->max_px, d.difference_px.norm());
    out->max_mm = std::max(out->max_mm, 1e3 * d.miss_m);
  }
  out->rms_px = std::sqrt(squares / n);
  out->after_turn_rms_px = std::sqrt(after / n);
}

}  // namespace

Result<CameraComparison> compareCameras(const vision::CameraFile& a, const vision::CameraFile& b, double depth_m, bool use_poses) {
  if (!(depth_m > 0) || !std::isfinite(depth_m)) return bad("depth: " + formatNumber(depth_m) + " m is not above 0");
  const int width = std::max(a.camera.width, b.camera.width), height = std::max(a.camera.height, b.camera.height);
  if (width == 0) return bad("neither file says how large the picture is (image_width, image_height)");
  if ((a.camera.width > 0 && b.camera.width > 0) && (a.camera.width != b.camera.width || a.camera.height != b.camera.height)) {
    return bad("the pictures are of different sizes, " + std::to_string(a.camera.width) + " x " + std::to_string(a.camera.height) + " and " +
               std::to_string(b.camera.width) + " x " + std::to_string(b.camera.height) + "; compare calibrations of one picture size");
  }
  const auto X_BA = relativePose(a, b, use_poses);
  if (!X_BA) return X_BA.error();
  CameraComparison out;
  out.columns = kColumns + 1;
  out.rows = kRows + 1;
  out.depth_m = depth_m;
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  for (int row = 0; row <= kRows; ++row) {
    for (int column = 0; column <= kColumns; ++column) {
      const Eigen::Vector2d pixel((width - 1.0) * column / kColumns, (height - 1.0) * row / kRows);
      const auto n = a.camera.normalisedOfPixel(pixel);
      if (!n) continue;
      const Eigen::Vector3d p_B = *X_BA * Eigen::Vector3d(depth_m * n->homogeneous());
      const auto back = b.camera.normalisedOfPixel(pixel);
      Eigen::Vector2d seen;
      if (!back || !projectPoint(b.camera, p_B, &seen)) continue;
      CameraDifference d{pixel, seen - pixel, 0, 0};
      d.miss_m = (p_B - p_B.z() * back->homogeneous()).norm();
      out.map.push_back(d);
      points.push_back(p_B);
      pixels.push_back(pixel);
    }
  }
  if (points.size() < 3) return bad("the two cameras share no part of the picture");
  out.turn = bestTurn(b.camera, points, pixels);
  const Eigen::Matrix3d R = expSO3(out.turn);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Vector2d seen;
    out.map[i].after_turn_px = projectPoint(b.camera, R * points[i], &seen) ? (seen - pixels[i]).norm() : out.map[i].difference_px.norm();
  }
  out.sigmas = inSigmas(a, b);
  summarise(&out);
  return out;
}

}  // namespace longarm::calibration
