// What the selection allows, with which values it is planned, and how else it could be done.
#include <cmath>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <gtest/gtest.h>

#include "planning/macros/accuracy.h"
#include "session/controllers/plan_controller.h"
#include "tests/session/event_loop.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using Eigen::Vector3d;

class PlanControllerTest : public longarm::testing::EventLoopTest {
 protected:
  void SetUp() override {
    auto workcell = planning::loadBuiltInWorkcell();
    ASSERT_TRUE(workcell.ok()) << workcell.error().message;
    m_bench.document.setWorkcell(std::make_shared<const planning::Workcell>(*std::move(workcell)));
    m_plans.setBudget(60);               // a loaded machine must not change the answer
    auto joints = std::make_shared<JointState>();
    for (const auto& [name, value] : m_bench.document.workcell()->poses.at("ready")) {
      joints->names.push_back(name);
      joints->positions.conservativeResize(static_cast<Eigen::Index>(joints->names.size()));
      joints->positions[joints->positions.size() - 1] = value;
    }
    m_plans.setJointSource([joints] { return joints; });
  }

  FeatureId addPoint(const Vector3d& p) {
    SketchItem item;
    item.id = m_bench.document.nextFeatureId();
    item.kind = vision::FeatureKind::kPoint;
    item.name = m_bench.document.freeName(item.kind);
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      item.setPick(m_bench.snapshot(side), 0, {m_bench.scene.pixel(side, p), PickState::kFree});
    }
    m_bench.history.push(addItem(item));
    m_bench.document.select(Selection::of(item.id));
    return item.id;
  }

  MacroRow row(const char* name) const {
    for (const auto& each : m_plans.macros()) {
      if (each.name == QLatin1String(name)) return each;
    }
    ADD_FAILURE() << "no macro " << name;
    return {};
  }

  // Waits for the plan that is under way, and for what follows it at once.
  const planning::Plan* settled() {
    QElapsedTimer since;
    since.start();
    while (m_plans.state() == PlanController::State::kPlanning && since.elapsed() < 120000) {
      QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents | QEventLoop::AllEvents, 50);
    }
    return m_bench.document.plan() ? &m_bench.document.plan()->plan : nullptr;
  }

  Vector3d tool(const planning::Plan& plan, double t) const {
    const auto& cell = *m_bench.document.workcell();
    Eigen::VectorXd q = plan.start_configuration;
    JointState state;
    state.names = plan.trajectory.joint_names;
    state.positions = plan.trajectory.sample(t).positions;
    cell.model->assign(state, q);
    return cell.model->forward(q, *cell.model->linkIndex(cell.arm.tip_link)).translation();
  }

  tests::Bench m_bench;
  JobRunner m_jobs;
  PlanController m_plans{m_bench.document, m_jobs};
};

const Vector3d kNear(0.85, 0.1, 0.85);

TEST_F(PlanControllerTest, SaysWhatAboveMeansAndPlansByIt) {
  addPoint(kNear);
  EXPECT_TRUE(row("move_above").advice.contains(QStringLiteral("base's own z"))) << row("move_above").advice.toStdString();
  EXPECT_TRUE(row("grab_pipe").advice.isEmpty());
  const Vector3d up = Vector3d(0.1, -0.1, 1).normalized();
  m_plans.setUpSource([up] { return up; });
  EXPECT_TRUE(row("move_above").advice.isEmpty());
  const auto context = m_plans.contextOf(QStringLiteral("move_above"));
  ASSERT_TRUE(context && context->up);
  EXPECT_EQ(*context->up, up);
}

TEST_F(PlanControllerTest, DefaultsOfATypedPoseFollowTheRobot) {
  const auto& cell = *m_bench.document.workcell();
  auto joints = std::make_shared<JointState>();
  m_plans.setJointSource([joints] { return std::shared_ptr<const JointState>(joints); });
  const auto stand = [&](const char* pose) {
    *joints = {};
    const auto& values = cell.poses.at(pose);
    joints->positions.resize(static_cast<Eigen::Index>(values.size()));
    for (const auto& [name, value] : values) {
      joints->positions[static_cast<Eigen::Index>(joints->names.size())] = value;
      joints->names.push_back(name);
    }
    Eigen::VectorXd q = cell.model->neutral();
    cell.model->assign(*joints, q);
    return Vector3d(cell.model->forward(q, *cell.model->linkIndex(cell.arm.tip_link)).translation());
  };
  const QString macro = QStringLiteral("move_to");
  const Vector3d home = stand("home");
  EXPECT_NEAR(m_plans.arguments(macro).at("x"), home.x(), 1e-12);
  EXPECT_TRUE(row("move_to").advice.contains(QString::number(home.z(), 'f', 3))) << row("move_to").advice.toStdString();
  ASSERT_TRUE(m_plans.setArgument(macro, QStringLiteral("z"), 0.5).ok());
  const Vector3d stow = stand("stow");
  ASSERT_GT((stow - home).norm(), 0.05);
  EXPECT_NEAR(m_plans.arguments(macro).at("x"), stow.x(), 1e-12) << "what is not set follows";
  EXPECT_EQ(m_plans.arguments(macro).at("z"), 0.5) << "what is set stays";
  m_plans.resetArguments(macro);
  EXPECT_NEAR(m_plans.arguments(macro).at("z"), stow.z(), 1e-12);
}

