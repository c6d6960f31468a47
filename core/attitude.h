#pragma once

/// @file
/// Attitude: which way is up, as a sensor tells it.

#include <Eigen/Core>

namespace longarm {

/// A value.
struct Attitude {
  double stamp_s = 0;                                        ///< On the console's clock [s].
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();             ///< Unit, against gravity, in the sensor's frame.
};

}  // namespace longarm
