// Things that are carried about, and the scenario that calibration is practised on.
#include <gtest/gtest.h>

#include "planning/world/scenario.h"

namespace longarm::planning {
namespace {

std::string scenarioWith(const std::string& object) {
  return "format: 1\nname: test\nobjects:\n  - {name: thing, shape: {box: [0.1, 0.1, 0.1]}, " + object + "}\n";
}

TEST(ScenarioRoute, RestsTravelsGentlyAndBeginsAgain) {
  const auto scenario = parseScenario(scenarioWith("travel_s: 2, route: [{pose: {xyz: [0, 0, 1]}, rest_s: 3}, {pose: {xyz: [1, 0, 1]}, rest_s: 1}]"), "s.yaml");
  ASSERT_TRUE(scenario.ok()) << scenario.error().message;
  const ScenarioObject& thing = scenario->objects.front();
  EXPECT_EQ(thing.body.X_WO.translation(), Eigen::Vector3d(0, 0, 1)) << "it begins at the first stop";
  const auto x = [&](double t) { return thing.onRoute(t).translation().x(); };
  EXPECT_EQ(x(0), 0);
  EXPECT_EQ(x(3), 0);
  EXPECT_NEAR(x(4), 0.5, 1e-12);
  EXPECT_LT(x(3.2), 0.04) << "a hand starts gently";
  EXPECT_EQ(x(5.5), 1);
  EXPECT_NEAR(x(7), 0.5, 1e-12) << "on its way back to the first";
  EXPECT_EQ(x(8 + 2.9), 0);
}

TEST(ScenarioRoute, MistakesAreToldWithTheirPlace) {
  for (const auto& [text, part] : {std::pair{"route: [{pose: {xyz: [0, 0]}}]", "route[0]"}, {"route: [{rest: 2}]", "rest"}, {"travel_s: 0", "travel_s"}}) {
    const auto scenario = parseScenario(scenarioWith(text), "s.yaml");
    ASSERT_FALSE(scenario.ok()) << text;
    EXPECT_NE(scenario.error().message.find(part), std::string::npos) << scenario.error().message;
  }
}

TEST(ScenarioRoute, TheBuiltInBoardVisitsEnoughPlaces) {
  const auto scenario = loadScenario("calibration_board");
  ASSERT_TRUE(scenario.ok()) << scenario.error().message;
  const auto* board = scenario->object("board");
  ASSERT_NE(board, nullptr);
  EXPECT_GE(board->route.size(), 12U);
  EXPECT_FALSE(board->body.collides) << "whoever holds it keeps it out of the arm's way";
}

TEST(ScenarioRoute, SomethingIsHeldBeforeACamera) {
  const auto scenario = parseScenario(scenarioWith("before: ptz_left, route: [{pose: {xyz: [0, 0, 1]}}]"), "s.yaml");
  ASSERT_TRUE(scenario.ok()) << scenario.error().message;
  EXPECT_EQ(scenario->objects.front().before, "ptz_left");
  for (const char* name : {"calibration_zoom", "calibration_fixture"}) {
    const auto built_in = loadScenario(name);
    ASSERT_TRUE(built_in.ok()) << built_in.error().message;
    EXPECT_FALSE(built_in->objects.front().before.empty());
  }
}

const char kStage[] = "format: 1\nname: s\ntitle: t\nobjects:\n"
    "  - {name: bar, shape: {cylinder: {radius: 0.01, length: 0.2}}, pose: {xyz: [1, 0, 1]}}\n"
    "  - {name: lid, shape: {box: [0.2, 0.2, 0.02]}, pose: {xyz: [1, 0, 1]}}\n"
    "mechanisms:\n  - {name: hinge, kind: hinge, moves: [lid], axis: [0, 0, 1], range_deg: [0, 90]}\ntask:\n";

TEST(ScenarioTask, NamesWhatIsMarkedAndWhatIsDoneWithIt) {
  const auto scenario = parseScenario(std::string(kStage) + "  - {mark: bar, macro: touch, gripper: close}\n"
      "  - {mark: hinge, macro: move_around_axis, arguments: {angle: 0.5}}\n"
      "  - {mark: lid, at: [[-1, -1, 1], [1, -1, 1], [1, 1, 1]], macro: press}\n", "s.yaml");
  ASSERT_TRUE(scenario.ok()) << scenario.error().message;
  ASSERT_EQ(scenario->task.size(), 3u);
  EXPECT_EQ(scenario->task[0].object, "bar");
  EXPECT_TRUE(scenario->task[0].close_gripper);
  EXPECT_EQ(scenario->task[1].mechanism, "hinge");
  EXPECT_DOUBLE_EQ(scenario->task[1].arguments.at("angle"), 0.5);
  EXPECT_EQ(scenario->task[2].at.size(), 3u);
}

TEST(ScenarioTask, MistakesAreToldWithTheirPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {"  - {mark: bar}\n", "macro"},
      {"  - {mark: door, macro: touch}\n", "\"door\""},
      {"  - {mark: lid, macro: touch}\n", "at is missing"},
      {"  - {mark: hinge, at: [[0, 0, 1]], macro: touch}\n", "its axis is marked"},
      {"  - {mark: lid, at: [[0, 0, 9]], macro: touch}\n", "outside -2 to 2"},
      {"  - {mark: lid, at: [[0, 0]], macro: touch}\n", "[x, y, z]"},
      {"  - {mark: bar, macro: touch, arguments: {gap: far}}\n", "arguments.gap"},
      {"  - {mark: bar, macro: touch, gripper: open}\n", "expected close"},
      {"  - {mark: bar, macro: touch, speed: 1}\n", "speed"}};
  for (const auto& [text, word] : cases) {
    const auto scenario = parseScenario(std::string(kStage) + text, "s.yaml");
    ASSERT_FALSE(scenario.ok()) << text;
    EXPECT_NE(scenario.error().message.find("task[0]"), std::string::npos) << scenario.error().message;
    EXPECT_NE(scenario.error().message.find(word), std::string::npos) << scenario.error().message;
  }
}

TEST(ScenarioSlope, LeansGravityAndKeepsTheWorldsFrame) {
  const char* head = "format: 1\nname: s\nslope_deg: ";
  const auto pitched = parseScenario(std::string(head) + "[0, 10]\n", "s.yaml");
  ASSERT_TRUE(pitched.ok()) << pitched.error().message;
  // Nose up by a pitch of -10 degrees would lean up forwards; ten degrees nose down lean it back.
  EXPECT_LT((pitched->up - Eigen::Vector3d(-std::sin(10 * M_PI / 180), 0, std::cos(10 * M_PI / 180))).norm(), 1e-12);
  const auto rolled = parseScenario(std::string(head) + "[10, 0]\n", "s.yaml");
  ASSERT_TRUE(rolled.ok()) << rolled.error().message;
  EXPECT_LT((rolled->up - Eigen::Vector3d(0, std::sin(10 * M_PI / 180), std::cos(10 * M_PI / 180))).norm(), 1e-12);
  const auto steep = parseScenario(std::string(head) + "[0, 80]\n", "s.yaml");
  ASSERT_FALSE(steep.ok());
  EXPECT_NE(steep.error().message.find("slope_deg"), std::string::npos) << steep.error().message;
}

TEST(ScenarioSlides, OnlyWhatCanStandSlides) {
  const auto ball = parseScenario("format: 1\nname: s\nobjects: [{name: b, shape: {sphere: {radius: 0.1}}, slides: true}]\n", "s.yaml");
  ASSERT_FALSE(ball.ok());
  EXPECT_NE(ball.error().message.find("slides"), std::string::npos) << ball.error().message;
  const auto goal = parseScenario("format: 1\nname: s\ngoals: [{move: nothing, way: 0.1}]\n", "s.yaml");
  ASSERT_FALSE(goal.ok());
  EXPECT_NE(goal.error().message.find("nothing"), std::string::npos) << goal.error().message;
}

}  // namespace
}  // namespace longarm::planning
