#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "planning/robot/robot_model.h"
#include "tests/support/test_data.h"

namespace longarm::planning {
namespace {

namespace fs = std::filesystem;

/// A folder of its own for files a test writes.
class RobotModelTest : public testing::Test {
 protected:
  void SetUp() override {
    m_folder = fs::temp_directory_path() / ("longarm_robot_" + std::to_string(::getpid()));
    fs::create_directories(m_folder);
  }
  void TearDown() override { fs::remove_all(m_folder); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(m_folder / name) << text;
    return (m_folder / name).string();
  }
  Result<std::shared_ptr<const RobotModel>> loadText(const std::string& text) const {
    return RobotModel::load(write("robot.urdf", text));
  }
  /// The message of a URDF that must be refused as bad input.
  std::string refusal(const std::string& body) const {
    const auto model = loadText("<robot name='r'>" + body + "</robot>");
    if (model.ok()) return "not refused";
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(model.error().message.find("robot.urdf"), std::string::npos);
    return model.error().message;
  }
  fs::path m_folder;
};

const char* kTwoLinks = "<link name='a'/><link name='b'/>";

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& inside = "", const std::string& type = "revolute") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/>" + inside + "</joint>";
}

const char* kLimit = "<limit lower='-1' upper='2' effort='1' velocity='3'/>";

TEST_F(RobotModelTest, ReadsJointsInTheOrderOfTheFileDepthFirst) {
  const auto model = loadText(
      "<robot name='r'><link name='base'/><link name='z1'/><link name='z2'/><link name='a1'/>" +
      joint("zeta", "base", "z1", kLimit) + joint("alpha", "base", "a1", kLimit) +
      joint("omega", "z1", "z2", std::string("<axis xyz='0 0 2'/>") + kLimit) + "</robot>");
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ((*model)->actuatedNames(), (std::vector<std::string>{"zeta", "omega", "alpha"}));
  EXPECT_DOUBLE_EQ((*model)->joints()[2].axis.norm(), 1);
  EXPECT_DOUBLE_EQ((*model)->joints()[0].max_velocity, 3);
  EXPECT_EQ((*model)->links()[static_cast<std::size_t>((*model)->rootLink())].name, "base");
}

TEST_F(RobotModelTest, NeutralIsZeroOrTheMiddleOfTheLimits) {
  const auto model = loadText(
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/>" + joint("j", "a", "b", kLimit) +
      joint("k", "b", "c", "<limit lower='1' upper='2' effort='1' velocity='1'/>") + "</robot>");
  ASSERT_TRUE(model.ok());
  EXPECT_EQ((*model)->neutral(), Eigen::Vector2d(0, 1.5));
}

TEST_F(RobotModelTest, FollowsMimicsOfMimics) {
  const auto model = loadText(
      "<robot name='r'><link name='a'/><link name='b'/><link name='c'/><link name='d'/>" +
      joint("j", "a", "b", std::string("<axis xyz='0 1 0'/>") + kLimit, "prismatic") +
      joint("k", "a", "c", std::string("<axis xyz='0 1 0'/><mimic joint='j' multiplier='-2' offset='0.1'/>") + kLimit,
            "prismatic") +
      joint("l", "a", "d", std::string("<axis xyz='0 1 0'/><mimic joint='k' multiplier='3' offset='1'/>") + kLimit,
            "prismatic") +
      "</robot>");
  ASSERT_TRUE(model.ok()) << model.error().message;
  ASSERT_EQ((*model)->dof(), 1);
  std::vector<Pose> X;
  (*model)->forward(Eigen::VectorXd::Constant(1, 0.5), X);
  EXPECT_DOUBLE_EQ(X[1].translation().y(), 0.5);
  EXPECT_DOUBLE_EQ(X[2].translation().y(), -0.9);
  EXPECT_DOUBLE_EQ(X[3].translation().y(), 3 * -0.9 + 1);
}

