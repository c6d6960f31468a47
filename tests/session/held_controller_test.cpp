// What the gripper holds is found out, planned with, and put down where the gripper opens.
#include <QCoreApplication>
#include <gtest/gtest.h>

#include "planning/macros/grip.h"
#include "planning/motion/check_trajectory.h"
#include "session/controllers/held_controller.h"
#include "session/commands/world_commands.h"
#include "tests/planning/macro_scene.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 0.02;

class HeldControllerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    m_bench.document.setWorkcell(std::make_shared<const planning::Workcell>(cell()));
    QObject::connect(&m_held, &HeldController::said, [this](const QString& sentence) { m_said = sentence; });
  }
  static const planning::Workcell& cell() { return tests::builtIn(); }
  static const std::string& root() { return cell().model->links()[static_cast<std::size_t>(cell().model->rootLink())].name; }

  // The arm at the end of a grasp of the pipe, the plan on the table.
  Eigen::VectorXd grasp() {
    const auto line = tests::featureOf(vision::FeatureKind::kLine, {{0.75, -0.2, 0.45}, {0.75, 0.2, 0.45}}, 0.001, "Pipe 1");
    planning::PlanContext context = tests::contextOf(cell());
    context.arguments = {{"radius", kRadius}};
    context.budget_s = 60;
    PlanRecord record;
    record.macro = "grab_pipe";
    record.feature = {7};
    record.plan = tests::macroOf("grab_pipe").plan(context, &line);
    EXPECT_TRUE(record.plan.ok()) << record.plan.reason;
    const Eigen::VectorXd end = withFingers(tests::planAt(cell(), record.plan, record.plan.trajectory.duration()));
    m_bench.document.setPlan(std::move(record));
    return end;
  }
  static Eigen::VectorXd withFingers(Eigen::VectorXd q, double at = kRadius) {
    const auto joint = cell().model->jointIndex(cell().gripper->joint);
    q[cell().model->joints()[static_cast<std::size_t>(*joint)].q_index] = at;
    return q;
  }
  WorldItem pipeItem() {
    WorldItem item;
    item.id = m_bench.document.nextWorldId();
    item.kind = WorldKind::kPipe;
    item.name = "Pipe 1";
    item.parent = root();
    item.size = {2 * kRadius, 2 * kRadius, 0.4};
    item.X_WO.linear() = Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitX()).toRotationMatrix();
    item.X_WO.translation() = Vector3d(0.75, 0, 0.45);
    item.source = {7};
    m_bench.history.push(addWorldItem(item));
    return item;
  }
  void poll(bool holding, const Eigen::VectorXd& q, int times = 6) {
    for (int i = 0; i < times; ++i) m_held.refresh(holding, q);
  }
  Eigen::VectorXd lifted(const Eigen::VectorXd& from) {
    Eigen::VectorXd q = from;
    q[cell().model->joints()[static_cast<std::size_t>(cell().arm.joints[0])].q_index] += 0.5;   // turned about the shoulder
    return q;
  }

  tests::Bench m_bench;
  WorldController m_world{m_bench.document, m_bench.history};
  HeldController m_held{m_bench.document, m_world};
  QString m_said;
};

TEST_F(HeldControllerTest, KnowsTheTargetOfTheGraspThatWasPlayedAndCarriesIt) {
  const Eigen::VectorXd q = grasp();
  poll(true, q, 3);
  EXPECT_FALSE(m_held.held()) << "a finger that slips says both";
  poll(true, q);
  ASSERT_TRUE(m_held.held());
  EXPECT_EQ(m_held.held()->body.name, "Pipe 1");
  EXPECT_TRUE(m_said.contains(QStringLiteral("Pipe 1"))) << m_said.toStdString();
  const auto there = m_held.held()->at(cell(), q);
  EXPECT_LT((there.X_WO.translation() - Vector3d(0.75, 0, 0.45)).norm(), 1e-6);
  const auto away = m_held.held()->at(cell(), lifted(q));
  EXPECT_GT((away.X_WO.translation() - there.X_WO.translation()).norm(), 0.2);
}

