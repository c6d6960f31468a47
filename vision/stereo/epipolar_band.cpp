#include "vision/stereo/epipolar_band.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/camera/lens.h"
#include "vision/stereo/calibration_effect.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kFewPicks = 3;

Status checkParents(const View& a, const View& b) {
  if (a.parent == b.parent) return {};
  return {ErrorCode::kInvalidInput, "view \"" + a.name + "\" is placed in \"" + a.parent + "\" and view \"" + b.name + "\" in \"" +
                                        b.parent + "\"; views must share one parent frame"};
}

// Ideal coordinates of a pick and d ideal / d pixel.
struct Ideal {
  Vector3d ray;                          // (x, y, 1) in the camera
  Matrix2d by_pixel;
};

Result<Ideal> idealOf(const View& view, const Vector2d& pixel) {
  Vector2d n;
  internal::Distorted at;
  if (!pixel.allFinite() || !internal::undistortPixel(view.camera, internal::monotoneRadius2(view.camera), pixel, &n, &at)) {
    return Error{ErrorCode::kInvalidInput, "the pick in view \"" + view.name + "\" has no viewing ray"};
  }
  return Ideal{{n.x(), n.y(), 1}, internal::pixelByNormalised(view.camera, at).inverse()};
}

// Tangent of the curve at a point, from its neighbours.
Vector2d tangentAt(const EpipolarCurve& curve, std::size_t i) {
  const std::size_t before = i > 0 && !curve.points[i].begins_piece ? i - 1 : i;
  const std::size_t after = i + 1 < curve.points.size() && !curve.points[i + 1].begins_piece ? i + 1 : i;
  const Vector2d chord = curve.points[after].pixel - curve.points[before].pixel;
  return chord.norm() > 0 ? Vector2d(chord.normalized()) : Vector2d(1, 0);
}

// Variance across the curve of the second view's pixel of the pick at one depth.
double varianceAcross(const View& from, const Ideal& pick, const View& to, const EpipolarPoint& point, const Vector2d& tangent) {
  const Matrix3d R_WA = from.X_WC.linear();
  const Vector3d X = from.X_WC * Vector3d(point.depth * pick.ray);
  const Vector3d p_B = to.X_WC.linear().transpose() * (X - to.X_WC.translation());
  const auto projection = to.camera.projectWithJacobian(p_B);
  if (!projection) return 0;
  const Eigen::RowVector2d across(-tangent.y(), tangent.x());
  const Eigen::Matrix<double, 2, 3> J = projection->d_point * to.X_WC.linear().transpose();
  // The point is carried by the first camera: it moves as that one turns, moves, or sees the pick elsewhere.
  const Eigen::Matrix<double, 3, 2> by_ideal = point.depth * R_WA.leftCols<2>();
  const Eigen::RowVector2d by_pixel = across * J * by_ideal * pick.by_pixel;
  double variance = by_pixel.squaredNorm() * from.sigma_px * from.sigma_px;
  std::vector<CalibrationEffect> effects;   // two views of one camera share its intrinsics
  addEffect(from, CalibrationPart::kPose, -across * pixelByPose(J, X - from.X_WC.translation()), &effects);
  addEffect(to, CalibrationPart::kPose, across * pixelByPose(J, X - to.X_WC.translation()), &effects);
  addEffect(from, CalibrationPart::kIntrinsics, -by_pixel * pixelByIntrinsics(from.camera, pick.ray.head<2>()), &effects);
  addEffect(to, CalibrationPart::kIntrinsics, across * pixelByIntrinsics(to.camera, p_B.head<2>() / p_B.z()), &effects);
  variance += sharedCovariance(effects, effects)(0, 0);
  return std::max(0.0, variance);
}

}  // namespace

Result<std::vector<double>> epipolarBand(const View& from, const Vector2d& pixel, const View& to, const EpipolarCurve& curve) {
  if (auto status = checkParents(from, to); !status) return status.error();
  const auto pick = idealOf(from, pixel);
  if (!pick) return pick.error();
  std::vector<double> band;
  band.reserve(curve.points.size());
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    band.push_back(std::sqrt(varianceAcross(from, *pick, to, curve.points[i], tangentAt(curve, i))));
  }
  return band;
}

Result<double> epipolarMiss(const View& a, const Vector2d& pixel_a, const View& b, const Vector2d& pixel_b) {
  if (auto status = checkParents(a, b); !status) return status.error();
  const auto pick_a = idealOf(a, pixel_a);
  if (!pick_a) return pick_a.error();
  const auto pick_b = idealOf(b, pixel_b);
  if (!pick_b) return pick_b.error();
  const Vector3d between = a.X_WC.linear().transpose() * (b.X_WC.translation() - a.X_WC.translation());
  if (!(between.norm() > 1e-9)) {
    return Error{ErrorCode::kDegenerate, "both views were taken from the same place: there is no epipolar curve"};
  }
  const Matrix3d E = skew(between) * a.X_WC.linear().transpose() * b.X_WC.linear();
  const Vector3d line_a = E * pick_b->ray, line_b = E.transpose() * pick_a->ray;
  const Vector2d slope_a = pick_a->by_pixel.transpose() * line_a.head<2>();
  const Vector2d slope_b = pick_b->by_pixel.transpose() * line_b.head<2>();
  return pick_a->ray.dot(line_a) / std::sqrt(std::max(1e-300, slope_a.squaredNorm() + slope_b.squaredNorm()));
}

void MissStatistic::add(double miss_px) {
  if (!std::isfinite(miss_px)) return;
  ++m_count;
  m_sum += miss_px;
  m_squares += miss_px * miss_px;
}

double MissStatistic::rmsPx() const { return m_count == 0 ? 0 : std::sqrt(m_squares / m_count); }
double MissStatistic::meanPx() const { return m_count == 0 ? 0 : m_sum / m_count; }

std::string MissStatistic::warning() const {
  if (m_count < kFewPicks || !(rmsPx() > m_warn_rms_px)) return {};
  return "the last " + std::to_string(m_count) + " picks miss their curves by " + formatFixed(rmsPx(), 1) + " px (at most " +
         formatFixed(m_warn_rms_px, 0) + " px are usual): a camera may have been knocked; calibrate again before measuring";
}

}  // namespace longarm::vision
