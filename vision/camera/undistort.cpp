#include "vision/camera/undistort.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

#include "vision/camera/lens.h"

namespace longarm::vision {
namespace {

// For every pixel of the undistorted picture, where the raw one holds it.
cv::Mat rawPixels(const CameraModel& raw, const CameraModel& ideal, cv::Size size) {
  cv::Mat map(size, CV_32FC2);
  const double max_radius2 = internal::monotoneRadius2(raw);
  for (int row = 0; row < size.height; ++row) {
    auto* out = map.ptr<cv::Vec2f>(row);
    const double y = (row - ideal.cy) / ideal.fy;
    for (int column = 0; column < size.width; ++column) {
      const double x = (column - ideal.cx) / ideal.fx;
      if (x * x + y * y > max_radius2) {
        out[column] = {-10, -10};   // outside: black
        continue;
      }
      const Eigen::Vector2d d = internal::distort(raw.distortion, x, y);
      out[column] = {static_cast<float>(raw.fx * d.x() + raw.skew * d.y() + raw.cx),
                     static_cast<float>(raw.fy * d.y() + raw.cy)};
    }
  }
  return map;
}

}  // namespace

Result<UndistortedImage> undistortImage(const cv::Mat& image, const CameraModel& camera) {
  if (image.empty()) return Error{ErrorCode::kInvalidInput, "the picture is empty"};
  if (image.type() != CV_8UC1 && image.type() != CV_8UC3) {
    return Error{ErrorCode::kInvalidInput, "the picture is neither 8-bit grey nor 8-bit colour"};
  }
  if (camera.width > 0 && (camera.width != image.cols || camera.height != image.rows)) {
    return Error{ErrorCode::kInvalidInput,
                 "the picture is " + std::to_string(image.cols) + " x " + std::to_string(image.rows) +
                     " pixels but the camera file is for " + std::to_string(camera.width) + " x " +
                     std::to_string(camera.height) + "; use the file of this camera and picture size"};
  }
  try {
    UndistortedImage out;
    out.camera = camera.undistorted();
    out.camera.width = image.cols;
    out.camera.height = image.rows;
    cv::remap(image, out.image, rawPixels(camera, out.camera, image.size()), cv::noArray(), cv::INTER_LINEAR,
              cv::BORDER_CONSTANT, cv::Scalar());
    return out;
  } catch (const std::exception& exception) {
    return Error{ErrorCode::kInternal, std::string("undistorting failed: ") + exception.what()};
  }
}

}  // namespace longarm::vision
