#include "vision/match/refine.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Dense>

namespace longarm::vision::internal {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr int kMaxIterations = 20;
constexpr double kFloor = 0.05;        // [px] no match is better than this
constexpr double kSpread = 0.6;        // sigma of the weights over half the patch

struct Spot {
  double along, across;                // [px] in the second picture, from the match
  double value, weight;
};

// The patch, sampled once: places around the match in the second picture and what the first one shows there.
struct Patch {
  std::vector<Spot> spots;
  Vector2d tangent, normal;
  double weight = 0, squares = 0;      // sums; squares about the mean, which is taken off the values
};

Patch patchOf(const MatchPicture& from, const LocalWarp& warp, const Vector2d& tangent, const RefineOptions& options) {
  Patch patch;
  patch.tangent = tangent;
  patch.normal = {-tangent.y(), tangent.x()};
  double mean = 0;
  for (int i = -options.half_along; i <= options.half_along; ++i) {
    for (int k = -options.half_across; k <= options.half_across; ++k) {
      const Vector2d p = warp.from + warp.from_by_to * (i * patch.tangent + k * patch.normal);
      const double a = i / (kSpread * options.half_along), b = k / (kSpread * options.half_across);
      const double value = from.cubic(static_cast<float>(p.x()), static_cast<float>(p.y())).value;
      patch.spots.push_back({static_cast<double>(i), static_cast<double>(k), value, std::exp(-0.5 * (a * a + b * b))});
      patch.weight += patch.spots.back().weight;
      mean += patch.spots.back().weight * value;
    }
  }
  mean /= patch.weight;
  for (auto& spot : patch.spots) {
    spot.value -= mean;
    patch.squares += spot.weight * spot.value * spot.value;
  }
  return patch;
}

// What is sought: where the patch lies, how the surface slopes, and how the brightness differs.
struct State {
  Vector2d at, slope;
  double gain = 1, offset = 0;
};

// Sums of the normal equations in (along, across, slope, gain, offset).
struct Sums {
  Matrix6 H = Matrix6::Zero();
  Vector6 g = Vector6::Zero();
  double mean = 0, squares = 0, product = 0, residual = 0;
  double slopes_along = 0;             // plain sum of the squared grey slopes along the curve

  double zncc(const Patch& patch) const { return product / std::sqrt(std::max(1e-12, squares * patch.squares)); }
};

Sums sumsAt(const Patch& patch, const MatchPicture& to, const State& state) {
  Sums sums;
  double second = 0;
  for (const auto& spot : patch.spots) {
    const double along = spot.along + state.slope.x() * spot.along + state.slope.y() * spot.across;
    const Vector2d p = state.at + along * patch.tangent + spot.across * patch.normal;
    const GreySample s = to.cubic(static_cast<float>(p.x()), static_cast<float>(p.y()));
    const double r = state.gain * spot.value + state.offset - s.value;
    const double by_along = s.du * patch.tangent.x() + s.dv * patch.tangent.y();
    Vector6 J;
    J << by_along, s.du * patch.normal.x() + s.dv * patch.normal.y(), by_along * spot.along, by_along * spot.across, -spot.value, -1;
    sums.H.selfadjointView<Eigen::Lower>().rankUpdate(J, spot.weight);
    sums.g += spot.weight * r * J;
    sums.residual += spot.weight * r * r;
    sums.mean += spot.weight * s.value;
    second += spot.weight * static_cast<double>(s.value) * s.value;
    sums.product += spot.weight * spot.value * s.value;   // the values' mean is zero
    sums.slopes_along += by_along * by_along;
  }
  sums.H = Matrix6(sums.H.selfadjointView<Eigen::Lower>());
  sums.mean /= patch.weight;
  sums.squares = second - patch.weight * sums.mean * sums.mean;
  return sums;
}

// Variance of one pixel's residual.  Smoothing takes noise off each pixel but ties neighbours together: over a patch the
// noise of the picture as taken counts.
double varianceOf(const Sums& sums, const Patch& patch, const MatchPicture& to, double gain) {
  return std::max(to.noise() * to.noise() * (1 + gain * gain), sums.residual / patch.weight);
}

// What is known beforehand, in the units of the sums: calibration holds the match to the curve, surfaces are not steep.
Vector6 priorOf(const RefineOptions& options, double variance) {
  const double slope = variance / (options.slope_sigma * options.slope_sigma);
  Vector6 prior = Vector6::Zero();
  prior << 0, variance / (options.across_sigma_px * options.across_sigma_px), slope, slope, 0, 0;
  return prior;
}

// Cuts the covariance off below: interpolation and sampling are never perfect.
Matrix2d floored(const Matrix2d& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix2d> eigen(covariance);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(kFloor * kFloor).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

std::optional<RefinedMatch> refineMatch(const MatchPicture& from, const LocalWarp& warp, const Vector2d& tangent,
                                        const MatchPicture& to, const RefineOptions& options, const Vector2d& start) {
  const Patch patch = patchOf(from, warp, tangent, options);
  State state{warp.to, start};
  Sums sums = sumsAt(patch, to, state);
  state.gain = sums.product / std::max(1e-9, patch.squares);
  state.offset = sums.mean;
  if (!(state.gain > 0)) return std::nullopt;
  for (int i = 0; i < kMaxIterations; ++i) {
    sums = sumsAt(patch, to, state);
    const Vector6 prior = priorOf(options, varianceOf(sums, patch, to, state.gain));
    Vector6 off = Vector6::Zero();
    off << 0, patch.normal.dot(state.at - warp.to), state.slope - start, 0, 0;
    sums.H.diagonal() += prior;
    sums.g -= prior.cwiseProduct(off);
    const Vector6 step = sums.H.ldlt().solve(sums.g);
    if (!step.allFinite()) return std::nullopt;
    const double length = step.head<2>().norm();
    state.at += (step[0] * patch.tangent + step[1] * patch.normal) * std::min(1.0, 1 / std::max(1e-12, length));
    state.slope += step.segment<2>(2);
    state.gain += step[4];
    state.offset += step[5];
    if (!((state.at - warp.to).norm() <= options.max_shift_px) || !(state.gain > 0)) return std::nullopt;
    if (length < 1e-3) break;
  }
  sums = sumsAt(patch, to, state);
  const double variance = varianceOf(sums, patch, to, state.gain);
  Matrix6 information = sums.H;
  information.diagonal() += priorOf(options, variance);
  const Matrix6 inverse = variance * information.inverse();
  Matrix2d axes;
  axes << patch.tangent, patch.normal;
  RefinedMatch match;
  match.pixel = state.at;
  match.slope = state.slope;
  match.zncc = sums.zncc(patch);
  match.misfit = std::sqrt(sums.residual / patch.weight / (to.noiseLeft() * to.noiseLeft() * (1 + state.gain * state.gain)));
  match.sigma_along = std::sqrt(std::max(0.0, inverse(0, 0)));
  match.off_curve = patch.normal.dot(state.at - warp.to);
  match.texture = std::sqrt(sums.slopes_along / static_cast<double>(patch.spots.size())) / to.noiseLeft();
  match.covariance = floored(axes * inverse.topLeftCorner<2, 2>() * axes.transpose());
  if (!match.covariance.allFinite()) return std::nullopt;
  return match;
}

}  // namespace longarm::vision::internal
