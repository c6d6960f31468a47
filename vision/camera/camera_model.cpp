#include "vision/camera/camera_model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text.h"
#include "vision/camera/lens.h"

namespace longarm::vision {
namespace internal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Root of p between a (p > 0) and b (p <= 0), to the last bit.
template <typename Function>
double bisect(const Function& p, double a, double b) {
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (a + b);
    if (middle == a || middle == b) break;
    (p(middle) > 0 ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

// First positive root of 1 + a s + b s^2 + c s^3, for c != 0.
double firstRootOfCubic(double a, double b, double c) {
  const auto p = [&](double s) { return 1 + s * (a + s * (b + s * c)); };
  const double discriminant = b * b - 3 * a * c;
  double from = 0;
  if (discriminant > 0) {
    const double root = std::sqrt(discriminant);
    double turns[2] = {(-b - root) / (3 * c), (-b + root) / (3 * c)};
    std::sort(turns, turns + 2);
    for (const double turn : turns) {
      if (!(turn > from) || !std::isfinite(turn)) continue;
      if (p(turn) <= 0) return bisect(p, from, turn);
      from = turn;
    }
  }
  if (c > 0) return kInfinity;
  double to = std::max(1e-6, 2 * from);
  while (p(to) > 0 && to < 1e300) to *= 2;
  return to < 1e300 ? bisect(p, from, to) : kInfinity;
}

// Undistorted radius of a radially distorted one, by bracketed Newton on the monotone range.
bool invertRadius(const std::array<double, 5>& d, double max_radius2, double distorted, double* radius) {
  double low = 0, high = std::sqrt(max_radius2);
  const auto f = [&](double r) {
    const double s = r * r;
    return r * (1 + s * (d[0] + s * (d[1] + s * d[4]))) - distorted;
  };
  if (!std::isfinite(high)) {
    high = std::max(1.0, distorted);
    while (f(high) < 0 && high < 1e100) high *= 2;
  }
  if (f(high) < 0) return false;
  double r = std::min(distorted, high);
  for (int i = 0; i < 100; ++i) {
    const double s = r * r;
    const double value = f(r);
    (value < 0 ? low : high) = r;
    const double slope = 1 + s * (3 * d[0] + s * (5 * d[1] + s * 7 * d[4]));
    double next = slope > 0 ? r - value / slope : low - 1;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - r) <= 1e-16 * (1 + r)) break;
    r = next;
  }
  *radius = r;
  return true;
}

// Newton on both coordinates; `n` is the start and the answer.
bool newton(const std::array<double, 5>& d, const Eigen::Vector2d& target, int steps, Eigen::Vector2d* n,
            Distorted* at) {
  double before = kInfinity;
  for (int i = 0; i < steps; ++i) {
    *at = distortWithDerivative(d, n->x(), n->y());
    const double ex = target.x() - at->x, ey = target.y() - at->y;
    const double error2 = ex * ex + ey * ey;
    if (error2 < 1e-27) return true;                          // 3e-14: below 1e-9 px for any focal length in use
    const bool last = error2 < 1e-14;                         // squared by one more step, and `at` good to 1e-7
    if (error2 < 1e-22 && error2 >= 0.25 * before) return true;  // no more digits to gain
    const double determinant = at->xx * at->yy - at->xy * at->xy;
    if (!(std::abs(determinant) > 1e-14)) return false;
    n->x() += (at->yy * ex - at->xy * ey) / determinant;
    n->y() += (at->xx * ey - at->xy * ex) / determinant;
    if (last && std::abs(determinant) > 0.01) return true;
    before = error2;
  }
  return false;
}

}  // namespace

double monotoneRadius2(const CameraModel& camera) {
  const double a = 3 * camera.distortion[0], b = 5 * camera.distortion[1], c = 7 * camera.distortion[4];
  if (c != 0) return firstRootOfCubic(a, b, c);
  if (b == 0) return a < 0 ? -1 / a : kInfinity;
  const double discriminant = a * a - 4 * b;
  if (discriminant < 0) return kInfinity;
  // Of the roots 2 / (-a +- sqrt(a^2 - 4 b)) the first positive one has the larger positive denominator.
  const double denominator = -a + std::sqrt(discriminant);
  return denominator > 0 ? 2 / denominator : kInfinity;
}

