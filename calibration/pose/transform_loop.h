#pragma once

/// @file
/// The loop of transforms of SAND2004-6198, equation (3): (U, V, t) = C_int [I|0] T_ext T_kin T_dev T_obj^-1 x, each
/// T mapping coordinates of its right-hand frame into its left-hand one.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "vision/camera/camera_model.h"

namespace longarm::calibration {

/// What may be unknown.
enum class LoopUnknown { kExt, kDev, kObj, kIntrinsics };
/// "T_ext", "T_dev", "T_obj", "C_int"; the other way kInvalidInput listing them.
const char* toString(LoopUnknown unknown);
Result<LoopUnknown> loopUnknownFromText(const std::string& text);

/// One correspondence.
struct LoopPoint {
  Eigen::Vector3d xyz;           ///< x: in the frame that T_obj's parent is seen from [m].
  Eigen::Vector2d pixel;         ///< Raw pixel.
  double sigma_m = 0;            ///< Uncertainty of xyz per axis, such as that of a pick on a mesh [m].
};

/// One snapshot.
struct LoopView {
  std::string name;
  Pose T_kin = Pose::Identity(), T_ext = Pose::Identity(), T_dev = Pose::Identity(), T_obj = Pose::Identity();
  std::vector<LoopPoint> points;
};

/// The measurements and all that is known; where a transform is unknown, the views' values are not used.
struct LoopProblem {
  vision::CameraModel camera;    ///< Size and name only, where the intrinsics are unknown and have no start.
  std::vector<LoopView> views;
};

}  // namespace longarm::calibration
