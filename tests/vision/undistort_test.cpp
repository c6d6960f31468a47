// Undistorted pictures show points where the ideal camera sees them.
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/vision/stereo_rig.h"
#include "vision/camera/undistort.h"

namespace longarm::tests {
namespace {

using Eigen::Vector2d;
using vision::CameraModel;
using vision::undistortImage;

// A soft spot, so that its centre of brightness can be found below a pixel.
cv::Mat spotAt(const CameraModel& camera, const Vector2d& pixel) {
  cv::Mat image(camera.height, camera.width, CV_8UC1, cv::Scalar(0));
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double d2 = (Vector2d(u, v) - pixel).squaredNorm();
      if (d2 < 200) image.at<std::uint8_t>(v, u) = cv::saturate_cast<std::uint8_t>(250 * std::exp(-d2 / 18));
    }
  }
  return image;
}

Vector2d brightCentre(const cv::Mat& image) {
  const auto m = cv::moments(image);
  return {m.m10 / m.m00, m.m01 / m.m00};
}

TEST(Undistort, MovesAPointToWhereTheIdealCameraSeesIt) {
  CameraModel camera = lensCamera();
  camera.skew = 8;      // OpenCV's own map would leave this in
  for (const Vector2d& n : {Vector2d(0, 0), Vector2d(0.2, 0.1), Vector2d(-0.3, -0.2), Vector2d(0.25, -0.22)}) {
    const auto straight = undistortImage(spotAt(camera, camera.pixelOfNormalised(n)), camera);
    ASSERT_TRUE(straight.ok()) << straight.error().message;
    EXPECT_FALSE(straight->camera.hasDistortion());
    EXPECT_EQ(straight->camera.skew, 0);
    const Vector2d expected = straight->camera.pixelOfNormalised(n);
    EXPECT_LT((brightCentre(straight->image) - expected).norm(), 0.2) << n.transpose();
  }
}

TEST(Undistort, ACameraWithoutLensLeavesThePictureAlone) {
  CameraModel camera = pinhole();
  cv::Mat image(480, 640, CV_8UC3);
  cv::randu(image, 0, 255);
  const auto same = undistortImage(image, camera);
  ASSERT_TRUE(same.ok());
  EXPECT_EQ(cv::norm(same->image, image, cv::NORM_INF), 0);
}

TEST(Undistort, ACameraOfUnknownSizeTakesThePictures) {
  CameraModel camera = lensCamera();
  camera.width = camera.height = 0;
  const auto out = undistortImage(cv::Mat(100, 200, CV_8UC1, cv::Scalar(9)), camera);
  ASSERT_TRUE(out.ok());
  EXPECT_EQ(out->camera.width, 200);
  EXPECT_EQ(out->camera.height, 100);
}

TEST(Undistort, PicturesOfAnotherSizeOrKindAreRefused) {
  const auto size = undistortImage(cv::Mat(240, 320, CV_8UC1), lensCamera());
  ASSERT_FALSE(size.ok());
  EXPECT_NE(size.error().message.find("320 x 240"), std::string::npos) << size.error().message;
  EXPECT_FALSE(undistortImage(cv::Mat(), lensCamera()).ok());
  EXPECT_FALSE(undistortImage(cv::Mat(480, 640, CV_32FC1), lensCamera()).ok());
}

}  // namespace
}  // namespace longarm::tests
