// A template dropped onto the sketch of a scenario, and its action pressed: the virtual door opens, the valve turns, the drawer
// comes out.
#include <cmath>

#include <nlohmann/json.hpp>

#include "planning/world/scenario.h"
#include "session/commands/sketch_commands.h"
#include "session/controllers/snapshot_maker.h"
#include "session/controllers/template_controller.h"
#include "session/robot/robot_runtime.h"
#include "tests/session/event_loop.h"
#include "tests/session/task_fixture.h"

namespace longarm::session {
namespace {

using Eigen::Vector3d;
using nlohmann::json;
using vision::PaneSide;

class TemplateTask : public testing::EventLoopTest {
 protected:
  void open(const std::string& scenario) {
    LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT();
    m_cell = std::make_shared<const planning::Workcell>(testing::builtInWorkcell());
    RuntimeOptions options;
    options.scenario = scenario;
    options.cameras = false;
    m_runtime = testing::robotInLockstep(m_cell, options);
    ASSERT_NE(m_runtime, nullptr);
    m_document.setWorkcell(m_cell);
    m_plans.setBudget(60);
    m_plans.setJointSource([this] { return m_runtime->jointState(); });
    m_templates.setHands({[this] { return m_runtime->jointState(); }, [this](double p) { return m_runtime->setGripper(p); },
                          [this] { return m_runtime->holding(); }});
    EXPECT_TRUE(m_templates.reload().empty());
    QObject::connect(&m_templates, &TemplateController::failed, [this](const QString& what) { m_said = what.toStdString(); });
    QObject::connect(&m_plans, &PlanController::failed, [this](const QString& what) { m_said = what.toStdString(); });
  }

  // What an operator marks in the pictures of the stereo head.
  void sketch(vision::FeatureKind kind, const std::vector<Vector3d>& points) {
    ASSERT_TRUE(m_runtime->step(0.5).ok());
    std::vector<SnapshotPtr> snapshots;
    for (const char* camera : {"head_left", "head_right"}) {
      auto snapshot = std::make_shared<vision::Snapshot>();
      snapshot->id = {snapshots.size() + 1};
      snapshot->view = cameraView(*m_cell, camera, *m_runtime->jointState()).value();
      snapshot->image = cv::Mat(480, 640, CV_8UC1, cv::Scalar(90));
      snapshots.push_back(std::move(snapshot));
    }
    m_history.push(addSnapshots(m_document, snapshots, PaneSide::kLeft));
    SketchItem item;
    item.id = m_document.nextFeatureId();
    item.kind = kind;
    item.name = "mark";
    for (const auto& snapshot : snapshots) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        item.setPick(snapshot->id, static_cast<int>(i), {snapshot->view.project(points[i]).value(), PickState::kFree});
      }
    }
    m_history.push(addItem(item));
    m_document.select(Selection::of(item.id));
    ASSERT_TRUE(m_document.measurement(item.id).feature.has_value()) << m_document.measurement(item.id).reason;
  }

  WorldItemId drop(const char* name) {
    const Status dropped = m_templates.drop(QString::fromLatin1(name));
    EXPECT_TRUE(dropped.ok()) << dropped.error().message;
    return m_document.world().empty() ? WorldItemId{} : m_document.world().back().id;
  }

  // Presses the action, and Play whenever a motion is shown.
  void press(WorldItemId item, const char* action) {
    m_said.clear();
    const Status begun = m_templates.begin(item, QString::fromLatin1(action));
    ASSERT_TRUE(begun.ok()) << begun.error().message;
    PlanId played;
    for (int i = 0; i < 4000 && m_templates.running(); ++i) {
      QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
      ASSERT_TRUE(m_runtime->step(0.1).ok());
      const auto status = m_runtime->status();
      ASSERT_FALSE(status.gate.stopped) << status.gate.reason;
      const auto& plan = m_document.plan();
      if (m_plans.state() == PlanController::State::kIdle && plan && plan->plan.ok() && plan->id != played && m_templates.running()) {
        played = plan->id;
        ++m_plays;
        ASSERT_TRUE(m_plans.checkFresh(*m_runtime->jointState()).ok());
        ASSERT_TRUE(m_runtime->load(plan->plan.trajectory).ok());
        ASSERT_TRUE(m_runtime->play().ok());
        continue;
      }
      m_templates.refresh(status.moving, status.gate.stopped, status.player == planning::PlayerState::kDone);
    }
    ASSERT_FALSE(m_templates.running()) << m_templates.progress().toStdString();
    ASSERT_TRUE(m_runtime->step(0.5).ok());
  }

  json truth() const { return testing::truthOf(*m_runtime); }

  void expectGoals() const { testing::expectGoals(*m_runtime); }

  std::shared_ptr<const planning::Workcell> m_cell;
  std::unique_ptr<RobotRuntime> m_runtime;
  Document m_document;
  EditHistory m_history{m_document};
  JobRunner m_jobs;
  PlanController m_plans{m_document, m_jobs};
  WorldController m_world{m_document, m_history};
  TemplateController m_templates{m_document, m_history, m_plans, m_world};
  std::string m_said;
  int m_plays = 0;
};

