#pragma once

/// @file
/// How two calibrations of one camera differ, in pixels and in millimetres at a working depth.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/camera/camera_file.h"

namespace longarm::calibration {

/// One place of the picture.
struct CameraDifference {
  Eigen::Vector2d pixel;               ///< In camera A.
  Eigen::Vector2d difference_px;       ///< Where B sees the same ray, minus `pixel`.
  double miss_m = 0;                   ///< Distance of the two cameras' points at the working depth.
  double after_turn_px = 0;            ///< Length left once the best turn of B is taken out.
};

struct CameraComparison {
  std::vector<CameraDifference> map;   ///< Row by row.
  int columns = 0, rows = 0;
  double depth_m = 0;
  double rms_px = 0, max_px = 0, max_mm = 0;
  double after_turn_rms_px = 0;        ///< What a turned mount cannot explain: the lens itself changed.
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   ///< The best turn of B against A, rotation vector [rad].
  /// Root mean square of (B - A) over its sigma, over the parameters that either file gives a variance for; nothing
  /// where neither does.  About 1 for two honest calibrations of an unchanged camera.
  std::optional<double> sigmas;
};

/// @param depth_m Working depth of the millimetres [m], > 0.
/// @param use_poses Compares rays in the poses' common parent rather than in the cameras' own frames.
/// @returns kInvalidInput: pictures of different size, a size that is unknown in both files, poses missing or in
///   different frames.  Pure function.
Result<CameraComparison> compareCameras(const vision::CameraFile& a, const vision::CameraFile& b, double depth_m, bool use_poses = false);

}  // namespace longarm::calibration
