// The calibrate verbs, from outside.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include <unistd.h>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "core/pose.h"
#include "core/text.h"
#include "tests/app/command.h"
#include "tests/support/report_zoom_file.h"
#include "tests/support/test_data.h"

namespace longarm::tests {
namespace {

std::string scratch(const std::string& name, const std::string& content) {
  const std::string path = testing::TempDir() + "calibrate_" + std::to_string(::getpid()) + "_" + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

std::string fresh(const std::string& name) {
  const std::string path = testing::TempDir() + "calibrate_" + std::to_string(::getpid()) + "_" + name;
  std::remove(path.c_str());
  return path;
}

Pose pose(const Eigen::Vector3d& rotvec, const Eigen::Vector3d& t) {
  Pose X = Pose::Identity();
  X.linear() = expSO3(rotvec);
  X.translation() = t;
  return X;
}

Eigen::Vector2d project(const Eigen::Vector3d& p, double f = 800) { return {f * p.x() / p.z() + 320, f * p.y() / p.z() + 240}; }

std::string number(double v) { return formatNumber(v); }

std::string poseText(const Pose& X, const std::string& parent) {
  const Eigen::Vector3d t = X.translation();
  const Eigen::Vector4d q = quaternionXyzw(X.linear());
  return R"({"parent": ")" + parent + R"(", "xyz": [)" + number(t.x()) + "," + number(t.y()) + "," + number(t.z()) + R"(], "quaternion_xyzw": [)" +
         number(q[0]) + "," + number(q[1]) + "," + number(q[2]) + "," + number(q[3]) + "]}";
}

// Ten views of a 9x6 board by an ideal camera with f = 600 and 0.1 px noise.
std::string cornersCsv(double first_of_v3_off_px = 0) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> tilt(-0.6, 0.6), shift(-0.05, 0.05);
  std::normal_distribution<double> noise(0, 0.1);
  std::string csv = "view,x,y,z,u,v\n";
  for (int k = 0; k < 10; ++k) {
    const Pose X = pose({tilt(random), tilt(random), tilt(random)}, {shift(random), shift(random), 0.6}) * pose({0, 0, 0}, {-0.12, -0.075, 0});
    for (int i = 0; i < 54; ++i) {
      const Eigen::Vector3d x(0.03 * (i % 9), 0.03 * (i / 9), 0);
      Eigen::Vector2d u = project(X * x, 600) + Eigen::Vector2d(noise(random), noise(random));
      if (k == 3 && i == 0) u.x() += first_of_v3_off_px;
      csv += "v" + std::to_string(k) + "," + number(x.x()) + "," + number(x.y()) + ",0," + number(u.x()) + "," + number(u.y()) + "\n";
    }
  }
  return csv;
}

std::string fixtureCsv(bool flat = false, bool upwards = false) {
  std::string csv = "x,y,z,u,v\r\n";
  const Pose X = pose({0.15, -0.2, 0.05}, {0.02, -0.03, 1.2});
  for (int i = 0; i < (flat ? 20 : 60); ++i) {
    const Eigen::Vector3d x(-0.3 + 0.1 * (i % 5), -0.2 + 0.1 * ((i / 5) % 4), flat ? 0 : 0.15 * (i / 20));
    Eigen::Vector2d u = project(X * x);
    if (upwards) u.y() = 479 - u.y();
    csv += number(x.x()) + "," + number(x.y()) + "," + number(x.z()) + "," + number(u.x()) + "," + number(u.y()) + "\r\n";
  }
  return csv;
}

std::string cameraYaml() {
  return scratch("camera.yaml",
      "image_width: 640\nimage_height: 480\ncamera_name: test\n"
      "camera_matrix: {rows: 3, cols: 3, data: [800, 0, 320, 0, 800, 240, 0, 0, 1]}\n"
      "distortion_model: plumb_bob\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
}

const Pose kExt = pose({0.02, -0.03, 0.01}, {0.03, -0.02, 0.08});

// Pan-tilt views of points on a box; the given transform left out.
std::string observations(const std::string& left_out, bool collinear = false) {
  cameraYaml();
  const Pose T_dev = pose({1.3, 0.2, 0.1}, {0.1, 0.3, 0.2});
  const Pose T_obj = (T_dev.inverse() * kExt.inverse() * pose({0.2, 0.1, 0.3}, {0, 0, 2})).inverse();
  std::string views;
  for (int k = 0; k < 4; ++k) {
    const Pose T_kin = pose({0.1 * k - 0.15, 0, 0}, {0, 0, 0}) * pose({0, 0.3 - 0.2 * k, 0}, {0, 0, 0});
    std::string points;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector3d x = collinear ? Eigen::Vector3d(0.1 * i, 0.05 * i, 0) : Eigen::Vector3d(i % 2 == 0 ? 0.2 : -0.2, i < 2 ? 0.15 : -0.15, 0.05 * i * (k + 1));
      const Eigen::Vector2d u = project(kExt * (T_kin * (T_dev * (T_obj.inverse() * x))));
      points += std::string(i > 0 ? ", " : "") + R"({"xyz": [)" + number(x.x()) + "," + number(x.y()) + "," + number(x.z()) + R"(], "u": )" + number(u.x()) +
                R"(, "v": )" + number(u.y()) + "}";
    }
    views += std::string(k > 0 ? ",\n" : "") + R"({"name": "v)" + std::to_string(k) + R"(", "T_kin": )" + poseText(T_kin, "head") + R"(, "points": [)" + points + "]}";
  }
  std::string file = "{\"camera\": \"calibrate_" + std::to_string(::getpid()) + "_camera.yaml\", \"views\": [" + views + "]";
  if (left_out != "T_ext") file += ", \"T_ext\": " + poseText(kExt, "camera");
  if (left_out != "T_dev") file += ", \"T_dev\": " + poseText(T_dev, "base");
  if (left_out != "T_obj") file += ", \"T_obj\": " + poseText(T_obj, "object");
  return scratch("observations.json", file + "}");
}

TEST(CalibrateVerbs, EachHasHelpWithAnExample) {
  for (const char* verb : {"intrinsics", "fixture", "stereo", "pose", "zoom", "compare"}) {
    const auto help = longarm(std::string("calibrate ") + verb + " --help");
    EXPECT_EQ(help.exit, 0) << verb;
    EXPECT_NE(help.out.find("Example"), std::string::npos) << verb;
  }
  EXPECT_EQ(longarm("calibrate").exit, 2);
  EXPECT_EQ(longarm("calibrate frobnicate").exit, 2);
}

TEST(CalibrateVerbs, IntrinsicsFromCorners) {
  const auto corners = scratch("corners.csv", cornersCsv());
  const auto out = fresh("intrinsics.yaml");
  const std::string command = "calibrate intrinsics --corners " + corners + " --size 640x480 --out " + out + " --json";
  const auto result = longarm(command);
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  ASSERT_TRUE(json.is_object()) << result.out;
  const double fx = json["camera"]["camera_matrix"]["data"][0].get<double>();
  EXPECT_NEAR(fx, 600, 5 * json["sigma"]["fx"].get<double>());
  EXPECT_NEAR(json["rms_px"].get<double>(), 0.1, 0.02);
  EXPECT_EQ(json["per_view"].size(), 10u);
  for (const char* key : {"image", "rms_px", "used", "why"}) EXPECT_TRUE(json["per_view"][0].contains(key)) << key;
  EXPECT_GT(json["coverage"].get<double>(), 0);
  EXPECT_TRUE(json["next_view"].is_object());
  EXPECT_EQ(json["camera"]["image_width"], 640);
  EXPECT_FALSE(slurp(out).empty());
  EXPECT_EQ(longarm(command).out, result.out) << "same input, same output";
  const auto forced = longarm("calibrate intrinsics --corners " + corners + " --size 640x480 --skew --distortion 2 --json").json();
  EXPECT_NE(forced["camera"]["camera_matrix"]["data"][1].get<double>(), 0);
  EXPECT_NE(forced["camera"]["distortion_coefficients"]["data"][1].get<double>(), 0);
  EXPECT_EQ(forced["camera"]["distortion_coefficients"]["data"][2].get<double>(), 0);
}

TEST(CalibrateVerbs, RobustLeavesOutAWrongRowPlainDoesNot) {
  const auto corners = scratch("wrong.csv", cornersCsv(60));
  const auto plain = longarm("calibrate intrinsics --corners " + corners + " --size 640x480 --json");
  const auto robust = longarm("calibrate intrinsics --corners " + corners + " --size 640x480 --robust --json");
  ASSERT_EQ(robust.exit, 0) << robust.err;
  EXPECT_LT(robust.json()["rms_px"].get<double>(), 0.15);
  EXPECT_TRUE(plain.exit != 0 || plain.json()["rms_px"].get<double>() > 1);
}

TEST(CalibrateVerbs, IntrinsicsRefuseBadInputWithItsPlace) {
  const auto corners = scratch("corners.csv", cornersCsv());
  EXPECT_EQ(longarm("calibrate intrinsics --corners " + corners + " --json").exit, 3) << "no size";
  EXPECT_EQ(longarm("calibrate intrinsics --corners " + corners + " --size 640 --json").exit, 3);
  EXPECT_EQ(longarm("calibrate intrinsics --corners " + corners + " --size 640x480 --distortion 3 --json").exit, 3);
  const auto small = longarm("calibrate intrinsics --corners " + corners + " --size 320x240 --json");
  EXPECT_EQ(small.exit, 3);
  EXPECT_NE(small.err.find("line "), std::string::npos) << small.err;
  EXPECT_NE(small.err.find("320 x 240"), std::string::npos) << small.err;
  const auto bad = longarm("calibrate intrinsics --corners " + scratch("bad.csv", "view,x,y,z,u,v\na,0,0,0,1,zz\n") + " --size 640x480 --json");
  EXPECT_EQ(bad.exit, 3);
  EXPECT_EQ(bad.out, "");
  EXPECT_NE(bad.err.find("zz"), std::string::npos) << bad.err;
  EXPECT_EQ(longarm("calibrate intrinsics --board 9x6 --square 0 x.png --json").exit, 3);
  EXPECT_EQ(longarm("calibrate intrinsics --board 9x6 --square 0.03 /no/such.png --json").exit, 3);
  EXPECT_EQ(longarm("calibrate intrinsics --board 9x6 --square 0.03 --board-kind hexagons x.png").exit, 3);
}

TEST(CalibrateVerbs, PicturesOfMixedSizeAndWithoutABoardAreTold) {
  const auto a = fresh("a.png"), b = fresh("b.png");
  cv::imwrite(a, cv::Mat(48, 64, CV_8UC1, cv::Scalar(128)));
  cv::imwrite(b, cv::Mat(50, 64, CV_8UC1, cv::Scalar(128)));
  const auto mixed = longarm("calibrate intrinsics --board 9x6 --square 0.03 " + a + " " + b + " --json");
  EXPECT_EQ(mixed.exit, 3);
  EXPECT_NE(mixed.err.find("64 x 50"), std::string::npos) << mixed.err;
  const auto empty = longarm("calibrate intrinsics --board 9x6 --square 0.03 " + a + " --json");
  EXPECT_EQ(empty.exit, 4);
  EXPECT_EQ(empty.json()["status"], "no_solution") << empty.out;
  EXPECT_EQ(empty.json()["per_view"][0]["used"], false);
}

TEST(CalibrateVerbs, FixtureAndItsRefusals) {
  const auto out = fresh("fixture.yaml");
  const auto result = longarm("calibrate fixture --points " + scratch("points.csv", fixtureCsv()) + " --out " + out + " --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  const auto json = result.json();
  EXPECT_NEAR(json["camera"]["camera_matrix"]["data"][0].get<double>(), 800, 1e-5);
  EXPECT_LT(json["rms_px"].get<double>(), 1e-6);
  EXPECT_LT(json["dlt_rms_px"].get<double>(), 1e-6);
  EXPECT_GT(json["condition"].get<double>(), 1);
  EXPECT_TRUE(json["camera"].contains("pose"));
  EXPECT_TRUE(json["sigma"].contains("fx"));
  EXPECT_NE(slurp(out).find("pose:"), std::string::npos);
  const auto flat = longarm("calibrate fixture --points " + scratch("flat.csv", fixtureCsv(true)) + " --json");
  EXPECT_EQ(flat.exit, 4);
  EXPECT_EQ(flat.json()["status"], "degenerate");
  EXPECT_NE(flat.json()["reason"].get<std::string>().find("coplanar"), std::string::npos) << flat.out;
  const auto mirrored = longarm("calibrate fixture --points " + scratch("up.csv", fixtureCsv(false, true)) + " --json");
  EXPECT_EQ(mirrored.exit, 4);
  EXPECT_NE(mirrored.json()["reason"].get<std::string>().find("mirrored"), std::string::npos) << mirrored.out;
  EXPECT_EQ(longarm("calibrate fixture --points " + scratch("five.csv", "x,y,z,u,v\n0,0,0,1,1\n1,0,0,2,1\n0,1,0,1,2\n0,0,1,3,3\n1,1,1,4,4\n") + " --json").exit, 4);
  EXPECT_EQ(longarm("calibrate fixture --points /no/such.csv --json").exit, 3);
  EXPECT_EQ(longarm("calibrate fixture --json").exit, 2);
}

TEST(CalibrateVerbs, PoseFindsEachUnknownFromNothing) {
  for (const char* unknown : {"T_ext", "T_dev", "T_obj"}) {
    const auto result = longarm("calibrate pose --observations " + observations(unknown) + " --solve " + unknown + " --json");
    ASSERT_EQ(result.exit, 0) << unknown << result.err;
    const auto json = result.json();
    EXPECT_LT(json["rms_px"].get<double>(), 1e-6);
    EXPECT_EQ(json["sigma"].size(), 6u);
    EXPECT_EQ(json["covariance"].size(), 36u);
    EXPECT_EQ(json["observability"].size(), 6u);
    EXPECT_EQ(json["per_observation"].size(), 16u);
    for (const char* key : {"residual_px", "leverage", "used", "view"}) EXPECT_TRUE(json["per_observation"][0].contains(key)) << key;
    EXPECT_GE(json["iterations"].get<int>(), 0);
    if (std::string(unknown) != "T_ext") continue;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(json["transform"]["xyz"][static_cast<std::size_t>(i)].get<double>(), kExt.translation()[i], 1e-7);
  }
  const auto camera = longarm("calibrate pose --observations " + observations("") + " --solve C_int --json");
  ASSERT_EQ(camera.exit, 0) << camera.err;
  EXPECT_NEAR(camera.json()["camera"]["camera_matrix"]["data"][0].get<double>(), 800, 1e-5);
  const auto both = longarm("calibrate pose --observations " + observations("") + " --solve T_ext --also T_obj --json");
  ASSERT_EQ(both.exit, 0) << both.err;
  EXPECT_EQ(both.json()["observability"].size(), 12u);
  EXPECT_TRUE(both.json()["transforms"].contains("T_obj"));
}

TEST(CalibrateVerbs, PoseSaysWhatIsNotDetermined) {
  const auto line = longarm("calibrate pose --observations " + observations("T_obj", true) + " --solve T_obj --json");
  EXPECT_EQ(line.exit, 4);
  EXPECT_EQ(line.json()["status"], "degenerate") << line.out;
  EXPECT_NE(line.json()["reason"].get<std::string>().find("a turn about the axis"), std::string::npos) << line.out;
  const auto gauge = longarm("calibrate pose --observations " + observations("") + " --solve T_dev --also T_obj --json");
  EXPECT_EQ(gauge.exit, 4);
  const auto missing = longarm("calibrate pose --observations " + observations("T_dev") + " --solve T_ext --json");
  EXPECT_EQ(missing.exit, 3);
  EXPECT_NE(missing.err.find("T_dev"), std::string::npos) << missing.err;
  EXPECT_EQ(longarm("calibrate pose --observations " + observations("") + " --solve T_foo --json").exit, 3);
  EXPECT_EQ(longarm("calibrate pose --observations " + scratch("broken.json", "{\"camera\": ") + " --solve T_ext --json").exit, 3);
}

TEST(CalibrateVerbs, ZoomAtCheckAndFit) {
  const auto xml = scratch("zoom.xml", kReportZoomFile);
  const auto node = longarm("calibrate zoom --xml " + xml + " --at 0.3 --json");
  ASSERT_EQ(node.exit, 0) << node.err;
  EXPECT_EQ(node.json()["camera"]["camera_matrix"]["data"][0].get<double>(), 2314.0);
  EXPECT_EQ(node.json()["extrinsic"]["xyz"][1].get<double>(), 0.042);
  EXPECT_GE(node.json()["warnings"].size(), 2u) << "the nominal nodes";
  EXPECT_EQ(longarm("calibrate zoom --xml " + xml + " --at 1.5 --json").exit, 3);
  EXPECT_EQ(longarm("calibrate zoom --xml " + xml + " --json").exit, 3);
  const auto check = longarm("calibrate zoom --xml " + xml + " --check --json");
  ASSERT_EQ(check.exit, 0) << check.err;
  EXPECT_EQ(check.json()["leave_one_out"].size(), 6u);
  EXPECT_TRUE(check.json()["leave_one_out"][0].contains("error_px"));
  std::string broken = kReportZoomFile;
  broken.replace(broken.find("{740.09"), 7, "740.09");
  const auto refused = longarm("calibrate zoom --xml " + scratch("broken.xml", broken) + " --check --json");
  EXPECT_EQ(refused.exit, 3);
  EXPECT_NE(refused.err.find("brace"), std::string::npos) << refused.err;
  const auto folder = fresh("nodes");
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (const char* zoom : {"0.05", "0.1", "0.15"}) {
    EXPECT_EQ(longarm("calibrate zoom --xml " + xml + " --at " + zoom + " --out " + folder + "/zcam_" + zoom + ".yaml --json").exit, 0);
  }
  const auto out = fresh("fitted.xml");
  const auto fit = longarm("calibrate zoom --fit " + folder + " --out " + out + " --json");
  ASSERT_EQ(fit.exit, 0) << fit.err;
  EXPECT_EQ(fit.json()["leave_one_out"].size(), 1u);
  EXPECT_EQ(longarm("calibrate zoom --xml " + out + " --at 0.1 --json").json()["camera"]["camera_matrix"]["data"][0].get<double>(), 1004.12);
}

TEST(CalibrateVerbs, CompareTellsPixelsAndMillimetres) {
  const auto a = cameraYaml();
  std::string text = slurp(a);
  text.replace(text.find("320,"), 4, "324,");
  const auto b = scratch("moved.yaml", text);
  const auto result = longarm("calibrate compare " + a + " " + b + " --depth 2 --json");
  ASSERT_EQ(result.exit, 0) << result.err;
  EXPECT_NEAR(result.json()["rms_px"].get<double>(), 4, 1e-9);
  EXPECT_NEAR(result.json()["max_mm"].get<double>(), 10, 1e-6);
  EXPECT_EQ(longarm("calibrate compare " + a + " --json").exit, 2);
  EXPECT_EQ(longarm("calibrate compare " + a + " /no/such.yaml --json").exit, 3);
}

TEST(CalibrateVerbs, RealPairsGiveThePublishedBaseline) {
  LONGARM_SKIP_WITHOUT_DATA();
  const std::string data = dataFolder() + "/opencv_stereo_chess/";
  std::string pairs;
  for (const char* side : {"left", "right"}) {
    const auto out = fresh(std::string(side) + ".yaml");
    const auto result = longarm(std::string("calibrate intrinsics --board 9x6 --square 0.03 ") + data + side + "0[1-9].jpg " + data + side + "1[1-4].jpg --out " + out + " --json");
    ASSERT_EQ(result.exit, 0) << result.err;
    EXPECT_LT(result.json()["rms_px"].get<double>(), 0.15);
  }
  for (const char* n : {"01", "02", "03", "04", "05", "06", "07", "08", "09", "11", "12", "13", "14"}) pairs += " " + data + "left" + n + ".jpg " + data + "right" + n + ".jpg";
  const std::string cameras = testing::TempDir() + "calibrate_" + std::to_string(::getpid()) + "_left.yaml " + testing::TempDir() + "calibrate_" + std::to_string(::getpid()) + "_right.yaml";
  const auto stereo = longarm("calibrate stereo " + cameras + " --board 9x6 --square 0.03" + pairs + " --json");
  ASSERT_EQ(stereo.exit, 0) << stereo.err;
  const auto json = stereo.json();
  Eigen::Vector3d t;
  for (int i = 0; i < 3; ++i) t[i] = json["pose"]["xyz"][static_cast<std::size_t>(i)].get<double>();
  EXPECT_NEAR(t.norm(), 0.09981, 0.00015);
  EXPECT_GT(t.x(), 0) << "the right camera stands to the right";
  EXPECT_EQ(json["sigma"].size(), 6u);
}

}  // namespace
}  // namespace longarm::tests
