// Doors, valves and drawers of the virtual world: they move only as their hinge or rail lets them.
#include <gtest/gtest.h>

#include "app/virtual_robot/mechanism.h"
#include "app/virtual_robot/true_world.h"
#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector3d;
using planning::ScenarioMechanism;

ScenarioMechanism hinge(double upper) {
  ScenarioMechanism spec;
  spec.name = "hinge";
  spec.origin = {1, 0.4, 0};
  spec.axis = -Vector3d::UnitZ();
  spec.upper = upper;
  return spec;
}

TEST(Mechanism, TurnsAboutItsHingeWithinItsRange) {
  Mechanism door(hinge(1.5), {0});
  const Vector3d grip(1, 0, 0.5);
  EXPECT_LT((door.motion(0) * grip - grip).norm(), 1e-12);
  const Vector3d hand = door.motion(0.6) * grip;
  EXPECT_LT(hand.x(), 0.9) << "towards the robot";
  EXPECT_LT(door.follow(grip, hand), 1e-12);
  EXPECT_NEAR(door.value(), 0.6, 1e-12);
  EXPECT_NEAR(door.follow(grip, hand + Vector3d(0, 0, 0.01)), 0.01, 1e-12) << "across its way it does not give";
  EXPECT_NEAR(door.value(), 0.6, 1e-12);
  EXPECT_GT(door.follow(grip, door.motion(1.9) * grip), 0.1);
  EXPECT_EQ(door.value(), 1.5);
}

TEST(Mechanism, AValveTurnsMoreThanOnceRound) {
  ScenarioMechanism spec = hinge(15);
  Mechanism valve(spec, {0});
  const Vector3d grip(1, 0, 0.5);
  for (double turn = 0; turn < 14; turn += 0.1) {
    ASSERT_LT(valve.follow(grip, valve.motion(turn) * grip), 1e-9);
    ASSERT_NEAR(valve.value(), turn, 1e-9);
  }
}

TEST(Mechanism, SlidesAlongItsRail) {
  ScenarioMechanism spec;
  spec.kind = ScenarioMechanism::Kind::kSlide;
  spec.axis = -Vector3d::UnitX();
  spec.upper = 0.3;
  Mechanism drawer(spec, {0});
  EXPECT_NEAR(drawer.follow({1, 0, 0.5}, {0.8, 0.01, 0.5}), 0.01, 1e-12);
  EXPECT_NEAR(drawer.value(), 0.2, 1e-12);
  EXPECT_NEAR(drawer.follow({1, 0, 0.5}, {1.1, 0, 0.5}), 0.1, 1e-12) << "it is shut";
  EXPECT_EQ(drawer.value(), 0);
}

// A bar between the fingers of the robot where it stands, on a rail along the tool's x.
planning::Scenario railScene() {
  const Pose X_WT = bodyOf(emptyScenario())->X_WT();
  planning::ScenarioObject bar;
  bar.body.name = "bar";
  bar.body.shape = planning::Cylinder{0.015, 0.2};
  bar.body.X_WO = X_WT;
  bar.body.X_WO.linear() = X_WT.linear() * Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).toRotationMatrix();
  bar.graspable = true;
  auto scenario = emptyScenario();
  scenario.objects = {bar};
  ScenarioMechanism rail;
  rail.kind = ScenarioMechanism::Kind::kSlide;
  rail.name = "rail";
  rail.moves = {"bar"};
  rail.axis = X_WT.linear().col(2);
  rail.lower = -0.3;
  rail.upper = 0.3;
  scenario.mechanisms = {rail};
  scenario.goals = {{"open", "rail", 0.01}};
  return scenario;
}

TEST(CarriedObject, StandsBeforeItsCameraAndStepsBackAsTheLensTurnsIn) {
  planning::Scenario scenario;
  planning::ScenarioObject board;
  board.body.name = "board";
  board.before = "ptz_left";
  board.route = {{poseFromRpy({0.1, -0.05, 0.5}, {0, 0, 0}), 2}};
  scenario.objects = {board};
  TrueWorld world(scenario);
  const Pose X_WC = poseFromRpy({1, 2, 0.8}, {-1.5707963267948966, 0, -1.5707963267948966});
  const auto pixels = [&](double focal) {
    const Vector3d p = X_WC.inverse() * world.objects()[0].body.X_WO.translation();
    return Vector3d(focal * p.x() / p.z(), focal * p.y() / p.z(), p.z());
  };
  world.showTo("ptz_left", X_WC, 1);
  world.step(0.01);
  const Vector3d wide = pixels(743);
  EXPECT_NEAR(wide.z(), 0.5, 1e-12);
  EXPECT_NEAR(wide.x(), 743 * 0.2, 1e-9);
  world.showTo("ptz_left", X_WC, 8);
  world.step(0.01);
  const Vector3d narrow = pixels(8 * 743);
  EXPECT_NEAR(narrow.z(), 4, 1e-12);
  EXPECT_NEAR(narrow.x(), wide.x(), 1e-9) << "as large in the picture as before";
  EXPECT_NEAR(narrow.y(), wide.y(), 1e-9);
}

