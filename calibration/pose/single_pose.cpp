#include "calibration/pose/single_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include <Eigen/Cholesky>

#include "calibration/pose/global_start.h"
#include "calibration/solve/lens_parameters.h"

namespace longarm::calibration {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSameRotation = 0.0175;   // [rad]
constexpr std::size_t kMostCandidates = 8;

double cauchy(double squares, double threshold, double* weight) {
  if (threshold <= 0) {
    *weight = 1;
    return squares;
  }
  const double c2 = threshold * threshold;
  *weight = 1 / (1 + squares / c2);
  return c2 * std::log1p(squares / c2);
}

struct Equations {
  Matrix6d H = Matrix6d::Zero();           // lower half while it is summed up
  Vector6d g = Vector6d::Zero();
  double cost = 0;
};

// Adds w row row^T and w r row.
void addRow(const double* row, double w, double r, double* H, double* g) {
  int at = 0;
  for (int i = 0; i < 6; ++i) {
    const double wi = w * row[i];
    for (int j = 0; j <= i; ++j) H[at++] += wi * row[j];
    g[i] += wi * r;
  }
}

Equations equationsOf(const vision::CameraModel& camera, const std::vector<PoseObservation>& observations,
                      const Pose& T, double threshold) {
  Equations e;
  double H[21] = {}, g[6] = {};
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> d_point;
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d t = T.translation();
  for (const auto& o : observations) {
    if (o.weight <= 0) continue;
    const Eigen::Vector3d turned = R * o.y;
    if (!projectWithPointDerivative(camera, o.A.linear() * (turned + t) + o.A.translation(), &pixel, &d_point)) {
      e.cost = kInfinity;
      return e;
    }
    const Eigen::Vector2d r = o.pixel - pixel;
    double robust = 1;
    e.cost += o.weight * cauchy(r.squaredNorm(), threshold, &robust);
    const Eigen::Matrix<double, 2, 3> M = d_point * o.A.linear();
    for (int k = 0; k < 2; ++k) {
      const double m0 = M(k, 0), m1 = M(k, 1), m2 = M(k, 2);
      // -m [turned]x, then m
      const double row[6] = {turned.y() * m2 - turned.z() * m1, turned.z() * m0 - turned.x() * m2, turned.x() * m1 - turned.y() * m0, m0, m1, m2};
      addRow(row, o.weight * robust, r[k], H, g);
    }
  }
  int at = 0;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) e.H(i, j) = e.H(j, i) = H[at++];
    e.g[i] = g[i];
  }
  return e;
}

Vector6d solve(const Matrix6d& H, const Vector6d& g, double damping) {
  Vector6d scale;
  for (int i = 0; i < 6; ++i) scale[i] = H(i, i) > 0 ? 1 / std::sqrt(H(i, i)) : 1;
  Matrix6d A = scale.asDiagonal() * H * scale.asDiagonal();
  A.diagonal().array() += damping + 1e-15;
  return scale.asDiagonal() * Vector6d(A.ldlt().solve(Vector6d(scale.asDiagonal() * g)));
}

// Samples of four different observations.
std::vector<PoseObservation> sample(const std::vector<PoseObservation>& from, std::mt19937_64* random) {
  std::vector<PoseObservation> out;
  std::vector<std::size_t> taken;
  while (out.size() < 4) {
    const std::size_t i = (*random)() % from.size();
    if (std::find(taken.begin(), taken.end(), i) != taken.end()) continue;
    taken.push_back(i);
    out.push_back(from[i]);
    out.back().weight = 1;
  }
  return out;
}

int countInliers(const vision::CameraModel& camera, const std::vector<PoseObservation>& observations, const Pose& T,
                 double threshold, double* miss) {
  int count = 0;
  *miss = 0;
  for (const auto& o : observations) {
    const double r = missOf(camera, o, T);
    if (r <= threshold) ++count;
    *miss += std::min(r, threshold);
  }
  return count;
}

Result<std::vector<RayToPoint>> raysOf(const vision::CameraModel& camera,
                                       const std::vector<PoseObservation>& observations) {
  std::vector<RayToPoint> rays;
  for (const auto& o : observations) {
    if (o.weight <= 0) continue;
    const auto ray = camera.rayOfPixel(o.pixel);
    if (!ray) return ray.error();
    const Eigen::Matrix3d back = o.A.linear().transpose();
    rays.push_back({-back * o.A.translation(), (back * *ray).normalized(), o.y});
  }
  return rays;
}

void addDistinct(const PoseFit& fit, std::vector<PoseFit>* found) {
  if (!fit.in_front || !std::isfinite(fit.cost)) return;
  for (auto& known : *found) {
    if (angleBetween(known.T.linear(), fit.T.linear()) > kSameRotation) continue;
    if (fit.cost < known.cost) known = fit;
    return;
  }
  found->push_back(fit);
}

}  // namespace

