#include "calibration/intrinsics/coverage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "calibration/intrinsics/plane_homography.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr int kCells = 4;
constexpr double kDegrees = 180 / 3.14159265358979323846;

struct Frame {
  Eigen::Vector2d low, size;
};

Frame frameOf(const std::vector<BoardView>& views, const vision::CameraModel& camera) {
  if (camera.width > 0) return {{-0.5, -0.5}, {static_cast<double>(camera.width), static_cast<double>(camera.height)}};
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300), high = -low;
  for (const auto& view : views) {
    for (const auto& c : view.corners) {
      low = low.cwiseMin(c.pixel);
      high = high.cwiseMax(c.pixel);
    }
  }
  return {low, (high - low).cwiseMax(1e-9)};
}

double largestNormalisedRadius(const std::vector<BoardView>& views, const IntrinsicsResult& result) {
  double radius = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!result.views[k].used) continue;
    for (const auto& c : views[k].corners) {
      radius = std::max(radius, (result.views[k].X_CK * c.xyz).hnormalized().norm());
    }
  }
  return radius;
}

void warnOfTilts(const Coverage& coverage, std::vector<std::string>* warnings) {
  if (coverage.views < 2 || std::min(coverage.tilt_x_deg, coverage.tilt_y_deg) >= 20) return;
  warnings->push_back("the views are too similar: the board's tilt varies by only " + formatFixed(coverage.tilt_x_deg, 0) +
                      " degrees about the horizontal and " + formatFixed(coverage.tilt_y_deg, 0) +
                      " about the vertical axis (40 or more are good). Add views tilted each way");
}

}  // namespace

Coverage coverageOf(const std::vector<BoardView>& views, const IntrinsicsResult& result) {
  const Frame frame = frameOf(views, result.camera);
  std::array<bool, kCells * kCells> seen{};
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300), high = -low;
  double nearest = 1e300, farthest = 0;
  Coverage out;
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (!result.views[k].used) continue;
    ++out.views;
    for (const auto& c : views[k].corners) {
      const Eigen::Vector2d cell = (c.pixel - frame.low).cwiseQuotient(frame.size) * kCells;
      const int i = std::clamp(static_cast<int>(cell.x()), 0, kCells - 1);
      const int j = std::clamp(static_cast<int>(cell.y()), 0, kCells - 1);
      seen[static_cast<std::size_t>(j * kCells + i)] = true;
    }
    const Pose X_CP = result.views[k].X_CK * planeOf(views[k].corners).X_KP;
    Eigen::Vector3d normal = X_CP.linear().col(2);
    if (normal.z() < 0) normal = -normal;
    const Eigen::Vector2d tilt(std::atan2(normal.y(), normal.z()), std::atan2(normal.x(), normal.z()));
    low = low.cwiseMin(tilt);
    high = high.cwiseMax(tilt);
    nearest = std::min(nearest, X_CP.translation().norm());
    farthest = std::max(farthest, X_CP.translation().norm());
  }
  out.picture = static_cast<double>(std::count(seen.begin(), seen.end(), true)) / (kCells * kCells);
  if (out.views == 0) return out;
  out.tilt_x_deg = kDegrees * (high.x() - low.x());
  out.tilt_y_deg = kDegrees * (high.y() - low.y());
  out.size_ratio = nearest > 0 ? farthest / nearest : 1;
  return out;
}

void appendQualityWarnings(const std::vector<BoardView>& views, IntrinsicsResult* result) {
  auto& warnings = result->warnings;
  const Coverage coverage = coverageOf(views, *result);
  const bool planar = std::all_of(views.begin(), views.end(), [](const BoardView& v) {
    return v.corners.size() < 4 || planeOf(v.corners).flatness < 0.02;
  });
  if (planar && coverage.views < 8) {
    warnings.push_back("only " + std::to_string(coverage.views) + " views are used; 8 or more are recommended");
  }
  if (planar) warnOfTilts(coverage, &warnings);
  if (planar && coverage.picture < 0.6) {
    warnings.push_back("corners cover " + formatFixed(100 * coverage.picture, 0) +
                       " % of the picture (60 % or more are recommended); add views near its edges and corners");
  }
  const double part = std::sqrt(result->covariance(kFx, kFx)) / result->camera.fx;
  if (part > 0.01) {
    warnings.push_back("the focal length is known only to " + formatFixed(100 * part, 1) +
                       " % (1 sigma; 1 % or better is recommended); add tilted views");
  }
  const double range = result->camera.monotoneRadius(), radius = largestNormalisedRadius(views, *result);
  if (radius > range) {
    warnings.push_back("the estimated lens cannot be inverted beyond radius " + formatFixed(range, 3) +
                       ", but corners were seen at " + formatFixed(radius, 3) + "; use fewer distortion parameters");
  }
  const auto left_out = std::count_if(result->views.begin(), result->views.end(), [](const ViewReport& v) { return !v.used; });
  if (left_out > 0) {
    warnings.push_back(std::to_string(left_out) + " of " + std::to_string(result->views.size()) +
                       " views are not used; see why in per_view");
  }
}

}  // namespace longarm::calibration