TEST_F(TemplateTask, OpensADoor) {
  open("open_door");
  if (!m_runtime) return;
  sketch(vision::FeatureKind::kPlane, {{0.93, 0.225, 0.88}, {0.93, 0.225, 0.22}, {0.93, -0.225, 0.22}});
  const auto door = drop("door");
  EXPECT_NEAR(m_document.worldItem(door)->parameters.at("width"), 0.45, 0.01);
  press(door, "open");
  EXPECT_NE(m_said.find("done"), std::string::npos) << m_said;
  EXPECT_EQ(m_plays, 2) << "to the handle, and about the hinge; nothing was played that was not shown";
  EXPECT_EQ(truth().at("held"), "handle");
  EXPECT_NEAR(truth().at("mechanisms").at("door_hinge").get<double>(), 0.6, 0.03);
  EXPECT_NEAR(m_document.worldItem(door)->parameters.at("opened"), 0.6, 1e-9) << "and stands open in the pictures";
  expectGoals();
  // Once more: the handle is in the hand already.
  ASSERT_TRUE(m_templates.setParameter(door, "opening", -0.3).ok());
  press(door, "open");
  EXPECT_EQ(m_plays, 3);
  EXPECT_NEAR(truth().at("mechanisms").at("door_hinge").get<double>(), 0.3, 0.04);
}

TEST_F(TemplateTask, TurnsAValve) {
  open("turn_valve");
  if (!m_runtime) return;
  sketch(vision::FeatureKind::kPoint, {{0.86, 0, 0.6}});
  const auto valve = drop("valve");
  press(valve, "turn");
  EXPECT_NE(m_said.find("done"), std::string::npos) << m_said;
  EXPECT_NEAR(truth().at("mechanisms").at("wheel").get<double>(), 0.6, 0.05);
  expectGoals();
}

TEST_F(TemplateTask, PullsADrawer) {
  open("pull_drawer");
  if (!m_runtime) return;
  sketch(vision::FeatureKind::kPlane, {{0.89, 0.22, 0.62}, {0.89, 0.22, 0.44}, {0.89, -0.22, 0.44}});
  const auto drawer = drop("drawer");
  press(drawer, "pull");
  EXPECT_NE(m_said.find("done"), std::string::npos) << m_said;
  EXPECT_NEAR(truth().at("mechanisms").at("drawer").get<double>(), 0.12, 0.01);
  EXPECT_NEAR(m_document.worldItem(drawer)->parameters.at("pulled"), 0.12, 1e-9);
  expectGoals();
}

TEST_F(TemplateTask, GraspsACrate) {
  open("crate");
  if (!m_runtime) return;
  const auto scenario = planning::loadScenario("crate");
  const Pose& X = scenario->object("crate")->body.X_WO;
  const Vector3d half = std::get<planning::Box>(scenario->object("crate")->body.shape).size / 2;
  const Vector3d corner(-half.x(), -half.y(), half.z());
  sketch(vision::FeatureKind::kTriad, {X * corner, X * Vector3d(half.x(), -half.y(), half.z()), X * Vector3d(-half.x(), half.y(), half.z()),
                                       X * Vector3d(-half.x(), -half.y(), -half.z())});
  const auto crate = drop("crate");
  EXPECT_NEAR(m_document.worldItem(crate)->parameters.at("height"), 0.1, 0.005);
  press(crate, "grasp");
  EXPECT_NE(m_said.find("done"), std::string::npos) << m_said;
  EXPECT_EQ(truth().at("held"), "crate");
}

// Nothing goes on after STOP, after another plan, or when it is ended.
TEST_F(TemplateTask, EndsWhenTheOperatorDoesSomethingElse) {
  open("open_door");
  if (!m_runtime) return;
  sketch(vision::FeatureKind::kPlane, {{0.93, 0.225, 0.88}, {0.93, 0.225, 0.22}, {0.93, -0.225, 0.22}});
  const auto door = drop("door");
  ASSERT_TRUE(m_templates.begin(door, "open").ok());
  EXPECT_FALSE(m_templates.begin(door, "open").ok()) << "one at a time";
  m_templates.refresh(false, true, false);
  EXPECT_FALSE(m_templates.running());
  EXPECT_NE(m_said.find("STOP"), std::string::npos);
  ASSERT_TRUE(m_runtime->step(2).ok());
  ASSERT_TRUE(m_templates.begin(door, "open").ok());
  ASSERT_TRUE(waitFor([&] {
    (void)m_runtime->step(0.1);
    m_templates.refresh(false, false, false);
    return m_document.plan().has_value();
  }));
  EXPECT_TRUE(m_templates.running()) << m_said;
  m_plans.discard();
  m_templates.refresh(false, false, false);
  EXPECT_FALSE(m_templates.running());
  ASSERT_TRUE(m_templates.begin(door, "open").ok());
  m_history.undo();                               // the door itself
  m_templates.refresh(false, false, false);
  EXPECT_FALSE(m_templates.running());
  EXPECT_TRUE(m_document.world().empty());
}

}  // namespace
}  // namespace longarm::session