std::vector<PoseObservation> observationsOf(const LoopProblem& problem, LoopUnknown unknown) {
  std::vector<PoseObservation> out;
  for (std::size_t k = 0; k < problem.views.size(); ++k) {
    const LoopView& v = problem.views[k];
    const Pose V = v.T_obj.inverse();
    const Pose A = unknown == LoopUnknown::kExt   ? Pose::Identity()
                   : unknown == LoopUnknown::kDev ? v.T_ext * v.T_kin
                                                  : v.T_ext * v.T_kin * v.T_dev;
    const Pose right = unknown == LoopUnknown::kExt   ? v.T_kin * v.T_dev * V
                       : unknown == LoopUnknown::kDev ? V
                                                      : Pose::Identity();
    for (std::size_t i = 0; i < v.points.size(); ++i) {
      out.push_back({A, right * v.points[i].xyz, v.points[i].pixel, 1, static_cast<int>(k), static_cast<int>(i)});
    }
  }
  const auto key = [](const PoseObservation& o) {
    return std::make_tuple(o.pixel.x(), o.pixel.y(), o.y.x(), o.y.y(), o.y.z(), o.A(0, 3), o.A(1, 3), o.A(2, 3));
  };
  std::stable_sort(out.begin(), out.end(), [&](const PoseObservation& a, const PoseObservation& b) { return key(a) < key(b); });
  return out;
}

double missOf(const vision::CameraModel& camera, const PoseObservation& o, const Pose& T) {
  Eigen::Vector2d pixel;
  return projectPoint(camera, o.A * (T * o.y), &pixel) ? (o.pixel - pixel).norm() : kInfinity;
}

PoseFit refinePose(const vision::CameraModel& camera, const std::vector<PoseObservation>& observations,
                   const Pose& start, double cauchy_px, int max_iterations) {
  PoseFit fit{start, 0, 0, false};
  Equations e = equationsOf(camera, observations, start, cauchy_px);
  fit.cost = e.cost;
  if (!std::isfinite(e.cost)) return fit;
  fit.in_front = true;
  double damping = 0;
  for (int trial = 0; trial < 4 * max_iterations && fit.iterations < max_iterations; ++trial) {
    const Vector6d step = solve(e.H, e.g, damping);
    const double promise = step.dot(e.g);
    if (!(promise > 1e-13 * fit.cost + 1e-22)) break;
    const Pose T = moved(fit.T, step);
    const Equations there = equationsOf(camera, observations, T, cauchy_px);
    if (there.cost <= fit.cost) {
      fit.T = T;
      ++fit.iterations;
      e = there;
      fit.cost = e.cost;
      damping = damping < 1e-8 ? 0 : 0.1 * damping;
    } else {
      damping = damping == 0 ? 1e-4 : 8 * damping;
      if (damping > 1e10) break;
    }
  }
  return fit;
}

Result<std::vector<PoseFit>> findPoses(const vision::CameraModel& camera,
                                       const std::vector<PoseObservation>& observations, const Pose* start) {
  const auto rays = raysOf(camera, observations);
  if (!rays) return rays.error();
  std::vector<PoseFit> found;
  if (start != nullptr) addDistinct(refinePose(camera, observations, *start), &found);
  const auto fits = fitRays(*rays);
  for (std::size_t i = 0; i < fits.size() && i < kMostCandidates; ++i) {
    addDistinct(refinePose(camera, observations, fits[i].T), &found);
  }
  if (found.empty()) {
    return Error{ErrorCode::kNoSolution, "no pose puts all points in front of the camera; check the labels, the transforms' directions and the units (metres)"};
  }
  std::stable_sort(found.begin(), found.end(), [](const PoseFit& a, const PoseFit& b) { return a.cost < b.cost; });
  return found;
}

Result<PoseFit> findPoseAmongOutliers(const vision::CameraModel& camera,
                                      const std::vector<PoseObservation>& observations, double threshold_px,
                                      std::vector<bool>* inliers) {
  std::mt19937_64 random(20040617);
  const auto n = static_cast<int>(observations.size());
  PoseFit best;
  int best_count = 0, samples = 400;
  double best_miss = kInfinity;
  for (int s = 0; s < samples; ++s) {
    const auto rays = raysOf(camera, sample(observations, &random));
    if (!rays) continue;
    const auto fits = fitRays(*rays);
    for (std::size_t i = 0; i < fits.size() && i < 3; ++i) {
      double miss = 0;
      const int count = countInliers(camera, observations, fits[i].T, threshold_px, &miss);
      if (miss >= best_miss) continue;
      best_miss = miss;
      best_count = count;
      best.T = fits[i].T;
      const double part = std::clamp(static_cast<double>(count) / n, 0.05, 0.99);
      samples = std::min(samples, s + 1 + static_cast<int>(std::log(1e-4) / std::log(1 - std::pow(part, 4))));
    }
  }
  if (best_count < 4) return Error{ErrorCode::kNoSolution, "no four observations agree on a pose; check labels, units and transforms"};
  auto weighted = observations;
  for (auto& o : weighted) o.weight = missOf(camera, o, best.T) < 4 * threshold_px ? 1 : 0;
  best = refinePose(camera, weighted, best.T, threshold_px);
  inliers->clear();
  for (std::size_t i = 0; i < observations.size(); ++i) inliers->push_back(missOf(camera, observations[i], best.T) <= threshold_px);
  return best;
}

}  // namespace longarm::calibration
