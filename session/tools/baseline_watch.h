#pragma once

/// @file
/// Whether two pictures can measure anything together, told before the operator spends time on them.

#include <string>

#include "vision/snapshot/view.h"

namespace longarm::session {

/// How two views stand to each other, at the depth where their axes meet or, where that is out of an arm's
/// reach, at 1.5 m.
struct Baseline {
  double distance_m = 0;                   ///< Between the cameras.
  double depth_m = 1.5;                    ///< Looked at.
  double parallax = 0;                     ///< Angle between the lines of sight there [rad].
  double depth_sigma_m = 0;                ///< Of a point picked in both there.
  double overlap = 0;                      ///< Share of the first picture that the second sees, at the best of several depths.
};
/// @pre the views share a parent.  Pure function.
Baseline baselineOf(const vision::View& a, const vision::View& b);

/// A sentence with what to do; empty when they are a good pair.
std::string baselineWarning(const vision::View& a, const vision::View& b);

}  // namespace longarm::session
