#pragma once

/// @file
/// Where along an epipolar curve the neighbourhood of a pick is seen again.

#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/match/match_picture.h"
#include "vision/match/plane_warp.h"
#include "vision/stereo/epipolar.h"

namespace longarm::vision::internal {

struct CurveSearchOptions {
  double min_depth = 0.15, max_depth = 20;   ///< z in the first camera [m].
  int half_along = 15, half_across = 8;      ///< Half the patch, along and across the curve [px].
  int across = 3;                            ///< How far off the curve is looked [px].
};

/// A local maximum of the likeness.
struct CurvePeak {
  LocalWarp warp;                        ///< `to` is the place found, to half a pixel.
  Eigen::Vector2d tangent;               ///< Of the curve there; unit.
  double depth = 0;                      ///< [m]
  double zncc = 0;                       ///< Zero-mean normalised cross-correlation, -1 ... 1.
};

/// Compares every half pixel along the visible curve and `across` pixels to both sides of it.  The patch is warped anew
/// wherever the assumed depth changes its shape.
/// @returns all local maxima, highest first (none if nothing of the curve can be seen), or as epipolarCurve().
Result<std::vector<CurvePeak>> searchCurve(const View& from, const MatchPicture& from_picture, const Eigen::Vector2d& pixel,
                                           const View& to, const MatchPicture& to_picture, const CurveSearchOptions& options);

}  // namespace longarm::vision::internal
