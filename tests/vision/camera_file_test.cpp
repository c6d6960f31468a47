// Camera files: ROS camera_info YAML, OpenCV YAML and XML, each written, read back and refused.
#include <clocale>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/vision/stereo_rig.h"
#include "tests/vision/temporary_file.h"
#include "vision/camera/camera_file.h"

namespace longarm::tests {
namespace {

using vision::CameraFile;
using vision::CameraFileFormat;

CameraFile fullFile() {
  CameraFile file;
  file.camera = lensCamera("left \"A\" <1> & co");
  file.camera.skew = -4.58;
  file.camera.fx = 741.1 / 3;                       // digits that do not end
  file.camera.distortion = {-0.1 / 3, 1e-17, 1.0 / 7, -2e-300, 0.1};
  file.pose = PoseInParent{"mast", poseFrom({0.1 / 3, -2.0 / 7, 1e-12}, {0.1, -0.2, 0.3, 0.4})};
  Dice dice(1);
  Eigen::MatrixXd root(16, 16);
  for (Eigen::Index i = 0; i < root.size(); ++i) root(i) = dice.normal(1e-3);
  const Eigen::MatrixXd product = root * root.transpose();
  file.covariance = Eigen::MatrixXd(0.5 * (product + product.transpose()));
  return file;
}

void expectSame(const CameraFile& a, const CameraFile& b) {
  EXPECT_EQ(a.camera.name, b.camera.name);
  EXPECT_EQ(a.camera.width, b.camera.width);
  EXPECT_EQ(a.camera.height, b.camera.height);
  EXPECT_EQ(a.camera.K(), b.camera.K());
  EXPECT_EQ(a.camera.distortion, b.camera.distortion);
  ASSERT_EQ(a.pose.has_value(), b.pose.has_value());
  if (a.pose) {
    EXPECT_EQ(a.pose->parent, b.pose->parent);
    EXPECT_EQ(a.pose->pose.translation(), b.pose->pose.translation());
    EXPECT_LT((a.pose->pose.linear() - b.pose->pose.linear()).norm(), 1e-15);
  }
  ASSERT_EQ(a.covariance.has_value(), b.covariance.has_value());
  if (a.covariance) {
    EXPECT_EQ(*a.covariance, *b.covariance);
  }
}

class EveryFormat : public testing::TestWithParam<CameraFileFormat> {};

TEST_P(EveryFormat, ReadsBackBitForBit) {
  const TemporaryFile path("camera.any");
  const CameraFile file = fullFile();
  ASSERT_TRUE(writeCameraFile(path.path(), file, GetParam()).ok());
  const auto back = vision::readCameraFile(path.path());
  ASSERT_TRUE(back.ok()) << back.error().message;
  expectSame(file, *back);
}

TEST_P(EveryFormat, WritesTheSameUnderADecimalComma) {
  const TemporaryFile with_point("point.any"), with_comma("comma.any");
  ASSERT_TRUE(writeCameraFile(with_point.path(), fullFile(), GetParam()).ok());
  const DecimalComma comma;
  if (!comma.active()) GTEST_SKIP() << "skipped: no decimal-comma locale is installed";
  ASSERT_TRUE(writeCameraFile(with_comma.path(), fullFile(), GetParam()).ok());
  EXPECT_EQ(with_point.content(), with_comma.content());
  const auto back = vision::readCameraFile(with_point.path());
  ASSERT_TRUE(back.ok()) << back.error().message;
  expectSame(fullFile(), *back);
}

INSTANTIATE_TEST_SUITE_P(CameraFiles, EveryFormat,
                         testing::Values(CameraFileFormat::kRosYaml, CameraFileFormat::kOpenCvYaml,
                                         CameraFileFormat::kOpenCvXml));

TEST(CameraFile, EndingChoosesTheFormat) {
  const TemporaryFile xml("c.xml"), yml("c.yml"), yaml("c.yaml");
  for (const auto* file : {&xml, &yml, &yaml}) ASSERT_TRUE(writeCameraFile(file->path(), fullFile()).ok());
  EXPECT_EQ(xml.content().rfind("<?xml", 0), 0u);
  EXPECT_EQ(yml.content().rfind("%YAML:1.0", 0), 0u);
  EXPECT_EQ(yaml.content().rfind("image_width: 640", 0), 0u);
}

// As camera_calibration_parsers writes it.
constexpr const char* kRos = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [438.783367, 0.000000, 305.593336, 0.000000, 437.302876, 243.738352, 0.000000, 0.000000, 1.000000]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.361976, 0.110510, 0.001014, 0.000505, 0.000000]
rectification_matrix:
  rows: 3
  cols: 3
  data: [0.999978, 0.002789, -0.006046, -0.002816, 0.999986, -0.004401, 0.006034, 0.004417, 0.999972]
projection_matrix:
  rows: 3
  cols: 4
  data: [393.653800, 0.000000, 322.797939, 0.000000, 0.000000, 393.653800, 241.090902, 0.000000, 0, 0, 1, 0]
)";

TEST(CameraFile, ReadsWhatRosWrites) {
  const TemporaryFile path("ros.yaml", kRos);
  const auto file = vision::readCameraFile(path.path());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.name, "narrow_stereo");
  EXPECT_EQ(file->camera.width, 640);
  EXPECT_EQ(file->camera.fx, 438.783367);
  EXPECT_EQ(file->camera.fy, 437.302876);
  EXPECT_EQ(file->camera.skew, 0);
  EXPECT_EQ(file->camera.distortion[0], -0.361976);
  EXPECT_EQ(file->camera.distortion[3], 0.000505);
  EXPECT_FALSE(file->pose.has_value());
}

