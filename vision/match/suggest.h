#pragma once

/// @file
/// Help with the second pick: where the neighbourhood of the first one is seen again.

#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/match/match_picture.h"
#include "vision/snapshot/view.h"

namespace longarm::vision {

struct MatchOptions {
  double min_depth = 0.15, max_depth = 20;   ///< z in the first camera [m].
  int half_along = 15, half_across = 8;      ///< Half the patch, along and across the epipolar curve [px].
  int across = 3;                            ///< How far off the curve is looked [px].
  std::size_t max_matches = 3;
};

/// A suggestion is offered to an operator (never taken by itself) when its score is above this.
constexpr double kOfferScore = 0.6;

/// A place in the second picture that looks like the pick.
struct Match {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();       ///< Raw pixel of the second view.
  double depth = 0;                                      ///< z in the first camera [m].
  double score = 0;                                      ///< Confidence, 0 ... 1.
  double ambiguity = 0;      ///< 0: nothing else on the curve looks like it; 1: something else looks as much like it.
  double likeness = 0;                                   ///< Zero-mean normalised cross-correlation.
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< Of `pixel` [px^2].
};

/// Suggests matches of a pick along its epipolar curve, best first.
///
/// Patches are warped by the plane that faces both cameras at each assumed depth, compared by zero-mean normalised
/// cross-correlation, and refined to a fraction of a pixel.  The score is the product of how alike the patches are, how
/// much more than the next best place, whether the way back leads to the pick, whether there is texture along the curve at
/// all, and (not in the usual recipe: without them one offer in five is wrong at depth edges) whether the few pixels around
/// the pick and the sides of the patch agree with the whole.  Zero-mean, because cameras with auto-iris differ in brightness.
/// @returns an empty list when nothing is seen again (textureless, hidden, off the second picture), or kInvalidInput: as
///   epipolarCurve(), a pick off its picture, or a picture of another size than its camera's.  Pure function.
Result<std::vector<Match>> suggestMatches(const View& from, const MatchPicture& from_picture, const Eigen::Vector2d& pixel,
                                          const View& to, const MatchPicture& to_picture, const MatchOptions& options = {});

}  // namespace longarm::vision
