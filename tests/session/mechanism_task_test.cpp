// A door opened, a drawer pulled, a valve turned on the virtual robot with its hidden offsets: take the handle, then move.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning/macros/macro.h"
#include "planning/world/scenario.h"
#include "session/controllers/play_controller.h"
#include "session/robot/robot_runtime.h"
#include "tests/session/task_fixture.h"

namespace longarm::session {
namespace {

using Eigen::Vector3d;
using nlohmann::json;

vision::Feature lineOf(const Vector3d& a, const Vector3d& b) {
  vision::Feature line;
  line.name = "line";
  line.kind = vision::FeatureKind::kLine;
  for (const Vector3d& end : {a, b}) {
    vision::FeatureVertex vertex;
    vertex.xyz = end;
    vertex.covariance = 1e-6 * Eigen::Matrix3d::Identity();
    line.vertices.push_back(vertex);
  }
  return line;
}

class MechanismTask : public ::testing::Test {
 protected:
  void open(const std::string& scenario) {
    LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
    auto loaded = planning::loadScenario(scenario);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    m_scenario = *loaded;
    m_cell = std::make_shared<const planning::Workcell>(testing::builtInWorkcell());
    RuntimeOptions options;
    options.scenario = scenario;
    options.cameras = false;
    m_runtime = testing::robotInLockstep(m_cell, options);
    ASSERT_NE(m_runtime, nullptr);
    gripper(m_cell->gripper->open);
  }
  // Both ends of a cylinder of the scenario: where an operator would click.
  vision::Feature axisOf(const std::string& object) const {
    const auto* found = m_scenario.object(object);
    EXPECT_NE(found, nullptr);
    const double half = std::get<planning::Cylinder>(found->body.shape).length / 2;
    return lineOf(found->body.X_WO * Vector3d(0, 0, half), found->body.X_WO * Vector3d(0, 0, -half));
  }
  void gripper(double position) {
    ASSERT_TRUE(m_runtime->setGripper(position).ok());
    ASSERT_TRUE(m_runtime->step(2).ok());
  }
  void perform(const std::string& macro, const vision::Feature& feature, std::map<std::string, double> arguments) {
    planning::PlanContext context;
    context.workcell = m_cell.get();
    context.start = *m_runtime->configuration();
    context.arguments = std::move(arguments);
    const auto macros = planning::makeMacros(*m_cell);
    const auto plan = planning::findMacro(macros, macro)->plan(context, &feature);
    ASSERT_TRUE(plan.ok()) << macro << ": " << plan.reason;
    m_play.setRuntime(m_runtime.get());
    PlanRecord record;
    record.macro = macro;
    record.plan = plan;
    m_document.setPlan(record);
    m_play.play();
    for (int i = 0; i < 6000 && m_runtime->status().player != planning::PlayerState::kDone; ++i) {
      ASSERT_TRUE(m_runtime->step(0.02).ok());
      m_play.refresh(m_runtime->status());
      ASSERT_FALSE(m_runtime->status().gate.stopped) << m_runtime->status().gate.reason;
    }
    ASSERT_EQ(m_runtime->status().player, planning::PlayerState::kDone) << m_play.state().why_not_play.toStdString();
    ASSERT_TRUE(m_runtime->step(0.5).ok());
  }
  json truth() const { return testing::truthOf(*m_runtime); }
  void takeHandle(const std::string& macro, const std::string& handle) {
    const auto axis = axisOf(handle);
    perform(macro, axis, {{"radius", std::get<planning::Cylinder>(m_scenario.object(handle)->body.shape).radius}});
    gripper(m_cell->gripper->closed);
    ASSERT_EQ(truth().at("held"), handle);
  }
  void expectGoals() const { testing::expectGoals(*m_runtime); }

