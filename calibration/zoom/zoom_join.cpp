#include "calibration/zoom/zoom_join.h"

#include <cmath>

#include <Eigen/Dense>

#include "core/require.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr double kOdd = 4;                         // Principal points further off than this many sigma are told of.

struct Point {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};

Eigen::Vector2d principalPoint(const ZoomLens& lens) { return {lens.node.interior[3], lens.node.interior[4]}; }

// The common principal point by all settings but one.
Point withoutOne(const std::vector<ZoomLens>& lenses, std::size_t one, double variance) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (std::size_t k = 0; k < lenses.size(); ++k) {
    if (k == one) continue;
    const Eigen::Matrix2d weight = (lenses[k].covariance.block<2, 2>(kCx, kCx) + variance * Eigen::Matrix2d::Identity()).inverse();
    information += weight;
    sum += weight * principalPoint(lenses[k]);
  }
  const Eigen::Matrix2d covariance = information.inverse();
  return {covariance * sum, covariance};
}

}  // namespace

ZoomJoin joinZoom(const std::vector<ZoomLens>& lenses, double wander_px) {
  LONGARM_REQUIRE(wander_px > 0, "a principal point wanders by some pixels");
  ZoomJoin out{lenses, {}};
  if (lenses.size() < 2) return out;
  const double variance = wander_px * wander_px;
  for (std::size_t k = 0; k < lenses.size(); ++k) {
    const Point others = withoutOne(lenses, k, variance);
    const LensMatrix& C = lenses[k].covariance;
    const Eigen::Matrix2d whole = C.block<2, 2>(kCx, kCx) + others.covariance + variance * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d off = others.mean - principalPoint(lenses[k]);
    const double sigmas = std::sqrt(off.dot(whole.inverse() * off));
    if (sigmas > kOdd) {
      out.warnings.push_back("zoom " + formatNumber(lenses[k].node.zoom) + ": its principal point is " + formatFixed(off.norm(), 0) + " px from where the other settings have it (" +
                             formatFixed(sigmas, 0) + " sigma); calibrate this setting again");
    }
    const Eigen::Matrix<double, kLensParameters, 2> gain = C.middleCols<2>(kCx) * whole.inverse();
    const LensVector moved = gain * off;
    auto& lens = out.lenses[k];
    for (std::size_t i = 0; i < lens.node.interior.size(); ++i) lens.node.interior[i] += moved[static_cast<Eigen::Index>(i)];
    lens.covariance = C - gain * C.middleRows<2>(kCx);
  }
  return out;
}

}  // namespace longarm::calibration
