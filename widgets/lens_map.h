#pragma once

/// @file
/// LensMap: from a raw picture to the undistorted one and back, for showing; picks stay raw.

#include <optional>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "vision/camera/camera_model.h"

namespace longarm::widgets {

/// One camera's straightening.  The sampling maps are made at the first picture and kept.  Thread-compatible.
class LensMap {
 public:
  explicit LensMap(const vision::CameraModel& camera);

  /// Whether the straightened picture differs from the raw one at all.
  bool changesAnything() const;
  /// Position in the straightened picture of a raw pixel; nothing where the lens model has no inverse.
  std::optional<Eigen::Vector2d> shownOfRaw(const Eigen::Vector2d& raw) const;
  Eigen::Vector2d rawOfShown(const Eigen::Vector2d& shown) const;
  /// Straightened picture of the same size and kind.
  cv::Mat straighten(const cv::Mat& picture) const;

 private:
  vision::CameraModel m_camera, m_straight;
  mutable cv::Mat m_map_u, m_map_v;
};

}  // namespace longarm::widgets
