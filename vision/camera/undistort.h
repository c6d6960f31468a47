#pragma once

/// @file
/// Pictures without lens distortion and skew.

#include <opencv2/core/mat.hpp>

#include "core/result.h"
#include "vision/camera/camera_model.h"

namespace longarm::vision {

struct UndistortedImage {
  cv::Mat image;         ///< As large as the source; black where the lens saw nothing.
  CameraModel camera;    ///< Model of `image`: camera.undistorted().
};

/// Resamples a picture (linear) by our own map, which includes the skew that OpenCV's map leaves out.
/// @param image 8-bit grey or BGR, of the camera's size; a camera of unknown size takes the picture's.
/// @returns kInvalidInput for an empty picture or one of another size.  Pure function.
Result<UndistortedImage> undistortImage(const cv::Mat& image, const CameraModel& camera);

}  // namespace longarm::vision