TEST(CameraFile, ReadsWindowsLineEndsAndAByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char* c = kRos; *c != 0; ++c) text += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
  const TemporaryFile path("windows.yaml", text);
  const auto file = vision::readCameraFile(path.path());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.fx, 438.783367);
}

TEST(CameraFile, ReadsOpenCvYamlOfTheCalibrationSample) {
  const TemporaryFile path("opencv.yml", R"(%YAML:1.0
---
calibration_time: "Tue 01 Jan 2019 10:00:00"
image_width: 640
image_height: 480
flags: 2
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 5.3591573396163199e+02, 0., 3.4228315473308373e+02, 0.,
       5.3591573396163199e+02, 2.3557082909788173e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.6637260909660682e-01, -3.8588898922304653e-02,
       1.7831947042852964e-03, -2.8122100441115472e-04,
       2.3839153080878486e-01 ]
)");
  const auto file = vision::readCameraFile(path.path());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.fx, 5.3591573396163199e+02);
  EXPECT_EQ(file->camera.distortion[4], 2.3839153080878486e-01);
}

TEST(CameraFile, ReadsOpenCvXml) {
  const TemporaryFile path("opencv.xml", R"(<?xml version="1.0"?>
<opencv_storage>
<image_Width>640</image_Width>
<image_Height>480</image_Height>
<Camera_Matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols><dt>d</dt>
  <data>6.5746697944293521e+02 0. 3.1950000000000000e+02 0. 6.5746697944293521e+02 2.3950000000000000e+02 0. 0. 1.</data>
</Camera_Matrix>
<Distortion_Coefficients type_id="opencv-matrix"><rows>5</rows><cols>1</cols><dt>d</dt>
  <data>-4.1802327176423804e-01 5.0715244063187526e-01 0. 0. -5.7843597214487474e-01</data>
</Distortion_Coefficients>
</opencv_storage>
)");
  const auto file = vision::readCameraFile(path.path());
  ASSERT_TRUE(file.ok()) << file.error().message;
  EXPECT_EQ(file->camera.fx, 6.5746697944293521e+02);
  EXPECT_EQ(file->camera.distortion[1], 5.0715244063187526e-01);
}

std::string refusalOf(const std::string& text) {
  const TemporaryFile path("refused.yaml", text);
  const auto file = vision::readCameraFile(path.path());
  if (file.ok()) return "taken";
  EXPECT_EQ(file.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(file.error().message.find(path.path()), std::string::npos) << "names the file: " << file.error().message;
  return file.error().message;
}

std::string edited(const std::string& from, const std::string& to) {
  std::string text = kRos;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(CameraFile, RefusalsNameKeyAndValue) {
  const auto expect = [](const std::string& text, const std::string& part) {
    const std::string message = refusalOf(text);
    EXPECT_NE(message.find(part), std::string::npos) << message << "\n  should say: " << part;
  };
  expect(edited("camera_matrix", "kamera_matrix"), "camera_matrix");
  expect(edited("438.783367", "-438.7"), "-438.7");
  expect(edited("438.783367", "nan"), "nan");
  expect(edited("438.783367,", "438,783367,"), "camera_matrix");
  expect(edited("plumb_bob", "equidistant"), "equidistant");
  expect(edited("plumb_bob", "rational_polynomial") + "", "taken");
  expect(edited("image_width: 640", "image_width: 0"), "image_width");
  expect(edited("image_width: 640", "image_width: 64.5"), "64.5");
  expect(edited("cols: 5", "cols: 4"), "distortion_coefficients");
  expect(edited("image_height: 480\n", ""), "image_height");
  expect("", "camera");
  expect("[1, 2]", "list");
  expect("a: {", "line");
  expect("%YAML:1.0\n---\na: 1\na: 2\n", "twice");
  expect("<!DOCTYPE a [<!ENTITY b \"c\">]><opencv_storage/>", "DOCTYPE");
  expect("<opencv_storage><camera_matrix>", "XML");
  EXPECT_EQ(vision::readCameraFile("/no/such/camera.yaml").error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(vision::readCameraFile(testing::TempDir()).ok()) << "a folder";
  const TemporaryFile ros("plain.yaml", kRos);
  EXPECT_FALSE(vision::readCameraFile(ros.path(), 0.5).ok()) << "zoom of a camera without zoom";
}

TEST(CameraFile, AnImpossibleCameraIsNotWritten) {
  const TemporaryFile path("never.yaml");
  CameraFile file = fullFile();
  file.camera.fx = 0;
  EXPECT_FALSE(writeCameraFile(path.path(), file).ok());
  EXPECT_FALSE(std::filesystem::exists(path.path()));
}

TEST(CameraFile, JsonHoldsWhatTheFileHolds) {
  const auto json = toJson(fullFile());
  EXPECT_EQ(json["image_width"], 640);
  EXPECT_EQ(json["camera_matrix"]["data"].size(), 9u);
  EXPECT_EQ(json["camera_matrix"]["data"][1], -4.58);
  EXPECT_EQ(json["distortion_coefficients"]["data"].size(), 5u);
  EXPECT_EQ(json["pose"]["parent"], "mast");
  const auto back = vision::cameraFromJson(json);
  ASSERT_TRUE(back.ok()) << back.error().message;
  expectSame(fullFile(), *back);
}

}  // namespace
}  // namespace longarm::tests
