#include "vision/match/snap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace longarm::vision {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

constexpr int kHalfWindow = 5;           // [px] of the corner's neighbourhood
constexpr double kWindowSigma = 2.5;     // [px]
constexpr double kMinRoundness = 0.1;    // smaller over larger eigenvalue: below, it is an edge
constexpr double kStep = 0.5;            // [px] across an edge
constexpr double kSmoothing = 1;         // [px] sigma
constexpr double kNoiseSlope = 0.2;      // RMS slope that noise of 1 leaves after smoothing by 1 px: 1 / sqrt(8 pi)

GreySample sampleAt(const MatchPicture& picture, const Vector2d& at) {
  return picture.cubic(static_cast<float>(at.x()), static_cast<float>(at.y()));
}

bool inside(const MatchPicture& picture, const Vector2d& at) {
  return at.x() >= 0 && at.y() >= 0 && at.x() <= picture.width() - 1 && at.y() <= picture.height() - 1;
}

// Weighted sums of the grey slopes around a place.
struct Moments {
  Matrix2d A = Matrix2d::Zero();         // sum w g g^T
  Vector2d b = Vector2d::Zero();         // sum w g g^T x, x from the middle
  double weight = 0;

  double least() const { return Eigen::SelfAdjointEigenSolver<Matrix2d>(A).eigenvalues()[0]; }
  double most() const { return Eigen::SelfAdjointEigenSolver<Matrix2d>(A).eigenvalues()[1]; }
};

Moments momentsAt(const MatchPicture& picture, const Vector2d& middle) {
  Moments sums;
  for (int row = -kHalfWindow; row <= kHalfWindow; ++row) {
    for (int column = -kHalfWindow; column <= kHalfWindow; ++column) {
      const Vector2d x(column, row);
      const GreySample s = sampleAt(picture, middle + x);
      const double w = std::exp(-0.5 * x.squaredNorm() / (kWindowSigma * kWindowSigma));
      const Vector2d g(s.du, s.dv);
      const Matrix2d G = w * g * g.transpose();
      sums.A += G;
      sums.b += G * x;
      sums.weight += w;
    }
  }
  return sums;
}

bool isCorner(const Moments& sums, double min_slope) {
  return sums.least() > sums.weight * min_slope * min_slope && sums.least() > kMinRoundness * sums.most();
}

// The most corner-like whole place within reach, then where the slopes meet.
std::optional<Vector2d> cornerNear(const MatchPicture& picture, const Vector2d& pixel, double min_slope, double radius) {
  Vector2d best = pixel;
  double strength = 0;
  const int reach = static_cast<int>(std::ceil(radius));
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const Vector2d at = pixel + Vector2d(column, row);
      if (Vector2d(column, row).norm() > radius || !inside(picture, at)) continue;
      const Moments sums = momentsAt(picture, at);
      if (sums.least() <= strength || !isCorner(sums, min_slope)) continue;
      strength = sums.least();
      best = at;
    }
  }
  if (!(strength > 0)) return std::nullopt;
  for (int i = 0; i < 20; ++i) {
    const Moments sums = momentsAt(picture, best);
    if (!isCorner(sums, min_slope)) return std::nullopt;
    const Vector2d step = sums.A.ldlt().solve(sums.b);
    if (!step.allFinite() || step.norm() > 3) return std::nullopt;
    best += step;
    if (step.norm() < 1e-3) break;
  }
  if ((best - pixel).norm() > radius + 1 || !inside(picture, best)) return std::nullopt;
  return best;
}

// Slope of the grey along `across`, mean of three places along the edge.
double slopeAcross(const MatchPicture& picture, const Vector2d& at, const Vector2d& across) {
  const Vector2d along(-across.y(), across.x());
  double sum = 0;
  for (const double t : {-1.0, 0.0, 1.0}) {
    const GreySample s = sampleAt(picture, at + t * along);
    sum += s.du * across.x() + s.dv * across.y();
  }
  return sum / 3;
}

// The nearest place where the slope along `across` is steepest.
std::optional<double> steepestNear(const MatchPicture& picture, const Vector2d& pixel, const Vector2d& across, double min_slope,
                                   double radius) {
  const int steps = static_cast<int>(radius / kStep);
  std::optional<double> best;
  double before = std::abs(slopeAcross(picture, pixel - (steps + 1) * kStep * across, across));
  double here = std::abs(slopeAcross(picture, pixel - steps * kStep * across, across));
  for (int i = -steps; i <= steps; ++i) {
    const double after = std::abs(slopeAcross(picture, pixel + (i + 1) * kStep * across, across));
    if (here > before && here >= after && here > min_slope) {
      const double bend = before - 2 * here + after;
      const double at = kStep * (i + (bend < 0 ? 0.5 * (before - after) / bend : 0));
      if (!best || std::abs(at) < std::abs(*best)) best = at;
    }
    before = here;
    here = after;
  }
  return best;
}

std::optional<SnapPoint> edgeNear(const MatchPicture& picture, const Vector2d& pixel, double min_slope, double radius) {
  // Whole places around, nearest first: the strongest slope's direction says how the edge runs.
  Vector2d direction = Vector2d::Zero();
  double strongest = 0;
  const int reach = static_cast<int>(std::ceil(radius));
  for (int row = -reach; row <= reach; ++row) {
    for (int column = -reach; column <= reach; ++column) {
      const double distance = Vector2d(column, row).norm();
      if (distance > radius) continue;
      const GreySample s = sampleAt(picture, pixel + Vector2d(column, row));
      const double size = std::hypot(s.du, s.dv) * std::exp(-0.5 * std::pow(distance / (0.5 * radius), 2));
      if (size <= strongest) continue;
      strongest = size;
      direction = {s.du, s.dv};
    }
  }
  if (!(direction.norm() > min_slope)) return std::nullopt;
  SnapPoint out;
  out.kind = SnapKind::kEdge;
  out.pixel = pixel;
  Vector2d across = direction.normalized();
  for (int i = 0; i < 3; ++i) {   // the slope's direction is best known on the edge itself
    const auto shift = steepestNear(picture, out.pixel, across, min_slope, i == 0 ? radius : 1.5);
    if (!shift) return std::nullopt;
    out.pixel += *shift * across;
    const Moments sums = momentsAt(picture, out.pixel);
    const Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(sums.A);
    across = eigen.eigenvectors().col(1);
  }
  if ((out.pixel - pixel).norm() > radius || !inside(picture, out.pixel)) return std::nullopt;
  out.along = {-across.y(), across.x()};
  return out;
}

}  // namespace

std::optional<SnapPoint> snapPick(const MatchPicture& picture, const Vector2d& pixel, const SnapOptions& options) {
  if (!pixel.allFinite() || !inside(picture, pixel) || !(options.radius_px > 0)) return std::nullopt;
  const double radius = std::min(options.radius_px, 50.0);
  const double min_slope = options.min_contrast_sigmas * picture.noise() * kNoiseSlope;
  const MatchPicture smooth = picture.blurred(kSmoothing);
  if (options.corners) {
    if (const auto corner = cornerNear(smooth, pixel, min_slope, radius)) return SnapPoint{SnapKind::kCorner, *corner, Vector2d::Zero()};
  }
  if (options.edges) return edgeNear(smooth, pixel, min_slope, radius);
  return std::nullopt;
}

}  // namespace longarm::vision
