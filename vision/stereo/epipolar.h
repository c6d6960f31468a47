#pragma once

/// @file
/// The epipolar curve: where a pick of one view may lie in another, through both lenses.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/snapshot/view.h"

namespace longarm::vision {

struct EpipolarOptions {
  double min_depth = 0.15, max_depth = 20;   ///< z in the first camera [m].
  double max_sag_px = 0.02;                  ///< Chords deviate less than this from the curve.
};

struct EpipolarPoint {
  Eigen::Vector2d pixel;     ///< In the second view, raw.
  double depth = 0;          ///< z in the first camera [m].
  bool begins_piece = false; ///< The curve is hidden between the point before and this one.
};

/// What can be seen of the curve, from near to far: in the second picture and before both cameras.  Nearly
/// always one piece; a lens may bend the curve out of the picture's edge and back, which makes two.
struct EpipolarCurve {
  std::vector<EpipolarPoint> points;        ///< Empty if no part can be seen.
  std::vector<EpipolarPoint> ticks;         ///< Round depths for labels, where they can be seen.

  /// The visible point nearest to a pixel (depth interpolated in inverse depth), or nothing if empty.
  std::optional<EpipolarPoint> nearest(const Eigen::Vector2d& pixel) const;
};

/// @returns kInvalidInput (pixel has no ray, bad depth range, different parents).  Pure function.
Result<EpipolarCurve> epipolarCurve(const View& from, const Eigen::Vector2d& pixel, const View& to,
                                    const EpipolarOptions& options = {});

/// The raw curve for the quickest redraw: n samples at inverse depths uniform from 1/near to 1/far, as pixels of
/// `to`, not clipped to the picture.  `visible[i]` is false behind `to` or beyond its lens' monotone range.
/// @returns false if the pixel has no ray.  @pre 0 < near < far; n >= 2; the arrays hold n.  Pure function.
bool sampleEpipolarCurve(const View& from, const Eigen::Vector2d& pixel, const View& to, double near_m,
                         double far_m, int n, double* u, double* v, bool* visible);

}  // namespace longarm::vision
