// views.yaml: what it holds, where its paths lead, and how it is refused.
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/vision/stereo_rig.h"
#include "tests/vision/temporary_file.h"
#include "vision/camera/camera_file.h"
#include "vision/snapshot/views_file.h"

namespace longarm::tests {
namespace {

namespace fs = std::filesystem;

class ViewsFile : public testing::Test {
 protected:
  ViewsFile() {
    m_folder = fs::temp_directory_path() / ("longarm_views_" + std::to_string(::getpid()) + "_" +
                                            testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(m_folder / "cameras");
    vision::CameraFile posed{lensCamera("posed"), PoseInParent{"mast", poseFrom({1, 2, 3}, {0, 0, 0, 1})}, {}};
    EXPECT_TRUE(vision::writeCameraFile(camera("left.yaml"), {lensCamera("left"), {}, {}}).ok());
    EXPECT_TRUE(vision::writeCameraFile(camera("posed.xml"), posed).ok());
  }
  ~ViewsFile() override {
    std::error_code ignored;
    fs::remove_all(m_folder, ignored);
  }
  std::string camera(const std::string& name) const { return (m_folder / "cameras" / name).string(); }
  std::string views() const { return (m_folder / "views.yaml").string(); }
  Result<vision::ViewSet> read(const std::string& text) const {
    std::ofstream(views(), std::ios::binary) << text;
    return vision::readViewsFile(views());
  }
  std::string refusal(const std::string& text) const {
    const auto set = read(text);
    if (set.ok()) return "taken";
    EXPECT_NE(set.error().message.find("views.yaml"), std::string::npos) << "names the file: " << set.error().message;
    return set.error().message;
  }
  fs::path m_folder;
};

constexpr const char* kGood = R"(views:
  - name: left
    image: pictures/left.png
    camera: cameras/left.yaml
    pose: {parent: mast, xyz: [0, 0.125, 1], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}
    sigma_px: 0.3
  - name: right
    image: /data/right.png
    camera: cameras/left.yaml
    pose: {parent: mast, xyz: [0, -0.125, 1], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}
)";

std::string edited(const std::string& from, const std::string& to) {
  std::string text = kGood;
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST_F(ViewsFile, RelativePathsStartAtTheFileAndAbsoluteOnesAtTheRoot) {
  const auto set = read(kGood);
  ASSERT_TRUE(set.ok()) << set.error().message;
  ASSERT_EQ(set->entries.size(), 2u);
  EXPECT_EQ(set->entries[0].image, (m_folder / "pictures/left.png").string());
  EXPECT_EQ(set->entries[1].image, "/data/right.png");
  EXPECT_EQ(set->entries[0].camera_file, camera("left.yaml"));
  const auto* left = set->find("left");
  ASSERT_NE(left, nullptr);
  EXPECT_EQ(left->parent, "mast");
  EXPECT_EQ(left->sigma_px, 0.3);
  EXPECT_EQ(set->find("right")->sigma_px, 0.5) << "the default";
  EXPECT_EQ(left->X_WC.translation(), Eigen::Vector3d(0, 0.125, 1));
  EXPECT_NEAR(left->X_WC.linear()(0, 2), 1, 1e-12) << "looks along x of its parent";
  EXPECT_EQ(set->find("middle"), nullptr);
}

TEST_F(ViewsFile, AbsoluteCameraPathsWorkFromAnywhere) {
  const auto set = read(edited("cameras/left.yaml", camera("left.yaml")));
  ASSERT_TRUE(set.ok()) << set.error().message;
  EXPECT_EQ(set->entries[0].camera_file, camera("left.yaml"));
}

TEST_F(ViewsFile, APoseMayComeFromTheCameraFile) {
  const auto set = read("views:\n  - {name: a, camera: cameras/posed.xml}\n");
  ASSERT_TRUE(set.ok()) << set.error().message;
  EXPECT_EQ(set->entries[0].view.parent, "mast");
  EXPECT_EQ(set->entries[0].view.X_WC.translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(set->entries[0].image.empty());
}

TEST_F(ViewsFile, WindowsLineEndsAndADecimalCommaLocaleChangeNothing) {
  std::string windows;
  for (const char* c = kGood; *c != 0; ++c) windows += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
  const DecimalComma comma;
  const auto set = read(windows);
  ASSERT_TRUE(set.ok()) << set.error().message;
  EXPECT_EQ(set->entries[0].view.X_WC.translation().y(), 0.125);
  EXPECT_EQ(set->entries[0].view.camera.fx, 741.5);
}

TEST_F(ViewsFile, RefusalsNameViewKeyAndValue) {
  const auto expect = [&](const std::string& text, const std::string& part) {
    const std::string message = refusal(text);
    EXPECT_NE(message.find(part), std::string::npos) << message << "\n  should say: " << part;
  };
  expect(edited("cameras/left.yaml", "cameras/nobody.yaml"), "nobody.yaml");
  expect(edited("sigma_px: 0.3", "sigma_px: -1"), "sigma_px");
  expect(edited("0.5]}", "9]}"), "quaternion_xyzw");
  expect(edited("xyz: [0, 0.125, 1]", "xyz: [0, 0.125]"), "views[0] \"left\".pose.xyz");
  expect(edited("xyz: [0, 0.125, 1]", "xyz: [0, .nan, 1]"), "xyz[1]");
  expect(edited("name: right", "name: left"), "given twice");
  expect(edited("parent: mast", "parent: wrist"), "wrist");
  expect(edited("    pose: {parent: mast, xyz: [0, 0.125, 1], quaternion_xyzw: [-0.5, 0.5, -0.5, 0.5]}\n", ""), "pose");
  expect(edited("name: left", "title: left"), "name");
  expect("views: []\n", "views");
  expect("view: 1\n", "views");
  expect("", "views");
  expect("views: [", "line");
  EXPECT_EQ(vision::readViewsFile("/no/such/views.yaml").error().code, ErrorCode::kNotFound);
}

TEST_F(ViewsFile, PoseCovarianceMustBeOne) {
  std::string numbers;
  for (int i = 0; i < 36; ++i) numbers += std::string(i > 0 ? ", " : "") + (i % 7 == 0 ? "1e-6" : "0");
  const std::string good = edited("    sigma_px: 0.3\n", "    pose_covariance: [" + numbers + "]\n");
  const auto set = read(good);
  ASSERT_TRUE(set.ok()) << set.error().message;
  EXPECT_EQ(set->entries[0].view.pose_covariance(5, 5), 1e-6);
  numbers.replace(0, 4, "-1.0");
  EXPECT_NE(refusal(edited("    sigma_px: 0.3\n", "    pose_covariance: [" + numbers + "]\n")).find("variance"),
            std::string::npos);
}

}  // namespace
}  // namespace longarm::tests