  planning::Scenario m_scenario;
  std::shared_ptr<const planning::Workcell> m_cell;
  Document m_document;
  JobRunner m_jobs;
  PlanController m_plans{m_document, m_jobs};
  PlayController m_play{m_document, m_plans, m_jobs};
  std::unique_ptr<RobotRuntime> m_runtime;
};

TEST_F(MechanismTask, OpensADoor) {
  open("open_door");
  if (!m_runtime) return;
  takeHandle("approach_from_side", "handle");
  const auto& hinge = *m_scenario.mechanism("door_hinge");
  perform("move_around_axis", lineOf(hinge.origin - 0.3 * hinge.axis, hinge.origin + 0.3 * hinge.axis), {{"angle", 0.6}});
  const json told = truth();
  EXPECT_EQ(told.at("held"), "handle");
  EXPECT_NEAR(told.at("mechanisms").at("door_hinge").get<double>(), 0.6, 0.02);
  expectGoals();
}

TEST_F(MechanismTask, PullsADrawerAndPushesItBack) {
  open("pull_drawer");
  if (!m_runtime) return;
  takeHandle("approach_from_side", "handle");
  const auto rail = lineOf({1.0, 0, 0.54}, {0.6, 0, 0.54});
  perform("move_parallel", rail, {{"distance", 0.12}});
  EXPECT_NEAR(truth().at("mechanisms").at("drawer").get<double>(), 0.12, 0.005);
  expectGoals();
  const double out = truth().at("mechanisms").at("drawer").get<double>();
  m_runtime->setSpeed(-1);                       // the same path back
  ASSERT_TRUE(m_runtime->play().ok());
  ASSERT_TRUE(m_runtime->step(6).ok());
  EXPECT_LT(truth().at("mechanisms").at("drawer").get<double>(), out - 0.1);
  EXPECT_EQ(truth().at("held"), "handle");
}

TEST_F(MechanismTask, TurnsAValve) {
  open("turn_valve");
  if (!m_runtime) return;
  takeHandle("approach_from_side", "rim_1");
  const auto& wheel = *m_scenario.mechanism("wheel");
  perform("move_around_axis", lineOf(wheel.origin - 0.1 * wheel.axis, wheel.origin + 0.1 * wheel.axis), {{"angle", 0.6}});
  EXPECT_NEAR(truth().at("mechanisms").at("wheel").get<double>(), 0.6, 0.03);
  expectGoals();
}

// Further than the arm reaches: it lets go, goes back, and takes the next piece of the rim, twice.
TEST_F(MechanismTask, TurnsAValveFurtherThanTheArmReachesByGrippingAgain) {
  open("turn_valve");
  if (!m_runtime) return;
  takeHandle("approach_from_side", "rim_1");
  const auto& wheel = *m_scenario.mechanism("wheel");
  const double far = 5 * M_PI / 3;
  perform("move_around_axis", lineOf(wheel.origin - 0.1 * wheel.axis, wheel.origin + 0.1 * wheel.axis),
          {{"angle", far}, {"regrip", 1}, {"pitch", M_PI / 3}});
  const json told = truth();
  EXPECT_NEAR(told.at("mechanisms").at("wheel").get<double>(), far, 0.06);
  EXPECT_NE(told.at("held"), "rim_1") << "the hand holds another piece of the rim";
  EXPECT_NE(told.at("held"), "");
  EXPECT_TRUE(told.at("contacts").empty()) << told.at("contacts").dump();
}

// The operator who pulls straight at a door: the hand comes off, nothing else happens.
TEST_F(MechanismTask, AHandThatPullsTheWrongWayComesOff) {
  open("open_door");
  if (!m_runtime) return;
  takeHandle("approach_from_side", "handle");
  perform("move_parallel", lineOf({0.8, 0.3, 0.6}, {0.8, 0, 0.6}), {{"distance", 0.12}});
  EXPECT_EQ(truth().at("held"), "");
  EXPECT_LT(truth().at("mechanisms").at("door_hinge").get<double>(), 0.2);
}

}  // namespace
}  // namespace longarm::session
