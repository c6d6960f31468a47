#pragma once

/// @file
/// Advice: where to hold the board next.

#include <optional>
#include <string>
#include <vector>

#include "calibration/intrinsics/calibrate_intrinsics.h"

namespace longarm::calibration {

/// A board pose that would teach most about the camera.
struct NextView {
  Pose X_CK = Pose::Identity();                ///< Board in the camera.
  double gain_bits = 0;                        ///< Half the gain of log2 det of the information on the lens.
  std::vector<Eigen::Vector2d> outline_px;     ///< The four extreme corners of the board, raw pixels.
  std::string words;                           ///< "upper left, tilted 35 degrees away at the top, ..."
};

/// Tries the board of the first used view at nine places of the picture, two distances and nine tilts and keeps the
/// pose of the largest gain with all corners in the picture.
/// @returns nothing for a camera of unknown size or targets that are not flat.  Pure function.
std::optional<NextView> nextView(const std::vector<BoardView>& views, const IntrinsicsResult& result);

}  // namespace longarm::calibration
