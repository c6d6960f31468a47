#pragma once

/// @file
/// Whether the views of a calibration are many, spread and tilted enough.

#include <vector>

#include "calibration/intrinsics/calibrate_intrinsics.h"

namespace longarm::calibration {

/// What the used views cover.
struct Coverage {
  double picture = 0;                ///< Part of the 4 x 4 cells of the picture in which a corner was seen, 0 ... 1.
  double tilt_x_deg = 0, tilt_y_deg = 0;  ///< Range of the target's tilt about the picture's axes.
  double size_ratio = 1;             ///< Largest over smallest distance of the target.
  int views = 0;                     ///< Used ones.
};
/// Without a known picture size the cells are those of the corners' bounding box.  Pure function.
Coverage coverageOf(const std::vector<BoardView>& views, const IntrinsicsResult& result);

/// Adds sentences on too few views, small tilts, poor coverage, weak focal lengths, and corners outside the range in
/// which the estimated lens can be inverted.
void appendQualityWarnings(const std::vector<BoardView>& views, IntrinsicsResult* result);

}  // namespace longarm::calibration
