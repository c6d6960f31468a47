#include "vision/stereo/triangulate.h"

#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "core/text.h"
#include "vision/stereo/chi_square.h"

namespace longarm::vision {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = 0.017453292519943295;
constexpr std::size_t kMaxSightings = 10000;

struct Ray {
  Vector3d origin, direction;   // in the parent frame; direction of unit length
};

std::string label(const View& view) { return view.name.empty() ? std::string("a view") : "view \"" + view.name + "\""; }

double sigmaOf(const Sighting& sighting) { return sighting.sigma_px > 0 ? sighting.sigma_px : sighting.view->sigma_px; }

// Angle between two lines, 0 ... 90 degrees.
double lineAngle(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), std::abs(a.dot(b))); }

Status checkSightings(const std::vector<Sighting>& sightings) {
  if (sightings.size() < 2 || sightings.size() > kMaxSightings) {
    return {ErrorCode::kInvalidInput, "a point needs picks in two or more views (at most " +
                                          std::to_string(kMaxSightings) + "); there are " +
                                          std::to_string(sightings.size())};
  }
  for (const auto& sighting : sightings) {
    if (sighting.view == nullptr) return {ErrorCode::kInvalidInput, "a pick belongs to no view"};
    const View& view = *sighting.view;
    const View& first = *sightings.front().view;
    if (view.parent != first.parent) {
      return {ErrorCode::kInvalidInput, label(first) + " is placed in \"" + first.parent + "\" and " + label(view) +
                                            " in \"" + view.parent + "\"; views must share one parent frame"};
    }
    if (!sighting.pixel.allFinite()) return {ErrorCode::kInvalidInput, "the pick in " + label(view) + " is not finite"};
    const double sigma = sigmaOf(sighting);
    if (!(sigma > 0 && sigma < 1e6)) {
      return {ErrorCode::kInvalidInput, label(view) + ": sigma_px is " + formatNumber(sigma) + "; expected above 0"};
    }
  }
  return {};
}

Result<std::vector<Ray>> raysOf(const std::vector<Sighting>& sightings) {
  std::vector<Ray> rays;
  for (const auto& sighting : sightings) {
    const auto ray = sighting.view->camera.rayOfPixel(sighting.pixel);
    if (!ray) return Error{ErrorCode::kInvalidInput, label(*sighting.view) + ": " + ray.error().message};
    rays.push_back({sighting.view->X_WC.translation(), sighting.view->X_WC.linear() * *ray});
  }
  return rays;
}

double largestAngle(const std::vector<Vector3d>& directions) {
  double largest = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) largest = std::max(largest, lineAngle(directions[i], directions[j]));
  }
  return largest;
}

double rayParallax(const std::vector<Ray>& rays) {
  std::vector<Vector3d> directions;
  for (const auto& ray : rays) directions.push_back(ray.direction);
  return largestAngle(directions);
}

Error tooParallel(double parallax, double limit) {
  return {ErrorCode::kDegenerate, "the viewing rays are parallel within " + formatFixed(parallax / kDegree, 2) +
                                      " degrees (need " + formatFixed(limit / kDegree, 2) +
                                      "): only the direction is known. Use views farther apart, or go nearer"};
}

Status checkBaseline(const std::vector<Ray>& rays) {
  double longest = 0;
  for (const auto& ray : rays) longest = std::max(longest, (ray.origin - rays.front().origin).norm());
  if (longest > 1e-9) return {};
  return {ErrorCode::kDegenerate, "all views were taken from the same place: only the direction is known"};
}

// Point nearest to all rays: sum (I - v v^T)(X - c) = 0; for two rays the middle of their common perpendicular.
Vector3d nearestPoint(const std::vector<Ray>& rays) {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  const Vector3d& base = rays.front().origin;   // keeps digits when the cameras are far from the parent's origin
  for (const auto& ray : rays) {
    const Matrix3d P = Matrix3d::Identity() - ray.direction * ray.direction.transpose();
    A += P;
    b += P * (ray.origin - base);
  }
  return base + A.ldlt().solve(b);
}

double missDistance(const Ray& a, const Ray& b) {
  const Vector3d normal = a.direction.cross(b.direction);
  const Vector3d between = b.origin - a.origin;
  const double sine = normal.norm();
  if (sine < 1e-9) return between.cross(a.direction).norm();
  return std::abs(between.dot(normal)) / sine;
}

