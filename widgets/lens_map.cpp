#include "widgets/lens_map.h"

#include <opencv2/imgproc.hpp>

namespace longarm::widgets {

LensMap::LensMap(const vision::CameraModel& camera) : m_camera(camera), m_straight(camera.undistorted()) {}

bool LensMap::changesAnything() const { return m_camera.hasDistortion() || m_camera.skew != 0; }

std::optional<Eigen::Vector2d> LensMap::shownOfRaw(const Eigen::Vector2d& raw) const {
  if (!raw.allFinite()) return {};
  const auto normalised = m_camera.normalisedOfPixel(raw);
  if (!normalised) return {};
  return m_straight.pixelOfNormalised(*normalised);
}

Eigen::Vector2d LensMap::rawOfShown(const Eigen::Vector2d& shown) const {
  const Eigen::Vector2d normalised((shown.x() - m_straight.cx) / m_straight.fx,
                                   (shown.y() - m_straight.cy) / m_straight.fy);
  return m_camera.pixelOfNormalised(normalised);
}

cv::Mat LensMap::straighten(const cv::Mat& picture) const {
  if (m_map_u.size() != picture.size()) {
    cv::Mat u(picture.size(), CV_32FC1), v(picture.size(), CV_32FC1);
    for (int row = 0; row < picture.rows; ++row) {
      for (int column = 0; column < picture.cols; ++column) {
        const Eigen::Vector2d raw = rawOfShown({column, row});
        u.at<float>(row, column) = static_cast<float>(raw.x());
        v.at<float>(row, column) = static_cast<float>(raw.y());
      }
    }
    cv::convertMaps(u, v, m_map_u, m_map_v, CV_16SC2);
  }
  cv::Mat straight;
  cv::remap(picture, straight, m_map_u, m_map_v, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return straight;
}

}  // namespace longarm::widgets
