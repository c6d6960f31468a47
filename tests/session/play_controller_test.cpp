// From a plan on the table to motion: preview until Play, and no motion from a stale plan.
#include <QObject>

#include "session/controllers/play_controller.h"
#include "tests/session/runtime_fixture.h"

namespace longarm::session {
namespace {

using longarm::testing::RuntimeFixture;
using planning::PlayerState;

class PlayControllerTest : public RuntimeFixture {
 protected:
  void SetUp() override {
    start();
    m_document.setWorkcell(m_workcell);
    m_plans.setJointSource([this] { return m_runtime->jointState(); });
    m_play.setRuntime(m_runtime.get());
    refresh();
  }
  void refresh() { m_play.refresh(m_runtime->status()); }
  void run(double seconds) {
    for (double t = 0; t < seconds; t += 0.02) {
      step(0.02);
      refresh();
    }
  }
  void showPlan(const Trajectory& trajectory) {
    PlanRecord record;
    record.macro = "test";
    record.plan.status = planning::PlanStatus::kOk;
    record.plan.trajectory = trajectory;
    m_document.setPlan(record);
  }
  PlayerState player() const { return m_runtime->status().player; }

  Document m_document;
  JobRunner m_jobs;
  PlanController m_plans{m_document, m_jobs};
  PlayController m_play{m_document, m_plans, m_jobs};
};

TEST_F(PlayControllerTest, WithoutAPlanSaysWhatToDo) {
  EXPECT_FALSE(m_play.state().has_plan);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_FALSE(m_play.state().why_not_play.isEmpty());
  int failed = 0;
  QObject::connect(&m_play, &PlayController::failed, &m_play, [&failed](const QString&) { ++failed; });
  m_play.play();
  EXPECT_EQ(failed, 1);
  EXPECT_EQ(player(), PlayerState::kEmpty);
}

TEST_F(PlayControllerTest, APlanIsOnlyShownUntilPlay) {
  showPlan(motion());
  EXPECT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
  EXPECT_FALSE(m_play.state().can_back_up);
  EXPECT_FALSE(m_play.state().why_not_back_up.isEmpty());
  const Eigen::VectorXd before = measured();
  m_play.scrub(m_play.state().duration_s / 2);
  EXPECT_NEAR(m_play.state().cursor_s, m_play.state().duration_s / 2, 1e-12);
  run(0.5);
  EXPECT_EQ(player(), PlayerState::kEmpty) << "looking loads nothing";
  EXPECT_LT((measured() - before).norm(), 1e-9);
}

TEST_F(PlayControllerTest, PlaysBacksUpAndReturnsToTheStart) {
  showPlan(motion());
  m_play.play();
  EXPECT_TRUE(m_play.state().loaded);
  run(0.6 * m_play.state().duration_s);
  EXPECT_TRUE(m_play.state().playing);
  EXPECT_GT(m_play.state().cursor_s, 0);
  m_play.backUp();
  run(2 * m_play.state().duration_s);
  EXPECT_EQ(player(), PlayerState::kReady);
  EXPECT_LT((measured() - m_home).norm(), 1e-3);
}

TEST_F(PlayControllerTest, AtTheEndAsksForTheNextMotion) {
  showPlan(motion());
  m_play.play();
  run(m_play.state().duration_s + 1);
  EXPECT_EQ(player(), PlayerState::kDone);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_TRUE(m_play.state().can_back_up);
}

TEST_F(PlayControllerTest, RefusesAPlanThatDoesNotStartWhereTheRobotIs) {
  auto elsewhere = motion();
  for (auto& point : elsewhere.points) point.positions(1) += 0.05;
  showPlan(elsewhere);
  EXPECT_TRUE(m_play.state().stale);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_TRUE(m_play.state().why_not_play.contains(QStringLiteral("joint_2"))) << m_play.state().why_not_play.toStdString();
  m_play.play();
  run(0.2);
  EXPECT_EQ(player(), PlayerState::kEmpty);
}

TEST_F(PlayControllerTest, AsksBeforeAMotionWhoseFeatureIsKnownTooPoorly) {
  showPlan(motion());
  auto record = *m_document.plan();
  record.plan.go = "ask";
  record.plan.accuracy_note = "The feature is known to 8 mm, this needs 6 mm.";
  m_document.setPlan(record);
  EXPECT_TRUE(m_play.state().ask);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_EQ(m_play.state().why_not_play.toStdString(), record.plan.accuracy_note);
  m_play.acceptAccuracy();
  EXPECT_FALSE(m_play.state().ask);
  EXPECT_TRUE(m_play.state().can_play);
  m_document.setPlan(record);
  EXPECT_FALSE(m_play.state().can_play) << "each plan is accepted by itself";
  record.plan.go = "no_go";
  m_document.setPlan(record);
  EXPECT_FALSE(m_play.state().ask);
  m_play.acceptAccuracy();
  m_play.play();
  run(0.2);
  EXPECT_EQ(player(), PlayerState::kEmpty) << "beyond three times the need nobody is asked";
}

TEST_F(PlayControllerTest, NeedsResetAndAFreshPlayAfterStop) {
  showPlan(motion());
  m_play.play();
  run(0.5);
  m_runtime->stop("operator", "test");
  run(1);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_TRUE(m_play.state().why_not_play.contains(QStringLiteral("STOP")));
  ASSERT_TRUE(m_runtime->resetStop().ok());
  const Eigen::VectorXd stopped = measured();
  run(1);
  EXPECT_LT((measured() - stopped).norm(), 1e-6) << "nothing resumes by itself";
  EXPECT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
  m_play.play();
  run(m_play.state().duration_s + 1);
  EXPECT_EQ(player(), PlayerState::kDone);
}

TEST_F(PlayControllerTest, ForgetsTheLoadedMotionWhenThePlanIsDiscarded) {
  showPlan(motion());
  m_play.play();
  run(0.3);
  m_document.clearPlan();
  EXPECT_NE(player(), PlayerState::kEmpty) << "a moving arm keeps its path until it stands";
  m_play.pause();
  run(2);
  EXPECT_EQ(player(), PlayerState::kEmpty);
  EXPECT_FALSE(m_play.state().has_plan);
}

TEST_F(PlayControllerTest, CannotPlayWithoutARobot) {
  showPlan(motion());
  m_play.setRuntime(nullptr);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_TRUE(m_play.state().can_scrub) << "looking needs no robot";
}

}  // namespace
}  // namespace longarm::session