TEST(GuidedObject, IsHeldLedLostAndStays) {
  const auto scenario = railScene();
  TrueWorld world(scenario);
  ASSERT_TRUE(world.guided(0));
  const Pose X_WT = bodyOf(emptyScenario())->X_WT();
  world.hold(0, X_WT.inverse() * world.objects()[0].body.X_WO);
  EXPECT_FALSE(world.heldFreely());
  Pose moved = X_WT;
  moved.translation() += 0.05 * scenario.mechanisms[0].axis;
  EXPECT_TRUE(world.carry(moved));
  EXPECT_NEAR(world.mechanisms()[0].value(), 0.05, 1e-12);
  EXPECT_LT((world.objects()[0].body.X_WO.translation() - moved.translation()).norm(), 1e-12);
  moved.translation() += 0.03 * X_WT.linear().col(1);
  EXPECT_FALSE(world.carry(moved)) << "pulled off its way";
  const Pose before = world.objects()[0].body.X_WO;
  world.release();
  world.step(0.5);
  EXPECT_TRUE(world.objects()[0].body.X_WO.isApprox(before)) << "it does not fall";
  world.place(0, Pose::Identity());
  EXPECT_TRUE(world.objects()[0].body.X_WO.isApprox(before)) << "no finger pushes it aside";
}

TEST(GuidedObject, FollowsTheArmAndReachesTheGoal) {
  const auto body = bodyOf(railScene());
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  EXPECT_FALSE(body->goals()[0].reached);
  const Vector3d before = body->X_WT().translation();
  moveArm(*body, (Eigen::VectorXd(6) << 0, 0.03, 0, 0, 0, 0).finished(), 1);
  const double along = (body->X_WT().translation() - before).dot(body->scenario().mechanisms[0].axis);
  ASSERT_GT(std::abs(along), 0.002) << "this sweep does not lead along the rail";
  EXPECT_NEAR(body->world().mechanisms()[0].value(), along, 1e-6);
  EXPECT_EQ(body->goals()[0].reached, std::abs(along) >= 0.01);
}

TEST(ScenarioMechanisms, AreReadAndTheirErrorsNamed) {
  for (const char* name : {"open_door", "turn_valve", "pull_drawer", "scan_panel", "package", "crate", "hatch", "slope"}) {
    const auto scenario = planning::loadScenario(name);
    EXPECT_TRUE(scenario.ok()) << scenario.error().message;
  }
  const auto door = planning::loadScenario("open_door");
  ASSERT_TRUE(door.ok() && door->mechanism("door_hinge") != nullptr);
  EXPECT_NEAR(door->mechanism("door_hinge")->upper, 110 * M_PI / 180, 1e-12);
  EXPECT_NEAR(door->goals[1].amount, 30 * M_PI / 180, 1e-12);
  const std::string scene = "format: 1\nname: x\nobjects:\n  - {name: a, shape: {box: [1, 1, 1]}, pose: {xyz: [0, 0, 0]}}\nmechanisms:\n";
  const std::pair<const char*, const char*> wrong[] = {
      {"  - {name: m, kind: wheel, moves: [a], range_deg: [0, 9]}\n", "expected hinge or slide"},
      {"  - {name: m, kind: hinge, moves: [b], range_deg: [0, 9]}\n", "no object is called \"b\""},
      {"  - {name: m, kind: hinge, moves: [], range_deg: [0, 9]}\n", "moves names no object"},
      {"  - {name: m, kind: hinge, moves: [a]}\n", "range_deg"},
      {"  - {name: m, kind: slide, moves: [a], range_m: [0.1, 0.2]}\n", "does not hold 0"},
      {"  - {name: m, kind: slide, moves: [a], axis: [0, 0, 0], range_m: [0, 0.2]}\n", "axis is zero"},
      {"  - {name: m, kind: slide, moves: [a], range_m: [0, 0.2]}\n  - {name: n, kind: slide, moves: [a], range_m: [0, 0.2]}\n", "moved already"}};
  for (const auto& [text, says] : wrong) {
    const auto read = planning::parseScenario(scene + text, "scene.yaml");
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_NE(read.error().message.find(says), std::string::npos) << read.error().message;
  }
  const auto goal = planning::parseScenario(scene + "  - {name: m, kind: slide, moves: [a], range_m: [0, 0.2]}\ngoals:\n  - {open: n, way: 0.1}\n", "scene.yaml");
  ASSERT_FALSE(goal.ok());
  EXPECT_NE(goal.error().message.find("no mechanism is called \"n\""), std::string::npos) << goal.error().message;
}

}  // namespace
}  // namespace longarm::virtual_robot