TEST_F(HeldControllerTest, AMeasuredPlaceThatDoesNotFitTheFingersIsHeldAllTheSame) {
  const Eigen::VectorXd q = grasp();
  poll(true, q);
  ASSERT_TRUE(m_held.held());
  planning::WorldObject body = m_held.held()->at(cell(), q);
  body.X_WO.translation().x() += 0.008;  // measured that wrong: the fingers would not touch it
  EXPECT_TRUE(planning::gripAt(cell(), {body}, q).held.empty());
  EXPECT_EQ(planning::gripAt(cell(), {body}, q, {"Pipe 1"}).held, std::vector<std::string>{"Pipe 1"});
  planning::PlanContext context = tests::contextOf(cell());
  context.start = q;
  context.budget_s = 60;
  context.objects = {body};
  context.held = {"Pipe 1"};
  const planning::Plan plan = tests::macroOf("ready").plan(context, nullptr);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_NE(plan.notes[0].find("Pipe 1"), std::string::npos);
  const auto carried = planning::withHeldAttached(cell(), {body}, planning::gripAt(cell(), {body}, q, {"Pipe 1"}), q);
  planning::CheckOptions options;
  options.objects = carried;
  EXPECT_TRUE(planning::checkTrajectory(cell(), plan.trajectory, q, options)->ok);
}

TEST_F(HeldControllerTest, PutsABodyOfTheWorldDownWhereTheGripperOpensAsOneStep) {
  const Eigen::VectorXd q = grasp();
  const WorldItem before = pipeItem();
  poll(true, q);
  ASSERT_TRUE(m_held.held());
  EXPECT_EQ(m_held.held()->item, before.id);
  EXPECT_TRUE(m_held.obstacles({}).empty()) << "what is held is no obstacle where it stood";
  const auto steps = m_bench.history.position();
  poll(false, lifted(q));
  EXPECT_FALSE(m_held.held());
  EXPECT_EQ(m_bench.history.position(), steps + 1);
  EXPECT_GT((m_bench.document.world()[0].X_WO.translation() - before.X_WO.translation()).norm(), 0.2);
  EXPECT_EQ(m_held.obstacles({}).size(), 1u);
  m_bench.history.undo();
  EXPECT_EQ(m_bench.document.world()[0], before);
}

// A tool goes where it is put down, whichever of its bodies was held; a door stays on its hinge.
TEST_F(HeldControllerTest, PutsATemplateDownByThePartThatWasHeld) {
  const Eigen::VectorXd q = grasp();
  m_bench.document.clearPlan();
  for (const bool hinged : {false, true}) {
    WorldItem item = pipeItem();
    m_bench.history.undo();
    planning::TemplatePart grip{"grip", planning::Cylinder{kRadius, 0.4}, Pose::Identity(), hinged};
    grip.X_TP.translation() = Vector3d(0.1, 0, 0);
    item.kind = WorldKind::kTemplate;
    item.X_WO = item.X_WO * grip.X_TP.inverse();
    item.parts = {grip};
    m_bench.history.push(addWorldItem(item));
    poll(true, q);
    ASSERT_TRUE(m_held.held()) << m_said.toStdString();
    EXPECT_EQ(m_held.held()->body.name, "Pipe 1.grip");
    const Pose X_WP = m_held.held()->at(cell(), lifted(q)).X_WO;
    poll(false, lifted(q));
    const WorldItem& after = *m_bench.document.worldItem(item.id);
    if (hinged) {
      EXPECT_EQ(after, item);
    } else {
      EXPECT_LT(((after.X_WO * grip.X_TP).matrix() - X_WP.matrix()).norm(), 1e-9);
      m_bench.history.undo();
    }
    m_bench.history.undo();
  }
}

TEST_F(HeldControllerTest, FindsAKnownBodyBetweenTheFingersAndSaysWhenItIsNone) {
  const Eigen::VectorXd q = grasp();
  m_bench.document.clearPlan();
  poll(true, q);
  EXPECT_FALSE(m_held.held());
  EXPECT_TRUE(m_said.contains(QStringLiteral("not known"))) << m_said.toStdString();
  poll(false, q);
  const WorldItem pipe = pipeItem();
  poll(true, q);
  ASSERT_TRUE(m_held.held()) << m_said.toStdString();
  EXPECT_EQ(m_held.held()->item, pipe.id);
  m_held.forget();
  EXPECT_FALSE(m_held.held());
}

}  // namespace
}  // namespace longarm::session