bool undistortPixel(const CameraModel& camera, double max_radius2, const Eigen::Vector2d& pixel,
                    Eigen::Vector2d* n, Distorted* at) {
  Eigen::Vector2d target;
  target.y() = (pixel.y() - camera.cy) / camera.fy;
  target.x() = (pixel.x() - camera.cx - camera.skew * target.y()) / camera.fx;
  const auto& d = camera.distortion;
  // The radial inverse as a series (reversion of r + k1 r^3 + k2 r^5 + k3 r^7), then Newton: two or three steps
  // inside ordinary pictures.
  const double r2 = target.squaredNorm();
  const double g = 1 + r2 * (-d[0] + r2 * (3 * d[0] * d[0] - d[1] +
                                           r2 * (d[0] * (8 * d[1] - 12 * d[0] * d[0]) - d[4])));
  *n = g > 0.5 && g < 2 ? Eigen::Vector2d(target * g) : target;
  const double limit = max_radius2 * (1 + 1e-9);
  if (newton(d, target, 12, n, at) && n->squaredNorm() <= limit) return true;
  // Near the edge of the range Newton jumps over it: start from the radial inverse, which is bracketed.
  double radius = 0;
  const double distorted = std::sqrt(r2);
  if (!std::isfinite(r2)) return false;
  if (!invertRadius(d, max_radius2, distorted, &radius)) radius = std::sqrt(max_radius2) * (1 - 1e-6);
  *n = distorted > 0 ? Eigen::Vector2d(target * (radius / distorted)) : Eigen::Vector2d::Zero();
  return newton(d, target, 60, n, at) && n->squaredNorm() <= limit;
}

}  // namespace internal

namespace {

std::string label(const CameraModel& camera) {
  return camera.name.empty() ? std::string("the camera") : "camera \"" + camera.name + "\"";
}

std::string text(const Eigen::Vector2d& pixel) {
  return "(" + formatFixed(pixel.x(), 2) + ", " + formatFixed(pixel.y(), 2) + ")";
}

Error behind(const CameraModel& camera, double z) {
  return {ErrorCode::kDegenerate, "the point is behind " + label(camera) + " (z = " + formatFixed(z, 4) + " m)"};
}

Error beyondRange(const CameraModel& camera, double radius, double limit) {
  return {ErrorCode::kDegenerate, "the point is outside what the lens of " + label(camera) +
                                      " can show: radius " + formatFixed(radius, 3) + " of at most " +
                                      formatFixed(limit, 3) + " in normalised coordinates"};
}

Error badField(const CameraModel& camera, const char* field, double value, const char* expected) {
  return {ErrorCode::kInvalidInput,
          label(camera) + ": " + field + " is " + formatNumber(value) + "; expected " + expected};
}

}  // namespace

Eigen::Matrix3d CameraModel::K() const {
  Eigen::Matrix3d matrix;
  matrix << fx, skew, cx, 0, fy, cy, 0, 0, 1;
  return matrix;
}

bool CameraModel::hasDistortion() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; });
}

double CameraModel::monotoneRadius() const { return std::sqrt(internal::monotoneRadius2(*this)); }

bool CameraModel::containsPixel(const Eigen::Vector2d& pixel, double margin_px) const {
  if (!pixel.allFinite()) return false;
  if (width <= 0 || height <= 0) return true;
  const double edge = 0.5 + margin_px;
  return pixel.x() >= -edge && pixel.y() >= -edge && pixel.x() <= width - 1 + edge &&
         pixel.y() <= height - 1 + edge;
}

Eigen::Vector2d CameraModel::distort(const Eigen::Vector2d& n) const {
  return internal::distort(distortion, n.x(), n.y());
}

Eigen::Vector2d CameraModel::pixelOfNormalised(const Eigen::Vector2d& n) const {
  const Eigen::Vector2d d = distort(n);
  return {fx * d.x() + skew * d.y() + cx, fy * d.y() + cy};
}

