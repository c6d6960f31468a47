#pragma once

/// @file
/// A zoom table from calibrations at single settings.

#include <string>
#include <vector>

#include "core/result.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::calibration {

/// What was made of one setting.
struct ZoomSource {
  std::string file;
  double zoom = 0;
  double refit_px = 0;             ///< Largest error of replacing k3 by k1 k2 p1 p2 in the picture; 0: no k3.
};

struct ZoomFit {
  vision::ZoomCamera camera;
  std::vector<ZoomSource> sources;
  std::vector<std::string> warnings;
};

/// Reads every camera file (.yaml, .yml, .xml) and fixture picture (.csv: x,y,z,u,v) of a folder; the last number in a
/// file's name is its zoom setting ("zcam_0.25.yaml", "0.25.csv").  All poses must be in one frame, the mount's.  A
/// camera file without a pose is taken to stand in the mount's frame.  k3, which the XML cannot hold, is refitted to
/// k1 k2 p1 p2 over the picture.
/// @returns kNotFound, or kInvalidInput naming file and value: no number from 0 to 1 in a name, the same zoom twice,
///   fewer than two settings, an unreadable or degenerate file, or a refit worse than 1 px.
Result<ZoomFit> fitZoom(const std::string& folder);

/// k3 folded into k1 k2 p1 p2 by least squares over a grid of the picture.
/// @param error_px Receives the largest remaining difference.
vision::CameraModel withoutK3(const vision::CameraModel& camera, double* error_px);

}  // namespace longarm::calibration
