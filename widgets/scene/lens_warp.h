#pragma once

/// @file
/// Bends a pinhole picture as a real lens would: how a rendered picture becomes a camera's.

#include <memory>

#include <opencv2/core/mat.hpp>

#include "core/result.h"
#include "vision/camera/camera_model.h"

namespace longarm::scene {

/// The map of one camera.  Immutable after make(); apply() is thread-safe.
class LensWarp {
 public:
  /// Prepares to make pictures of `camera` out of pinhole pictures of `width` x `height` that have `camera`'s centre of
  /// view and just hold all its rays; pixels beyond the lens's monotone range become black.
  /// @returns kInvalidInput if the camera has no size or its model is not valid.
  static Result<LensWarp> make(const vision::CameraModel& camera, int width, int height);

  /// The pinhole camera to render with; its size is width x height.
  const vision::CameraModel& pinhole() const { return m_pinhole; }
  /// @param picture rendered with pinhole().  @returns the camera's picture (bilinear, positions to < 0.05 px).
  cv::Mat apply(const cv::Mat& picture) const;

 private:
  LensWarp() = default;
  vision::CameraModel m_pinhole;
  cv::Mat m_map_a, m_map_b;
};

}  // namespace longarm::scene
