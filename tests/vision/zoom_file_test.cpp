// The zoom camera file of SAND2004-6198, Appendix D: its own table as the example.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/report_zoom_file.h"
#include "tests/vision/temporary_file.h"
#include "vision/camera/camera_file.h"
#include "vision/camera/zoom_camera.h"

namespace longarm::tests {
namespace {

// The report's table, loose blanks and trailing points as printed.
constexpr const char* kReport = kReportZoomFile;

vision::CameraFile cameraAt(double zoom) {
  const TemporaryFile path("zoom.xml", kReport);
  auto file = vision::readCameraFile(path.path(), zoom);
  EXPECT_TRUE(file.ok()) << file.error().message;
  return file.ok() ? *file : vision::CameraFile{};
}

TEST(ZoomFile, NodesAreMetExactly) {
  const auto wide = cameraAt(0);
  EXPECT_EQ(wide.camera.fx, 740.09);
  EXPECT_EQ(wide.camera.fy, 741.60);
  EXPECT_EQ(wide.camera.skew, -4.58);
  EXPECT_EQ(wide.camera.cx, 344.25);
  EXPECT_EQ(wide.camera.cy, 212.84);
  EXPECT_EQ(cameraAt(0.3).camera.skew, -15.74);
  EXPECT_EQ(cameraAt(1).camera.fx, 29600);
  // The file maps mount to camera; a pose says where the camera is in its mount.
  ASSERT_TRUE(wide.pose.has_value());
  const Pose X_camera_mount = wide.pose->pose.inverse();
  EXPECT_LT((X_camera_mount.translation() - Eigen::Vector3d(-0.004, 0.041, 0.006)).norm(), 1e-12);
  EXPECT_LT((logSO3(X_camera_mount.linear()) - Eigen::Vector3d(0.009, -0.004, 0.034)).norm(), 1e-12);
}

TEST(ZoomFile, WritesNamesThatAreReadBackWhateverTheyHold) {
  auto file = vision::parseZoomFile(kReport);
  ASSERT_TRUE(file.ok()) << file.error().message;
  file->cameras.front().name = "mast \"2\" <&>\x01 left";
  const auto again = vision::parseZoomFile(vision::zoomFileText(*file));
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(again->cameras.front().name, "mast \"2\" <&>  left");
  EXPECT_EQ(again->cameras.front().nodes.size(), file->cameras.front().nodes.size());
}

TEST(ZoomFile, FocalLengthGrowsMonotonely) {
  double before = 0;
  for (int i = 0; i <= 200; ++i) {
    const auto file = cameraAt(i / 200.0);
    EXPECT_GT(file.camera.fx, before) << "zoom " << i / 200.0;
    before = file.camera.fx;
  }
}

TEST(ZoomFile, TheBoresightStaysSmoothBetweenNodes) {
  const auto boresight = [](double zoom) {
    const auto file = cameraAt(zoom);
    return file.camera.pixelOfNormalised(
        (file.pose->pose.inverse().linear() * Eigen::Vector3d::UnitZ()).hnormalized());
  };
  EXPECT_NEAR(boresight(0).y(), 206.1, 0.1);
  EXPECT_NEAR(boresight(0.3).x(), 328.8, 0.1);
  EXPECT_NEAR(boresight(0.3).y(), 137.7, 0.1);
  const double low = boresight(0.3).y(), high = boresight(0.15).y();
  for (double zoom = 0.16; zoom < 0.3; zoom += 0.02) {
    EXPECT_GT(boresight(zoom).y(), low) << zoom;
    EXPECT_LT(boresight(zoom).y(), high) << zoom;
  }
}

TEST(ZoomFile, RefusalsNameSettingAndValue) {
  const auto refusal = [](const std::string& text, std::optional<double> zoom) {
    const TemporaryFile path("zoom.xml", text);
    const auto file = vision::readCameraFile(path.path(), zoom);
    return file.ok() ? std::string("taken") : file.error().message;
  };
  const auto edited = [](const std::string& from, const std::string& to) {
    std::string text = kReport;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_NE(refusal(kReport, {}).find("zoom"), std::string::npos) << "without a setting";
  EXPECT_NE(refusal(kReport, 1.5).find("1.5 is outside"), std::string::npos);
  EXPECT_NE(refusal(kReport, std::nan("")).find("zoom"), std::string::npos);
  EXPECT_NE(refusal(edited("0.025", "0.05"), 0.1).find("0.05"), std::string::npos) << "twice";
  EXPECT_NE(refusal(edited("740.09", "-740"), 0.1).find("-740"), std::string::npos);
  EXPECT_NE(refusal(edited("740.09", "abc"), 0.1).find("abc"), std::string::npos);
  EXPECT_NE(refusal(edited("740.09 ", ""), 0.1).find("SR_cam_int"), std::string::npos);
  EXPECT_NE(refusal(edited("{-0.004 0.041", "{nan 0.041"), 0.1).find("SR_cam_ext"), std::string::npos);
}

}  // namespace
}  // namespace longarm::tests