// The normal equations of one Gauss-Newton step at X.
struct Equations {
  Matrix3d H = Matrix3d::Zero();
  Vector3d g = Vector3d::Zero();
  double cost = 0;             // robust, in sigma^2
  double squares = 0;          // plain, in px^2
};

struct Problem {
  const std::vector<Sighting>& sightings;
  double huber;

  Result<Equations> at(const Vector3d& X) const {
    Equations out;
    for (const auto& sighting : sightings) {
      const View& view = *sighting.view;
      const Matrix3d R = view.X_WC.linear();
      const auto projection = view.camera.projectWithJacobian(R.transpose() * (X - view.X_WC.translation()));
      if (!projection) return Error{ErrorCode::kDegenerate, label(view) + ": " + projection.error().message};
      const Vector2d r = sighting.pixel - projection->pixel;
      const double sigma = sigmaOf(sighting);
      const double size = r.norm() / sigma;
      const bool outlying = huber > 0 && size > huber;
      const double weight = (outlying ? huber / size : 1) / (sigma * sigma);
      const Eigen::Matrix<double, 2, 3> J = projection->d_point * R.transpose();
      out.H += weight * J.transpose() * J;
      out.g += weight * J.transpose() * r;
      out.cost += outlying ? huber * (2 * size - huber) : size * size;
      out.squares += r.squaredNorm();
    }
    return out;
  }
};

// Gauss-Newton, damped only where a step fails.
Result<Equations> minimise(const Problem& problem, Vector3d* X) {
  auto equations = problem.at(*X);
  if (!equations) return equations;
  double damping = 0;
  for (int i = 0; i < 50; ++i) {
    Matrix3d H = equations->H;
    H.diagonal() *= 1 + damping;
    const Vector3d step = H.ldlt().solve(equations->g);
    if (!step.allFinite()) break;
    const auto next = problem.at(*X + step);
    const double slack = 1e-12 * (1 + equations->cost);   // rounding near the minimum
    if (!next || next->cost > equations->cost + slack) {
      damping = damping == 0 ? 1e-3 : damping * 10;
      if (damping > 1e8) break;
      continue;
    }
    *X += step;
    equations = next;
    damping = damping > 1e-6 ? damping * 0.1 : 0;
    if (step.squaredNorm() * 1e26 < 1 + X->squaredNorm()) break;
  }
  return equations;
}

Status checkInFront(const std::vector<Sighting>& sightings, const std::vector<Ray>& rays, const Vector3d& X) {
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if ((X - rays[i].origin).dot(rays[i].direction) > 0) continue;
    return {ErrorCode::kDegenerate, "the viewing rays meet behind " + label(*sightings[i].view) +
                                        ": mark the same spot in all of them; if they show it, a view's pose is wrong: calibrate its camera again"};
  }
  return {};
}

// d xyz / d calibration of everything with a known covariance; and the picks' chi-square with it taken into account.
std::vector<CalibrationEffect> effectsAt(const std::vector<Sighting>& sightings, const Vector3d& X,
                                         const Matrix3d& covariance, double* chi2) {
  std::vector<CalibrationEffect> out;
  *chi2 = 0;
  for (const auto& sighting : sightings) {
    const View& view = *sighting.view;
    const Matrix3d R = view.X_WC.linear();
    const Vector3d p_C = R.transpose() * (X - view.X_WC.translation());
    const auto projection = view.camera.projectWithJacobian(p_C);
    if (!projection) continue;
    double variance = sigmaOf(sighting) * sigmaOf(sighting);
    const Eigen::Matrix<double, 2, 3> J = projection->d_point * R.transpose();
    const Eigen::Matrix<double, 3, 2> gain = -covariance * J.transpose() / variance;
    if (knowsPoseError(view)) {
      const Eigen::Matrix<double, 2, 6> by_pose = pixelByPose(J, X - view.X_WC.translation());
      variance += (by_pose * view.pose_covariance * by_pose.transpose()).trace();
      addEffect(view, CalibrationPart::kPose, gain * by_pose, &out);
    }
    if (knowsIntrinsicsError(view)) {
      const Eigen::Matrix<double, 2, 10> by_intrinsics = pixelByIntrinsics(view.camera, p_C.head<2>() / p_C.z());
      variance += (by_intrinsics * view.intrinsics_covariance * by_intrinsics.transpose()).trace();
      addEffect(view, CalibrationPart::kIntrinsics, gain * by_intrinsics, &out);
    }
    *chi2 += (sighting.pixel - projection->pixel).squaredNorm() / variance;
  }
  return out;
}