TEST_F(RobotModelTest, RefusesBrokenDescriptionsNamingElementAndValue) {
  const std::string two = kTwoLinks;
  const std::string three = two + "<link name='c'/>";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "no link"},
      {"<link name='a'/><link name='a'/>", "\"a\""},
      {two, "both without a parent"},
      {two + joint("j", "a", "x", kLimit), "\"x\" does not exist"},
      {two + joint("j", "a", "b", "<origin xyz='nan 0 0'/>", "fixed"), "<origin xyz=\"nan 0 0\">"},
      {two + joint("j", "a", "b", "<origin xyz='$(optenv X 0 0 0)'/>", "fixed"), "$(optenv X 0 0 0)"},
      {two + joint("j", "a", "b", "<origin xyz='0 0'/>", "fixed"), "expected 3"},
      {two + joint("j", "a", "b", std::string("<axis xyz='0 0 0'/>") + kLimit), "no direction"},
      {two + joint("j", "a", "b", "<limit lower='2' upper='-2' effort='1' velocity='1'/>"), "2 is above upper limit -2"},
      {two + joint("j", "a", "b"), "needs <limit"},
      {two + joint("j", "a", "b", kLimit, "wobbly"), "\"wobbly\""},
      {two + joint("j", "a", "a", kLimit), "both \"a\""},
      {three + joint("j", "a", "c", "", "fixed") + joint("k", "b", "c", "", "fixed"), "two parents"},
      {three + joint("j", "b", "c", "", "fixed") + joint("k", "c", "b", "", "fixed"), "loop"},
      {two + joint("j", "a", "b", std::string("<mimic joint='q'/>") + kLimit), "\"q\", which does not exist"},
      {three + joint("j", "a", "b", std::string("<mimic joint='k'/>") + kLimit) +
           joint("k", "b", "c", std::string("<mimic joint='j'/>") + kLimit),
       "mimics itself"},
      {"<link name='a'><collision><geometry><box size='1 -1 1'/></geometry></collision></link>", "size=\"1 -1 1\""},
      {"<link name='a'><collision><geometry><torus/></geometry></collision></link>", "\"torus\""},
      {"<link name='a'><visual/></link>", "no <geometry>"},
  };
  for (const auto& [body, expected] : cases) {
    const std::string message = refusal(body);
    EXPECT_NE(message.find(expected), std::string::npos) << body << "\n -> " << message;
  }
}

TEST_F(RobotModelTest, RefusesFilesBeyondTheBounds) {
  EXPECT_NE(loadText("<!DOCTYPE r><robot name='r'><link name='a'/></robot>").error().message.find("document type"),
            std::string::npos);
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 70; ++i) deep += "<x>";
  EXPECT_NE(loadText(deep).error().message.find("deeper than 64"), std::string::npos);
  std::string many = "<robot name='r'>";
  for (int i = 0; i < 10001; ++i) many += "<link name='l'/>";
  EXPECT_NE(loadText(many).error().message.find("more than 10000"), std::string::npos);
  EXPECT_NE(loadText(std::string((8u << 20) + 1, ' ')).error().message.find("bytes"), std::string::npos);
  EXPECT_EQ(RobotModel::load((m_folder / "absent.urdf").string()).error().code, ErrorCode::kNotFound);
}

TEST_F(RobotModelTest, ReadsNumbersWithADecimalPointInAnyLocale) {
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // Where it is not installed this checks the C locale.
  const auto model = loadText(std::string("<robot name='r'>") + kTwoLinks +
                              joint("j", "a", "b", "<origin xyz='1.5 0 0' rpy='0.25 0 0'/>", "fixed") + "</robot>");
  std::setlocale(LC_ALL, "C");
  ASSERT_TRUE(model.ok());
  EXPECT_DOUBLE_EQ((*model)->joints()[0].X_PJ.translation().x(), 1.5);
  EXPECT_NEAR((*model)->joints()[0].X_PJ.linear()(2, 1), std::sin(0.25), 1e-15);
}

TEST_F(RobotModelTest, ReadsStatesPairsAndGroupsOfAnSrdf) {
  const auto urdf = write("robot.urdf", std::string("<robot name='r'>") + kTwoLinks + joint("j", "a", "b", kLimit) +
                                            "</robot>");
  const auto srdf = write("robot.srdf",
                          "<robot name='r'><group name='arm'><chain base_link='a' tip_link='b'/></group>"
                          "<group_state name='home' group='arm'><joint name='j' value='0.5'/></group_state>"
                          "<group_state name='far' group='arm'><joint name='j' value='9'/><joint name='?' value='1'/>"
                          "</group_state><disable_collisions link1='b' link2='a'/>"
                          "<disable_collisions link1='b' link2='ghost'/></robot>");
  const auto model = RobotModel::load(urdf, srdf);
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_DOUBLE_EQ((*model)->namedStates().at("home").at("j"), 0.5);
  ASSERT_TRUE((*model)->srdfAllowedPairs().has_value());
  EXPECT_EQ((*model)->srdfAllowedPairs()->count({0, 1}), 1u);
  ASSERT_EQ((*model)->groups().size(), 1u);
  EXPECT_EQ((*model)->groups()[0].name, "arm");
  EXPECT_EQ((*model)->warnings().size(), 3u);  // 9 outside the limits, joint "?", link "ghost".
  const auto bad = write("bad.srdf", "<robot name='r'><group_state name='s'><joint name='j' value='1,5'/></group_state></robot>");
  EXPECT_NE(RobotModel::load(urdf, bad).error().message.find("\"1,5\""), std::string::npos);
}