TEST_F(PlanControllerTest, OffersWhatTheSelectionsKindAllowsAndSaysWhyNot) {
  EXPECT_TRUE(row("home").enabled) << row("home").reason.toStdString();
  EXPECT_FALSE(row("touch").enabled);
  EXPECT_TRUE(row("touch").reason.contains(QStringLiteral("point")));
  addPoint(kNear);
  EXPECT_TRUE(row("touch").enabled) << row("touch").reason.toStdString();
  EXPECT_TRUE(row("look_at").enabled);
  EXPECT_FALSE(row("grab_pipe").enabled);
  EXPECT_FALSE(row("home").enabled);
  EXPECT_FALSE(row("touch").parameters.empty());
}

TEST_F(PlanControllerTest, JudgesTheFeatureAgainstEachNeed) {
  addPoint({1.6, 0.1, 1.0});
  const double known = planning::uncertaintyOf(*m_bench.document.selectedFeature());
  ASSERT_GT(known, row("touch").accuracy_need_m);
  ASSERT_LT(known, row("look_at").accuracy_need_m);
  EXPECT_EQ(row("look_at").go, QStringLiteral("go"));
  EXPECT_TRUE(row("look_at").accuracy.isEmpty());
  EXPECT_NE(row("touch").go, QStringLiteral("go"));
  EXPECT_TRUE(row("touch").accuracy.contains(QStringLiteral("mm"))) << row("touch").accuracy.toStdString();
  EXPECT_TRUE(row("grab_pipe").go.isEmpty()) << "nothing that it takes is selected";
}

TEST_F(PlanControllerTest, PlansWithTheValuesThatWereSet) {
  addPoint(kNear);
  ASSERT_TRUE(m_plans.setArgument(QStringLiteral("touch"), QStringLiteral("stand_off"), 0.14).ok());
  ASSERT_TRUE(m_plans.plan(QStringLiteral("touch")).ok());
  const planning::Plan* plan = settled();
  ASSERT_TRUE(plan != nullptr && plan->ok()) << (plan ? plan->reason : "");
  const auto& approach = plan->stages.back();
  EXPECT_EQ(approach.name, "approach");
  EXPECT_NEAR((tool(*plan, approach.start_s) - tool(*plan, approach.end_s)).norm(), 0.14, 1e-4);
  m_plans.resetArguments(QStringLiteral("touch"));
  EXPECT_EQ(m_plans.arguments(QStringLiteral("touch")).at("stand_off"), 0.10);
}

TEST_F(PlanControllerTest, RefusesValuesBeyondLimitsAndForgetsThoseOfOtherWorkcells) {
  EXPECT_EQ(m_plans.setArgument(QStringLiteral("touch"), QStringLiteral("stand_off"), 9).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(m_plans.setArgument(QStringLiteral("touch"), QStringLiteral("from"), 0.5).error().code, ErrorCode::kOutOfLimits);
  EXPECT_EQ(m_plans.setArgument(QStringLiteral("touch"), QStringLiteral("nothing"), 1).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(m_plans.setArgument(QStringLiteral("nothing"), QStringLiteral("stand_off"), 1).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(m_plans.settings().empty());
  m_plans.setSettings({{"touch", {{"stand_off", 9}, {"gap", 0.01}, {"nothing", 1}}}, {"elsewhere", {{"a", 1}}}});
  const auto values = m_plans.arguments(QStringLiteral("touch"));
  EXPECT_EQ(values.at("stand_off"), 0.10) << "as by default";
  EXPECT_EQ(values.at("gap"), 0.01);
  EXPECT_EQ(values.count("nothing"), 0u);
}

TEST_F(PlanControllerTest, ShowsOtherWaysAndTheFirstOneAgainAfterTheLast) {
  EXPECT_FALSE(m_plans.whyNotOtherWay().isEmpty());
  addPoint(kNear);
  ASSERT_TRUE(m_plans.plan(QStringLiteral("touch")).ok());
  ASSERT_TRUE(settled() != nullptr && settled()->ok());
  const Eigen::VectorXd first = settled()->entry;
  ASSERT_GT(first.size(), 0);
  std::vector<Eigen::VectorXd> seen{first};
  bool again = false;
  for (int i = 0; i < 60 && !again; ++i) {
    ASSERT_TRUE(m_plans.planOtherWay().ok());
    const planning::Plan* plan = settled();
    ASSERT_TRUE(plan != nullptr && plan->ok()) << plan->reason;
    again = (plan->entry - first).norm() < 1e-9;
    for (const auto& other : seen) {
      EXPECT_TRUE(again || (plan->entry - other).cwiseAbs().maxCoeff() > 0.2) << "another way each time";
    }
    seen.push_back(plan->entry);
    if (seen.size() == 4) break;         // each search looks further away: enough is proved
  }
  EXPECT_GE(seen.size(), 2u);
}

TEST_F(PlanControllerTest, AFailureNamesStagePlaceAndWhatWouldHelp) {
  addPoint({1.75, 0.1, 0.9});
  ASSERT_TRUE(m_plans.plan(QStringLiteral("touch")).ok());
  const planning::Plan* plan = settled();
  ASSERT_TRUE(plan != nullptr);
  EXPECT_EQ(plan->status, planning::PlanStatus::kUnreachable) << plan->reason;
  EXPECT_EQ(plan->failed_stage, "approach");
  EXPECT_TRUE(plan->failed_pose.has_value());
  ASSERT_FALSE(plan->advice.empty());
  EXPECT_NE(plan->advice[0].find("forwards"), std::string::npos) << plan->advice[0];
}

}  // namespace
}  // namespace longarm::session
