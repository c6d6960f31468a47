#pragma once

/// @file
/// Pictures of surfaces made by arithmetic: no files, always the same.

#include <string>

#include <opencv2/core/mat.hpp>

namespace longarm::scene::internal {

struct Surface {
  cv::Mat picture;               ///< 8-bit BGR that tiles; empty: unknown name.  Mean about 200, so that it tints.
  double tile_m = 1;             ///< Edge of one tile [m].
};

/// "wood", "concrete", "metal", "checker", "carton", "noise", "chessboard" (squares of 30 mm), "dots" (of 12 mm,
/// 40 mm apart).  Pure function.
Surface makeSurface(const std::string& name);

}  // namespace longarm::scene::internal