TEST_F(RobotModelTest, WarnsOfMissingMeshesAndGoesOn) {
  const auto model = loadText(
      "<robot name='r'><link name='a'><collision><geometry><mesh filename='package://p/m.stl'/></geometry></collision>"
      "</link></robot>");
  ASSERT_TRUE(model.ok());
  ASSERT_EQ((*model)->warnings().size(), 1u);
  EXPECT_NE((*model)->warnings()[0].find("package://p/m.stl"), std::string::npos);
  EXPECT_NE((*model)->warnings()[0].find("NOT checked"), std::string::npos);
}

TEST(RobotModelOfOthers, PutsTheToolOfTheUr5WhereItIsPublished) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto model = RobotModel::load(tests::dataFolder() +
                                      "/robots/ur5/example-robot-data/robots/ur_description/urdf/ur5_robot.urdf");
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_TRUE((*model)->warnings().empty());
  const auto arm = (*model)->chain("base_link", "tool0");
  ASSERT_TRUE(arm.ok()) << arm.error().message;
  const int tip = (*model)->linkIndex("tool0").value();
  const auto toolAt = [&](std::vector<double> joints) {
    Eigen::VectorXd q = (*model)->neutral();
    setGroupPositions(**model, *arm, Eigen::Map<Eigen::VectorXd>(joints.data(), 6), q);
    return (*model)->forward(q, tip);
  };
  EXPECT_LT((toolAt({-2.238, -1.153, -2.174, 0.185, 0.667, 0}).translation() -
             Eigen::Vector3d(0.29992, 0.09986, 0.49992)).norm(), 2e-5);  // Published to five decimals.
  EXPECT_LT((toolAt({0, 0, 0, 0, 0, 0}).translation() - Eigen::Vector3d(.8173, .1914, -.0055)).norm(), 1e-4);
  const Pose up = toolAt({0, -M_PI / 2, 0, 0, M_PI / 2, 0});
  EXPECT_LT((up.translation() - Eigen::Vector3d(.0946, .1092, .9887)).norm(), 1e-4);
  Eigen::Matrix3d R;
  R << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_LT((up.linear() - R).norm(), 1e-9);
}

TEST(RobotModelOfOthers, MatchesItsJacobianByDifferences) {
  LONGARM_SKIP_WITHOUT_DATA();
  const auto model = RobotModel::load(
      tests::dataFolder() + "/robots/spot_arm_collision_only/spot_description/urdf/spot_with_arm.urdf");
  ASSERT_TRUE(model.ok()) << model.error().message;
  EXPECT_EQ((*model)->warnings().size(), 13u);  // The visual meshes that are not there.
  const auto& links = (*model)->links();
  const auto arm = (*model)->chain(links[static_cast<std::size_t>((*model)->rootLink())].name, "finger_1");
  ASSERT_TRUE(arm.ok()) << arm.error().message;
  Eigen::VectorXd q = (*model)->neutral();
  for (Eigen::Index i = 0; i < q.size(); ++i) q[i] += 0.1 * std::sin(static_cast<double>(i));
  const Eigen::MatrixXd J = (*model)->jacobian(q, *arm);
  const int tip = (*model)->linkIndex("finger_1").value();
  constexpr double kStep = 1e-6;
  for (std::size_t k = 0; k < arm->joints.size(); ++k) {
    Eigen::VectorXd moved = q;
    moved[(*model)->joints()[static_cast<std::size_t>(arm->joints[k])].q_index] += kStep;
    const Pose a = (*model)->forward(q, tip), b = (*model)->forward(moved, tip);
    Vector6d change;
    change << logSO3(b.linear() * a.linear().transpose()), b.translation() - a.translation();
    EXPECT_LT((change / kStep - J.col(static_cast<Eigen::Index>(k))).norm(), 1e-5);  // One-sided difference.
  }
}

TEST(RobotModelOfOthers, RefusesHostileFilesQuickly) {
  LONGARM_SKIP_WITHOUT_DATA();
  for (const auto& entry : fs::directory_iterator(tests::dataFolder() + "/hostile")) {
    const auto path = entry.path();
    if (path.filename() == "a.urdf") continue;  // A sound one.
    const auto model = RobotModel::load(path.string());
    ASSERT_FALSE(model.ok()) << path;
    EXPECT_NE(model.error().message.find(path.filename().string()), std::string::npos) << model.error().message;
  }
}

}  // namespace
}  // namespace longarm::planning