Result<Eigen::Vector2d> CameraModel::normalisedOfPixel(const Eigen::Vector2d& pixel) const {
  Eigen::Vector2d n;
  internal::Distorted at;
  if (internal::undistortPixel(*this, internal::monotoneRadius2(*this), pixel, &n, &at)) return n;
  return Error{ErrorCode::kDegenerate, "pixel " + text(pixel) + " of " + label(*this) +
                                           " has no viewing ray: it lies beyond the range in which the lens model "
                                           "can be inverted (radius " +
                                           formatFixed(monotoneRadius(), 3) + " in normalised coordinates)"};
}

Result<Eigen::Vector2d> CameraModel::project(const Eigen::Vector3d& p_C) const {
  if (!(p_C.z() > 1e-9)) return behind(*this, p_C.z());
  const Eigen::Vector2d n = p_C.head<2>() / p_C.z();
  const double limit2 = internal::monotoneRadius2(*this);
  if (!(n.squaredNorm() <= limit2)) return beyondRange(*this, n.norm(), std::sqrt(limit2));
  return pixelOfNormalised(n);
}

Result<ProjectionWithJacobian> CameraModel::projectWithJacobian(const Eigen::Vector3d& p_C) const {
  if (!(p_C.z() > 1e-9)) return behind(*this, p_C.z());
  const double iz = 1 / p_C.z();
  const Eigen::Vector2d n = p_C.head<2>() * iz;
  const double limit2 = internal::monotoneRadius2(*this);
  if (!(n.squaredNorm() <= limit2)) return beyondRange(*this, n.norm(), std::sqrt(limit2));
  const auto at = internal::distortWithDerivative(distortion, n.x(), n.y());
  ProjectionWithJacobian out;
  out.pixel = {fx * at.x + skew * at.y + cx, fy * at.y + cy};
  Eigen::Matrix<double, 2, 3> by_point;
  by_point << iz, 0, -n.x() * iz, 0, iz, -n.y() * iz;
  out.d_point = internal::pixelByNormalised(*this, at) * by_point;
  return out;
}

Result<Eigen::Vector3d> CameraModel::rayOfPixel(const Eigen::Vector2d& pixel) const {
  const auto n = normalisedOfPixel(pixel);
  if (!n) return n.error();
  return Eigen::Vector3d(n->homogeneous().normalized());
}

CameraModel CameraModel::undistorted() const {
  CameraModel ideal = *this;
  ideal.skew = 0;
  ideal.distortion = {};
  return ideal;
}

Status validate(const CameraModel& camera) {
  constexpr double kMaxFocal = 1e7;
  const auto focal = [&](const char* field, double value) -> Status {
    if (value > 0 && value <= kMaxFocal) return {};
    return badField(camera, field, value, "a focal length in pixels, above 0 and at most 1e7");
  };
  if (auto status = focal("fx", camera.fx); !status) return status;
  if (auto status = focal("fy", camera.fy); !status) return status;
  if (!(std::abs(camera.skew) <= camera.fx)) {
    return badField(camera, "skew", camera.skew, "a finite number of pixels, no larger than fx");
  }
  for (const auto& [field, value] : {std::pair<const char*, double>{"cx", camera.cx}, {"cy", camera.cy}}) {
    if (!(std::abs(value) <= 1e6)) return badField(camera, field, value, "a principal point within 1e6 pixels");
  }
  static const char* const kNames[5] = {"k1", "k2", "p1", "p2", "k3"};
  for (std::size_t i = 0; i < 5; ++i) {
    if (!(std::abs(camera.distortion[i]) <= 1e6)) {
      return badField(camera, kNames[i], camera.distortion[i], "a finite distortion coefficient within 1e6");
    }
  }
  for (const auto& [field, value] : {std::pair<const char*, int>{"image_width", camera.width},
                                     {"image_height", camera.height}}) {
    if (value < 0 || value > 65536) return badField(camera, field, value, "0 to 65536 pixels");
  }
  return {};
}

}  // namespace longarm::vision
