// What the gripper pushes slides on what it stands on, as friction lets it, and falls where that ends.
#include <gtest/gtest.h>

#include "app/virtual_robot/pusher.h"
#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector3d;

// A crate on a table under the hand, which points down: the tool's frame is put where a test wants it by moving the base.
class Push : public ::testing::Test {
 protected:
  Push() : m_q(builtIn().model->neutral()), m_pusher(builtIn()) {
    const auto joint = builtIn().model->jointIndex(builtIn().gripper->joint);
    m_q[builtIn().model->joints()[static_cast<std::size_t>(*joint)].q_index] = 0;       // shut: one blunt end
  }
  void build(const planning::Shape& shape, const Vector3d& at, double yaw = 0) {
    m_scenario = emptyScenario();
    planning::ScenarioObject crate;
    crate.body.name = "crate";
    crate.body.shape = shape;
    crate.body.X_WO.translation() = at;
    crate.body.X_WO.linear() = Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
    crate.slides = true;
    planning::ScenarioObject table;
    table.body.name = "table";
    table.body.shape = planning::Box{{0.6, 0.6, 0.04}};
    table.body.X_WO.translation() = Vector3d(0, 0, 0.38);
    m_scenario.objects = {crate, table};
    m_world = std::make_unique<TrueWorld>(m_scenario);
  }
  // The tool's tip at p, pointing down, fingers along y.
  void put(const Vector3d& p) {
    Pose X_WT = Pose::Identity();
    X_WT.linear() = Eigen::AngleAxisd(M_PI, Vector3d::UnitX()).toRotationMatrix();
    X_WT.translation() = p;
    const Pose X_BT = builtIn().model->forward(m_q, *builtIn().model->linkIndex(builtIn().arm.tip_link));
    m_pusher.step(m_q, X_WT * X_BT.inverse(), *m_world);
  }
  void sweep(const Vector3d& from, const Vector3d& to) {
    constexpr int kSteps = 400;
    for (int i = 0; i <= kSteps; ++i) put(from + (to - from) * i / kSteps);
  }
  Pose crate() const { return m_world->objects()[0].body.X_WO; }
  double yaw() const { return std::atan2(crate().linear()(1, 0), crate().linear()(0, 0)); }

  planning::Scenario m_scenario;
  Eigen::VectorXd m_q;
  Pusher m_pusher;
  std::unique_ptr<TrueWorld> m_world;
};

const planning::Box kCrate{{0.08, 0.12, 0.1}};

TEST_F(Push, ThroughTheMiddleOfAFaceItGoesStraight) {
  build(kCrate, {0, 0, 0.45});
  sweep({-0.15, 0, 0.44}, {-0.02, 0, 0.44});
  const double half_finger = 0.014;
  EXPECT_NEAR(crate().translation().x(), -0.02 + half_finger + 0.04, 1e-3) << "the face lies at the finger";
  EXPECT_NEAR(crate().translation().y(), 0, 1e-3);
  EXPECT_NEAR(crate().translation().z(), 0.45, 1e-12);
  EXPECT_NEAR(yaw(), 0, 0.01);
}

TEST_F(Push, OffTheMiddleItTurnsAwayFromTheFinger) {
  build(kCrate, {0, 0, 0.45});
  sweep({-0.15, 0.04, 0.44}, {-0.02, 0.04, 0.44});
  EXPECT_GT(crate().translation().x(), 0.01);
  EXPECT_LT(yaw(), -0.1) << "clockwise: pushed on its left";
}

// Lynch 1992: a push at (x, y) along x turns by -y v / (c^2 + y^2) and moves by c^2 v / (c^2 + y^2) for a contact on the x axis' side.
TEST_F(Push, ASmallStepIsWhatTheLimitSurfaceSays) {
  build(planning::Cylinder{0.05, 0.1}, {0, 0, 0.45});
  sweep({-0.2, 0, 0.44}, {-0.03, 0, 0.44});
  EXPECT_NEAR(crate().translation().y(), 0, 1e-3);
  EXPECT_NEAR(yaw(), 0, 1e-3) << "a round one is never turned by its own normal";
  EXPECT_NEAR(crate().translation().x(), -0.03 + 0.014 + 0.05, 2e-3);
}

TEST_F(Push, FromAboveItStays) {
  build(kCrate, {0, 0, 0.45});
  sweep({0, 0, 0.56}, {0, 0, 0.512});
  EXPECT_EQ(crate().translation(), Vector3d(0, 0, 0.45));
}

TEST_F(Push, WhatDoesNotSlideStays) {
  build(kCrate, {0, 0, 0.45});
  m_scenario.objects[0].slides = false;
  m_world = std::make_unique<TrueWorld>(m_scenario);
  sweep({-0.15, 0, 0.44}, {-0.02, 0, 0.44});
  EXPECT_EQ(crate().translation(), Vector3d(0, 0, 0.45));
}

TEST_F(Push, AWallBehindItHoldsIt) {
  build(kCrate, {0, 0, 0.45});
  planning::ScenarioObject wall;
  wall.body.name = "wall";
  wall.body.shape = planning::Box{{0.02, 0.6, 0.3}};
  wall.body.X_WO.translation() = Vector3d(0.08, 0, 0.55);
  m_scenario.objects.push_back(wall);
  m_world = std::make_unique<TrueWorld>(m_scenario);
  sweep({-0.15, 0, 0.44}, {0, 0, 0.44});
  EXPECT_NEAR(crate().translation().x(), 0.03, 2e-3) << "its far face stands at the wall";
}

TEST_F(Push, OverTheEdgeItFalls) {
  build(kCrate, {0.2, 0, 0.45});
  sweep({0.05, 0, 0.44}, {0.33, 0, 0.44});
  EXPECT_GT(crate().translation().x() - 0.04, 0.3) << "off the table";
  for (int i = 0; i < 400; ++i) m_world->step(0.005);
  EXPECT_NEAR(crate().translation().z(), 0.05, 2e-3) << "on the ground";
}

TEST(PushGoal, IsReachedByTheWayOverTheGround) {
  auto scenario = planning::loadScenario("crate");
  ASSERT_TRUE(scenario.ok()) << scenario.error().message;
  EXPECT_TRUE(scenario->object("crate")->slides);
  scenario->goals = {{"move", "crate", 0.03}};
  const auto body = bodyOf(*scenario);
  EXPECT_FALSE(body->goals()[0].reached);
}

}  // namespace
}  // namespace longarm::virtual_robot
