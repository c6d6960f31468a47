#pragma once

/// @file
/// What one picture says about a camera: pixels of points known in the target's own frame K.

#include <string>
#include <vector>

#include <Eigen/Core>

namespace longarm::calibration {

/// One corner or dot.
struct Corner {
  Eigen::Vector3d xyz;        ///< In the target's frame K [m].
  Eigen::Vector2d pixel;      ///< Raw pixel.
  int line = 0;               ///< In the file it came from, from 1; 0: none.
};

/// All corners of one picture.
struct BoardView {
  std::string name;           ///< Path of the picture, or the name in the corners file.
  std::vector<Corner> corners;
};

}  // namespace longarm::calibration
