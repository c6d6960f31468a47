#include <algorithm>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "planning/world/room.h"
#include "planning/world/workcell.h"
#include "tests/support/test_data.h"

namespace longarm::planning {
namespace {

namespace fs = std::filesystem;

const char* kRobot =
    "<robot name='r'><link name='base'/><link name='arm'/><link name='finger'/><link name='eye'/>"
    "<joint name='j' type='revolute'><parent link='base'/><child link='arm'/>"
    "<limit lower='-1' upper='1' velocity='2' effort='1'/></joint>"
    "<joint name='g' type='prismatic'><parent link='arm'/><child link='finger'/>"
    "<limit lower='0' upper='0.1' velocity='1' effort='1'/></joint>"
    "<joint name='e' type='fixed'><parent link='arm'/><child link='eye'/></joint></robot>";

const char* kMinimal = "robot: {urdf: robot.urdf}\narm: {tip: arm, max_acceleration: 4}\n";

class WorkcellTest : public testing::Test {
 protected:
  void SetUp() override {
    m_folder = fs::temp_directory_path() / ("longarm_workcell_" + std::to_string(::getpid()));
    fs::create_directories(m_folder);
    std::ofstream(m_folder / "robot.urdf") << kRobot;
  }
  void TearDown() override { fs::remove_all(m_folder); }

