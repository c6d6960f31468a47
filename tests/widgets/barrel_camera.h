#pragma once

/// @file
/// A wide camera with strong barrel distortion, whose straightened picture differs from the raw one everywhere.

#include "vision/camera/camera_model.h"

namespace longarm::widgets {

inline vision::CameraModel barrel(int width, int height) {
  vision::CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.9 * width;
  camera.cx = (width - 1) / 2.0;
  camera.cy = (height - 1) / 2.0;
  camera.distortion = {-0.25, 0.05, 0.001, -0.0005, 0};
  return camera;
}

}  // namespace longarm::widgets
