#pragma once

/// @file
/// Closed-form starts for two unknown transforms, from target poses seen in several views.

#include <optional>
#include <vector>

#include "core/pose.h"

namespace longarm::calibration {

/// One view: P = T_ext K Y.
struct HandEyePair {
  Pose K;          ///< T_kin.
  Pose P;          ///< Target in the camera, found from this view alone.
};

struct HandEyeStart {
  Pose T_ext, Y;
};

/// Solves P_k = T_ext K_k Y: the rotation from the rotation vectors of all pairs' relative motions (Park and Martin,
/// "Robot sensor calibration: solving AX = XB on the Euclidean group", IEEE Trans. Robotics and Automation 10(5),
/// 1994), then the translation by linear least squares.
/// @returns nothing with fewer than two pairs.  Without two rotation axes the answer is one of many.
std::optional<HandEyeStart> handEyeStart(const std::vector<HandEyePair>& pairs);

}  // namespace longarm::calibration
