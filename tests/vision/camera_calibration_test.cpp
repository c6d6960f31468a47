// One lens or a table, with a digital part beyond it.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/report_zoom_file.h"
#include "tests/vision/temporary_file.h"
#include "vision/camera/camera_calibration.h"

namespace longarm::vision {
namespace {

constexpr const char* kPlain = "image_width: 640\nimage_height: 480\ncamera_name: c\ncamera_matrix: {rows: 3, cols: 3, "
                               "data: [600, 0, 310, 0, 601, 250, 0, 0, 1]}\ndistortion_model: plumb_bob\n"
                               "distortion_coefficients: {rows: 1, cols: 5, data: [-0.2, 0.05, 0, 0, 0]}\n";

TEST(CameraCalibration, TableMeetsItsNodesAndRefusesWhatLiesOutside) {
  const tests::TemporaryFile file("table.xml", tests::kReportZoomFile);
  const auto read = CameraCalibration::read(file.path(), {}, 640, 480);
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_TRUE(read->hasTable());
  EXPECT_EQ(read->range(), std::pair(0.0, 1.0));
  const auto node = read->at(0.1);
  ASSERT_TRUE(node.ok()) << node.error().message;
  EXPECT_EQ(node->camera.fx, 1004.12);
  EXPECT_EQ(node->camera.width, 640);
  ASSERT_TRUE(node->pose.has_value());
  EXPECT_EQ(node->pose->parent, "zcam_mount");
  EXPECT_EQ(read->at({}).error().code, ErrorCode::kNotFound) << "a table needs a setting";
  for (const double outside : {-0.01, 1.01}) {
    const auto refused = read->at(outside);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kOutOfLimits);
    EXPECT_NE(refused.error().message.find("0.000 to 1.000"), std::string::npos) << refused.error().message;
  }
}

TEST(CameraCalibration, OneLensHoldsForOneSettingOnly) {
  const tests::TemporaryFile file("plain.yaml", kPlain);
  const auto read = CameraCalibration::read(file.path());
  ASSERT_TRUE(read.ok()) << read.error().message;
  EXPECT_FALSE(read->hasTable());
  EXPECT_TRUE(read->at({}).ok());
  EXPECT_TRUE(read->at(0).ok());
  const auto zoomed = read->at(0.3);
  ASSERT_FALSE(zoomed.ok()) << "nothing may be measured through a lens that is not calibrated";
  EXPECT_EQ(zoomed.error().code, ErrorCode::kOutOfLimits);
  EXPECT_NE(zoomed.error().message.find("Zoom out"), std::string::npos);
}

TEST(CameraCalibration, DigitalZoomEnlargesAboutTheMiddleOfThePicture) {
  const tests::TemporaryFile file("plain.yaml", kPlain);
  const DigitalZoom digital{0, 4};
  const auto read = CameraCalibration::read(file.path(), digital);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->range(), std::pair(0.0, 1.0));
  const CameraModel whole = read->at(0)->camera, half = read->at(0.5)->camera;
  EXPECT_NEAR(*read->magnification(0.5), 2, 1e-12);
  // What the sensor sees at a pixel is seen twice as far from the middle.
  const Eigen::Vector2d middle{319.5, 239.5};
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0.1, -0.05, 1), Eigen::Vector3d(-0.15, 0.1, 1.2)}) {
    const Eigen::Vector2d expected = middle + 2 * (*whole.project(p) - middle);
    EXPECT_NEAR((*half.project(p) - expected).norm(), 0, 1e-9);
  }
}

TEST(CameraCalibration, TableGoesOverIntoTheDigitalPartWithoutAStep) {
  const tests::TemporaryFile file("table.xml", tests::kReportZoomFile);
  const auto read = CameraCalibration::read(file.path(), {0.3, 2}, 640, 480);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->at(0.3)->camera.fx, 2314.0);
  EXPECT_NEAR(read->at(0.3 + 1e-9)->camera.fx, 2314.0, 1e-3);
  EXPECT_NEAR(read->at(1)->camera.fx, 2 * 2314.0, 1e-9);
  EXPECT_EQ(read->at(1)->camera.distortion, read->at(0.3)->camera.distortion);
}

}  // namespace
}  // namespace longarm::vision
