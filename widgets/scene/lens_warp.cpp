#include "widgets/scene/lens_warp.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace longarm::scene {

Result<LensWarp> LensWarp::make(const vision::CameraModel& camera, int width, int height) {
  const Status valid = validate(camera);
  if (!valid) return valid.error();
  if (camera.width <= 0 || camera.height <= 0 || width < 8 || height < 8) {
    return {ErrorCode::kInvalidInput, "Camera " + camera.name + " is " + std::to_string(camera.width) + "x" +
                                          std::to_string(camera.height) + " px; a picture needs at least 1x1"};
  }
  // Ideal rays of every pixel; those without one (beyond the lens's fold) stay outside the picture.
  cv::Mat ideal(camera.height, camera.width, CV_64FC2, cv::Scalar::all(std::nan("")));
  Eigen::AlignedBox2d box;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const auto n = camera.normalisedOfPixel({u, v});
      if (!n) continue;
      ideal.at<cv::Vec2d>(v, u) = cv::Vec2d(n->x(), n->y());
      box.extend(*n);
    }
  }
  if (box.isEmpty()) return {ErrorCode::kInvalidInput, "Camera " + camera.name + ": no pixel has a viewing ray"};

  LensWarp warp;
  vision::CameraModel& pinhole = warp.m_pinhole;
  pinhole.name = camera.name;
  pinhole.width = width;
  pinhole.height = height;
  pinhole.fx = (width - 3) / box.sizes().x();  // one pixel of margin for the interpolation
  pinhole.fy = (height - 3) / box.sizes().y();
  pinhole.cx = 1 - pinhole.fx * box.min().x();
  pinhole.cy = 1 - pinhole.fy * box.min().y();

  cv::Mat map(camera.height, camera.width, CV_32FC2);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const cv::Vec2d& n = ideal.at<cv::Vec2d>(v, u);
      const bool seen = n[0] == n[0];
      map.at<cv::Vec2f>(v, u) = seen ? cv::Vec2f(static_cast<float>(pinhole.fx * n[0] + pinhole.cx),
                                                 static_cast<float>(pinhole.fy * n[1] + pinhole.cy))
                                     : cv::Vec2f(-10, -10);
    }
  }
  // Fixed point with 1/32 px steps: at most 1/64 px from the true place, and fast.
  cv::convertMaps(map, cv::noArray(), warp.m_map_a, warp.m_map_b, CV_16SC2);
  return warp;
}

cv::Mat LensWarp::apply(const cv::Mat& picture) const {
  cv::Mat bent;
  cv::remap(picture, bent, m_map_a, m_map_b, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return bent;
}

}  // namespace longarm::scene
