#pragma once

/// @file
/// Renders a VTK scene to pictures without a window and without an X server (surfaceless EGL).

#include <memory>

#include <opencv2/core/mat.hpp>

#include "core/pose.h"
#include "core/result.h"
#include "vision/camera/camera_model.h"

class vtkRenderer;

namespace longarm::scene {

struct OffscreenOptions {
  int width = 640, height = 480;         ///< [px], 1 ... 8192.
  int samples = 4;                       ///< Multisampling: 0, 2, 4 or 8.
  Eigen::Vector3d background{0.62, 0.68, 0.74}, background_top{0.82, 0.87, 0.92};   ///< RGB 0 ... 1.
};

/// One EGL context, one render window, one renderer.  Lights are those of the caller; without any, VTK's headlight.
/// All calls, and destruction, on the thread that created it; several may exist on several threads.
class OffscreenRenderer {
 public:
  /// @returns kInternal when the machine has no usable EGL (the message says which call failed).
  static Result<std::unique_ptr<OffscreenRenderer>> create(const OffscreenOptions& options = {});
  ~OffscreenRenderer();

  vtkRenderer* renderer() const;
  int width() const;
  int height() const;
  void resize(int width, int height);

  /// Looks from an optical frame with the pinhole part of `camera` (its cx, cy refer to this raster).
  void lookFrom(const Pose& X_WC, const vision::CameraModel& camera, double near_m = 0.02, double far_m = 60);
  /// Renders and reads back.  @returns an 8-bit BGR picture of its own memory, top row first.
  cv::Mat render();

 private:
  OffscreenRenderer();
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::scene