void addWarnings(const std::vector<Sighting>& sightings, const TriangulationOptions& options, double chi2,
                 TriangulatedPoint* point) {
  for (const auto& sighting : sightings) {
    if (sighting.view->camera.containsPixel(sighting.pixel)) continue;
    point->warnings.push_back("the pick (" + formatFixed(sighting.pixel.x(), 1) + ", " +
                              formatFixed(sighting.pixel.y(), 1) + ") lies outside the picture of " +
                              label(*sighting.view));
  }
  if (point->parallax < options.warn_parallax) {
    point->warnings.push_back("only " + formatFixed(point->parallax / kDegree, 2) +
                              " degrees between the viewing rays: the range is uncertain; use views farther apart");
  }
  double distance = 1e300;
  for (const auto& sighting : sightings) {
    distance = std::min(distance, (point->xyz - sighting.view->X_WC.translation()).norm());
  }
  const double sigma = std::sqrt(Eigen::SelfAdjointEigenSolver<Matrix3d>(point->covariance).eigenvalues()[2]);
  if (sigma > 0.1 * distance) {
    point->warnings.push_back("the range is uncertain by " + formatFixed(100 * sigma / distance, 0) +
                              " % (1 sigma): the stated covariance is a rough guide");
  }
  const int degrees_of_freedom = 2 * static_cast<int>(sightings.size()) - 3;
  if (chi2 > chi2Limit(degrees_of_freedom, kChi2Gross)) {
    point->warnings.push_back("the picks disagree: " + formatFixed(point->reprojection_rms_px, 2) +
                              " px rms, rays miss by " + formatFixed(1e3 * point->miss_m, 1) +
                              " mm; check the picks, then the calibration");
  }
}

}  // namespace

Matrix3d crossCovariance(const TriangulatedPoint& a, const TriangulatedPoint& b) {
  return a.effects.empty() || b.effects.empty() ? Matrix3d::Zero() : Matrix3d(sharedCovariance(a.effects, b.effects));
}

Result<TriangulatedPoint> triangulate(const std::vector<Sighting>& sightings, const TriangulationOptions& options) {
  if (auto status = checkSightings(sightings); !status) return status.error();
  const auto rays = raysOf(sightings);
  if (!rays) return rays.error();
  if (auto status = checkBaseline(*rays); !status) return status.error();
  const double start_parallax = rayParallax(*rays);
  if (!(start_parallax >= options.refuse_parallax)) return tooParallel(start_parallax, options.refuse_parallax);

  TriangulatedPoint point;
  point.xyz = nearestPoint(*rays);
  if (!point.xyz.allFinite()) return tooParallel(start_parallax, options.refuse_parallax);
  if (auto status = checkInFront(sightings, *rays, point.xyz); !status) return status.error();
  const Problem problem{sightings, sightings.size() >= 3 ? options.huber_sigmas : 0};
  const auto equations = minimise(problem, &point.xyz);
  if (!equations) return equations.error();
  if (auto status = checkInFront(sightings, *rays, point.xyz); !status) return status.error();

  std::vector<Vector3d> directions;
  for (const auto& ray : *rays) directions.push_back(point.xyz - ray.origin);
  point.parallax = largestAngle(directions);
  if (!(point.parallax >= options.refuse_parallax)) return tooParallel(point.parallax, options.refuse_parallax);
  point.covariance = equations->H.inverse();
  point.reprojection_rms_px = std::sqrt(equations->squares / (2.0 * static_cast<double>(sightings.size())));
  for (std::size_t i = 0; i < rays->size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) point.miss_m = std::max(point.miss_m, missDistance((*rays)[i], (*rays)[j]));
  }
  double chi2 = 0;
  point.effects = effectsAt(sightings, point.xyz, point.covariance, &chi2);
  point.covariance += crossCovariance(point, point);
  if (!point.covariance.allFinite()) return tooParallel(point.parallax, options.refuse_parallax);
  addWarnings(sightings, options, chi2, &point);
  return point;
}

}  // namespace longarm::vision
