#pragma once

/// @file
/// Sub-pixel refinement of a match by least squares on the grey levels.

#include <optional>

#include <Eigen/Core>

#include "vision/match/match_picture.h"
#include "vision/match/plane_warp.h"

namespace longarm::vision::internal {

struct RefineOptions {
  int half_along = 15, half_across = 8;  ///< Half the patch [px].
  double max_shift_px = 2;               ///< Farther from the start than this is no refinement.
  /// How far off the curve the calibration may put the truth, 1 sigma: holds a match on an edge that runs across it.
  double across_sigma_px = 1;
  /// How much the surface may slope against the plane that the warp assumes: stretch and shear along the curve, 1 sigma.
  double slope_sigma = 0.2;
};

struct RefinedMatch {
  Eigen::Vector2d pixel;                 ///< In the second picture.
  Eigen::Matrix2d covariance;            ///< [px^2], at least 0.05 px in every direction.
  double zncc = 0;                       ///< At `pixel`, pixels near the middle counting more.
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();   ///< Change of the shift along the curve, per pixel along and across it.
  double misfit = 0;                     ///< RMS difference of the patches over what noise alone makes: 1 is perfect.
  double sigma_along = 0, off_curve = 0; ///< Standard deviation along the curve; distance from the start across it [px].
  double texture = 0;                    ///< RMS grey slope along the curve over what is left of the noise; about 1 is noise.
};

/// Finds gain, offset, shift and the surface's slope that make the warped patch of the first picture most like the second one
/// (Gauss-Newton, bicubic interpolation), starting at warp.to with slope `start`.  The slope departs from the usual
/// shift alone: without it a slanted surface biases the match by tenths of a pixel.
/// @param tangent Of the epipolar curve at the start, unit.
/// @returns nothing when it runs away from the start or there is no texture.  Pure function.
std::optional<RefinedMatch> refineMatch(const MatchPicture& from, const LocalWarp& warp, const Eigen::Vector2d& tangent,
                                        const MatchPicture& to, const RefineOptions& options,
                                        const Eigen::Vector2d& start = Eigen::Vector2d::Zero());

}  // namespace longarm::vision::internal
