#pragma once

/// @file
/// observations.json: correspondences over views of a transform loop.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/pose/transform_loop.h"
#include "core/result.h"

namespace longarm::calibration {

struct Observations {
  LoopProblem problem;
  /// T_ext, T_dev, T_obj as far as the file gives them for all views (or, as starts, in its first view with one).
  std::array<std::optional<Pose>, 3> given;
  std::array<std::string, 3> parents = {"camera", "device_base", "object"};  ///< Their left-hand frames' names.
  bool has_camera = false;
  std::optional<double> sigma_px;
};

/// Reads `{"camera": file or object, "views": [{"name", "T_kin", "points": [{"xyz", "u", "v"}]}], "T_ext", "T_dev",
/// "T_obj"}`; transforms that hold for all views stand at the top, a view may override; further keys `zoom`,
/// `sigma_px`, and `sigma_m` of a point.  The camera file's path is relative to this file.
/// @param unknowns These transforms (and the camera) may be missing.
/// @returns kNotFound, or kInvalidInput naming file, view, key and value.
Result<Observations> readObservations(const std::string& path, const std::vector<LoopUnknown>& unknowns);

}  // namespace longarm::calibration