  Result<Workcell> loadText(const std::string& text) const {
    std::ofstream(m_folder / "cell.yaml") << text;
    return loadWorkcell((m_folder / "cell.yaml").string());
  }
  fs::path m_folder;
};

TEST_F(WorkcellTest, NeedsOnlyARobotATipAndAnAcceleration) {
  const auto cell = loadText(kMinimal);
  ASSERT_TRUE(cell.ok()) << cell.error().message;
  EXPECT_EQ(cell->name, "cell");
  EXPECT_EQ(cell->armJointNames(), std::vector<std::string>{"j"});
  EXPECT_EQ(cell->arm.base_link, "base");
  EXPECT_DOUBLE_EQ(cell->arm_limits.max_velocity[0], 2);
  EXPECT_DOUBLE_EQ(cell->arm_limits.max_acceleration[0], 4);
  EXPECT_DOUBLE_EQ(cell->arm_limits.stop_deceleration[0], 12);
  EXPECT_FALSE(cell->gripper.has_value());
  EXPECT_FALSE(cell->imu.has_value()) << "then the root's z is up";
  EXPECT_EQ(cell->camera("none"), nullptr);
}

TEST_F(WorkcellTest, ReadsEverySection) {
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // Where it is not installed this checks the C locale.
  const auto cell = loadText(
      "format: 1\nname: all\nrobot: {urdf: robot.urdf}\n"
      "arm: {base: base, tip: arm, max_velocity: [1.5], max_acceleration: [4.5], stop_deceleration: 15, limit_margin: 0.25}\n"
      "imu: {link: eye, topic: /base/imu}\n"
      "gripper: {joint: g, open: 0.1, closed: 0, max_width: 0.2, links: [finger], device: hand}\n"
      "pan_tilts: [{name: pt, pan_joint: j, tilt_joint: g}]\n"
      "cameras:\n  - {name: a, link: eye, calibration: a.yaml, pan_tilt: pt, stereo_partner: b, role: stereo_left}\n"
      "  - {name: b, link: eye, sigma_px: 0.25}\n"
      "backend: {driver: rosbridge, url: 'ws://h:1', topics: {/joint_states: /js}}\n"
      "objects:\n  - {name: floor, box: [4, 4, 0.02], pose: {xyz: [0, 0, -0.5], rpy: [0, 0, 1.5]}, rgba: [1, 0, 0, 1]}\n"
      "  - {name: post, cylinder: {radius: 0.1, length: 2}, attached_link: arm, collides: false}\n"
      "  - {name: ball, sphere: {radius: 0.1}, pose: {xyz: [1, 2, 3], quaternion_xyzw: [0, 0, 0, 1]}}\n"
      "  - {name: drill, sphere: {radius: 0.2}, role: keep_out}\n  - {name: cell, box: [2, 2, 2], role: keep_in}\n"
      "poses: {there: {j: 0.5}}\nspeeds: {max_tool_speed: 0.125, approach_speed: 0.02}\nextra: 1\n");
  std::setlocale(LC_ALL, "C");
  ASSERT_TRUE(cell.ok()) << cell.error().message;
  EXPECT_DOUBLE_EQ(cell->arm_limits.lower[0], -0.75);
  EXPECT_DOUBLE_EQ(cell->arm_limits.max_velocity[0], 1.5);
  EXPECT_DOUBLE_EQ(cell->arm_limits.stop_deceleration[0], 15);
  EXPECT_EQ(cell->gripper->device, "hand");
  ASSERT_TRUE(cell->imu.has_value());
  EXPECT_EQ(cell->imu->link, "eye");
  EXPECT_EQ(cell->imu->topic, "/base/imu");
  EXPECT_EQ(cell->camera("a")->calibration, (m_folder / "a.yaml").string());
  EXPECT_DOUBLE_EQ(cell->camera("b")->sigma_px, 0.25);
  EXPECT_EQ(cell->backend.topics.at("/joint_states"), "/js");
  ASSERT_EQ(cell->objects.size(), 5u);
  EXPECT_EQ(cell->objects[0].role, BodyRole::kSolid);
  EXPECT_EQ(cell->objects[3].role, BodyRole::kKeepOut);
  EXPECT_EQ(cell->objects[4].role, BodyRole::kKeepIn);
  EXPECT_DOUBLE_EQ(std::get<Box>(cell->objects[0].shape).size.z(), 0.02);
  EXPECT_NEAR(cell->objects[0].X_WO.linear()(1, 0), std::sin(1.5), 1e-12);
  EXPECT_EQ(cell->objects[1].attached_link, "arm");
  EXPECT_FALSE(cell->objects[1].collides);
  EXPECT_DOUBLE_EQ(cell->poses.at("there").at("j"), 0.5);
  EXPECT_DOUBLE_EQ(cell->max_tool_speed, 0.125);
  const auto mentions = [&](const std::string& word) {
    return std::any_of(cell->warnings.begin(), cell->warnings.end(),
                       [&](const std::string& w) { return w.find(word) != std::string::npos; });
  };
  EXPECT_TRUE(mentions("extra is unknown"));
  EXPECT_TRUE(mentions("a.yaml does not exist"));
  EXPECT_TRUE(mentions("\"b\" has no calibration"));
}

// A robot that drove 1 m ahead and turned to its left by a quarter: what stood ahead stands to its right.
TEST(Room, StaysWhereItIsWhileWhatALinkCarriesGoesWithTheBase) {
  Workcell cell;
  WorldObject shelf, zone, box;
  shelf.name = "shelf";
  shelf.X_WO.translation() = Eigen::Vector3d(3, 0, 0.5);
  zone.name = "zone";
  zone.role = BodyRole::kKeepOut;
  zone.X_WO.translation() = Eigen::Vector3d(1, 2, 0);
  box.name = "battery";
  box.attached_link = "base_link";
  box.X_WO.translation() = Eigen::Vector3d(-0.2, 0, 0.3);
  cell.objects = {box};
  const auto carried = std::make_shared<const Workcell>(cell);
  const Pose X_OB = poseFromRpy({1, 0, 0}, {0, 0, M_PI / 2});
  EXPECT_FALSE(hasRoom(*carried));
  EXPECT_EQ(withBaseAt(carried, X_OB), carried);
  cell.objects = {shelf, zone, box};
  const auto file = std::make_shared<const Workcell>(cell);
  EXPECT_TRUE(hasRoom(*file));
  EXPECT_EQ(withBaseAt(file, Pose::Identity()), file);
  const auto now = withBaseAt(file, X_OB);
  EXPECT_LT((now->objects[0].X_WO.translation() - Eigen::Vector3d(0, -2, 0.5)).norm(), 1e-12);
  EXPECT_LT((now->objects[1].X_WO.translation() - Eigen::Vector3d(2, 0, 0)).norm(), 1e-12);
  EXPECT_TRUE(now->objects[2].X_WO.isApprox(box.X_WO));
  EXPECT_TRUE(file->objects[0].X_WO.isApprox(shelf.X_WO)) << "the file's stay";
}

TEST_F(WorkcellTest, RefusesNamingFileLineKeyValueAndWhatWasExpected) {
  const std::string robot = "robot: {urdf: robot.urdf}\n";
  const std::string good = kMinimal;
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
      {"arm: {tip: arm}\n", {"robot is missing"}},
      {"robot: {urdf: absent.urdf}\narm: {tip: arm, max_acceleration: 1}\n", {":1:", "robot.urdf", "absent.urdf"}},
      {robot + "arm: {max_acceleration: 1}\n", {":2:", "arm.tip is"}},
      {robot + "arm: {tip: nose, max_acceleration: 1}\n", {":2:", "arm.tip", "\"nose\"", "a link"}},
      {robot + "arm: {tip: arm}\n", {":2:", "arm.max_acceleration is missing"}},
      {robot + "arm: {tip: arm, max_acceleration: '4,5'}\n", {"arm.max_acceleration", "\"4,5\"", "above 0"}},
      {robot + "arm: {tip: arm, max_acceleration: -4}\n", {"\"-4\"", "above 0"}},
      {robot + "arm: {tip: arm, max_acceleration: .nan}\n", {"above 0"}},
      {robot + "arm: {tip: arm, max_acceleration: [1, 2]}\n", {"a list of 2", "a list of 1 numbers"}},
      {robot + "arm: {tip: arm, max_acceleration: 4, stop_deceleration: 3}\n", {"stop_deceleration", "at least"}},
      {robot + "arm: {tip: arm, max_acceleration: 4, limit_margin: 2}\n", {"limit_margin", "less than half"}},
      {robot + "arm: {tip: base, max_acceleration: 4}\n", {"arm.tip", "below"}},
      {good + "gripper: {joint: e, open: 1, closed: 0, max_width: 1}\n", {":3:", "gripper.joint", "\"e\"", "moving joint"}},
      {good + "gripper: {joint: g, open: 1, closed: 0, max_width: 1, links: [nose]}\n", {"nose"}},
      {good + "pan_tilts: {name: x}\n", {"pan_tilts is a map", "a list of maps"}},
      {good + "cameras: [{name: a, link: eye, pan_tilt: none}]\n", {"cameras[0].pan_tilt", "\"none\""}},
      {good + "cameras: [{name: a, link: eye}, {name: a, link: eye}]\n", {"cameras[1].name"}},
      {good + "cameras: [{name: a, link: eye, stereo_partner: z}]\n", {"stereo_partner", "\"z\""}},
      {good + "backend: {virtual: perhaps}\n", {"backend.virtual", "true or false"}},
      {good + "objects: [{name: o}]\n", {"exactly one of box"}},
      {good + "objects: [{name: o, box: [1, 0, 1]}]\n", {"objects[0].box[1]", "above 0"}},
      {good + "objects: [{name: o, mesh: {file: no.stl}}]\n", {"no.stl"}},
      {good + "objects: [{name: o, box: [1, 1, 1], pose: {xyz: [0, 0, 0], quaternion_xyzw: [1, 1, 1, 1]}}]\n", {"unit quaternion"}},
      {good + "poses: {p: {j: 3}}\n", {"poses.p", "between -1 and 1"}},
      {good + "poses: {p: {q: 0}}\n", {"poses.p", "\"q\""}},
      {good + "format: 2\n", {"format", "expected 1"}},
      {good + good, {"given twice"}},
      {"- 1\n", {"expected a map"}},
      {"a: [1\n", {"not YAML"}},
      {"", {"expected a map"}},
  };
  for (const auto& [text, expected] : cases) {
    const auto cell = loadText(text);
    ASSERT_FALSE(cell.ok()) << text;
    EXPECT_EQ(cell.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(cell.error().message.find("cell.yaml"), std::string::npos);
    for (const auto& word : expected) {
      EXPECT_NE(cell.error().message.find(word), std::string::npos) << text << " -> " << cell.error().message;
    }
  }
  EXPECT_EQ(loadWorkcell((m_folder / "absent.yaml").string()).error().code, ErrorCode::kNotFound);
}

TEST(BuiltInWorkcell, LoadsWithoutAWarning) {
  for (const char* variant : {"", "ptz"}) {
    const auto cell = loadBuiltInWorkcell(variant);
    ASSERT_TRUE(cell.ok()) << cell.error().message;
    EXPECT_TRUE(cell->warnings.empty()) << cell->warnings.front();
    EXPECT_EQ(cell->arm.joints.size(), 6u);
    EXPECT_EQ(cell->arm.tip_link, "tool_tip");
    EXPECT_TRUE(cell->backend.is_virtual);
    for (const char* pose : {"home", "stow", "ready", "look_ahead"}) {
      ASSERT_EQ(cell->poses.count(pose), 1u) << pose;
      EXPECT_EQ(cell->poses.at(pose).size(), 6u);
    }
    EXPECT_EQ(cell->cameras.size(), 5u);
  }
  EXPECT_EQ(loadBuiltInWorkcell("walking").error().code, ErrorCode::kNotFound);
}

TEST(BuiltInWorkcell, StopsFromItsFullSpeedInATenthOfASecond) {
  const auto cell = loadBuiltInWorkcell();
  ASSERT_TRUE(cell.ok());
  const MotionLimits& limits = cell->arm_limits;
  EXPECT_LE(limits.max_velocity.cwiseQuotient(limits.stop_deceleration).maxCoeff(), 0.1 + 1e-12);
}

TEST(WorkcellOfOthers, DescribesTheUr5ByFileAlone) {
  LONGARM_SKIP_WITHOUT_DATA();
  const fs::path folder = fs::temp_directory_path() / ("longarm_ur5_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string robot = tests::dataFolder() + "/robots/ur5/example-robot-data/robots/ur_description/";
  std::ofstream(folder / "ur5.yaml") << "robot: {urdf: '" << robot << "urdf/ur5_robot.urdf', srdf: '" << robot
                                     << "srdf/ur5.srdf'}\narm: {base: base_link, tip: tool0, max_acceleration: 4}\n"
                                     << "poses: {home: {shoulder_lift_joint: -1.57, elbow_joint: 1.2}}\n";
  const auto cell = loadWorkcell((folder / "ur5.yaml").string());
  fs::remove_all(folder);
  ASSERT_TRUE(cell.ok()) << cell.error().message;
  EXPECT_TRUE(cell->warnings.empty());
  EXPECT_EQ(cell->arm.joints.size(), 6u);
  EXPECT_DOUBLE_EQ(cell->poses.at("home").at("elbow_joint"), 1.2);
  EXPECT_EQ(cell->model->srdfAllowedPairs()->size(), 10u);
}

TEST(WorkcellOfOthers, RefusesHostileFilesQuickly) {
  LONGARM_SKIP_WITHOUT_DATA();
  for (const auto& entry : fs::directory_iterator(tests::dataFolder() + "/hostile")) {
    EXPECT_FALSE(loadWorkcell(entry.path().string()).ok()) << entry.path();
  }
}

}  // namespace
}  // namespace longarm::planning
