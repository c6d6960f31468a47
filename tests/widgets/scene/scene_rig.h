#pragma once

/// @file
/// A renderer without a window, a known camera, and questions about what it drew.

#include <memory>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/pose.h"
#include "vision/snapshot/view.h"
#include "widgets/scene/offscreen_renderer.h"

namespace longarm::tests {

/// 320 x 240 pinhole, 2 m behind the origin on the negative x axis, looking along x.
inline vision::View plainView() {
  vision::View view;
  view.name = "plain";
  view.camera.width = 320;
  view.camera.height = 240;
  view.camera.fx = view.camera.fy = 300;
  view.camera.cx = 150.3;
  view.camera.cy = 121.8;
  Eigen::Matrix3d R;  // columns: the camera's right, down and forward in the world
  R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  view.X_WC.linear() = R;
  view.X_WC.translation() = Eigen::Vector3d(-2, 0, 0);
  return view;
}

class SceneRig : public ::testing::Test {
 protected:
  void SetUp() override {
    scene::OffscreenOptions options;
    options.width = m_view.camera.width;
    options.height = m_view.camera.height;
    options.background = options.background_top = Eigen::Vector3d::Zero();
    auto made = scene::OffscreenRenderer::create(options);
    ASSERT_TRUE(made.ok()) << made.error().message;
    m_renderer = std::move(*made);
  }

  cv::Mat shot() {
    m_renderer->lookFrom(m_view.X_WC, m_view.camera);
    return m_renderer->render();
  }
  vtkRenderer* renderer() { return m_renderer->renderer(); }

  /// Mask of pixels that are not background.
  static cv::Mat drawn(const cv::Mat& picture) {
    cv::Mat channels[3], any;
    cv::split(picture, channels);
    cv::max(channels[0], channels[1], any);
    cv::max(any, channels[2], any);
    return any > 12;
  }
  /// Middle of the drawn pixels, centre origin [px].
  static Eigen::Vector2d middle(const cv::Mat& mask) {
    const cv::Moments m = cv::moments(mask, true);
    return {m.m10 / m.m00, m.m01 / m.m00};
  }
  static cv::Rect extent(const cv::Mat& mask) { return cv::boundingRect(mask); }

  vision::View m_view = plainView();
  std::unique_ptr<scene::OffscreenRenderer> m_renderer;
};

}  // namespace longarm::tests
