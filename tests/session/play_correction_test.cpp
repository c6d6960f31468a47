// Corrections while a motion is played: paused or moving, backed up over, refused with a sentence.
#include <QCoreApplication>
#include <QElapsedTimer>
#include <QObject>

#include "session/controllers/play_controller.h"
#include "tests/session/event_loop.h"
#include "tests/session/runtime_fixture.h"

namespace longarm::session {
namespace {

using longarm::testing::RuntimeFixture;
using planning::PlayerState;

class PlayCorrectionTest : public RuntimeFixture {
 protected:
  void SetUp() override {
    auto loaded = planning::loadBuiltInWorkcell();
    ASSERT_TRUE(loaded.ok()) << loaded.error().message;
    auto cell = std::make_shared<planning::Workcell>(*std::move(loaded));
    const auto names = cell->armJointNames();
    m_home.resize(static_cast<Eigen::Index>(names.size()));
    for (std::size_t i = 0; i < names.size(); ++i) m_home[static_cast<Eigen::Index>(i)] = cell->poses.at("ready").at(names[i]);
    m_workcell = cell;
    start();
    m_document.setWorkcell(m_workcell);
    m_plans.setBudget(60);
    m_plans.setJointSource([this] { return m_runtime->jointState(); });
    m_play.setRuntime(m_runtime.get());
    QObject::connect(&m_play, &PlayController::failed, &m_play, [this](const QString& why) { m_failed << why; });
    plan();
  }

  void plan() {
    ASSERT_TRUE(m_plans.plan(QStringLiteral("look_ahead")).ok());
    waitFor([this] { return m_plans.state() == PlanController::State::kIdle; });
    ASSERT_TRUE(m_document.plan() && m_document.plan()->plan.ok()) << (m_document.plan() ? m_document.plan()->plan.reason : "");
  }
  void waitFor(const std::function<bool()>& done) {
    QElapsedTimer since;
    since.start();
    while (!done() && since.elapsed() < 120000) QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
  }
  void run(double seconds) {
    for (double t = 0; t < seconds; t += 0.02) {
      step(0.02);
      QCoreApplication::processEvents();
      m_play.refresh(m_runtime->status());
    }
  }
  // Until nothing of a correction is left to do; the robot's time goes on only between its jobs.
  void settle() {
    QElapsedTimer since;
    since.start();
    while (m_play.state().correcting && since.elapsed() < 120000) run(0.1);
  }
  Pose tool() const {
    Eigen::VectorXd q = m_workcell->model->neutral();
    m_workcell->model->assign(*m_runtime->jointState(), q);
    return m_workcell->model->forward(q, *m_workcell->model->linkIndex(m_workcell->arm.tip_link));
  }
  PlayerState player() const { return m_runtime->status().player; }

  longarm::testing::TestApplication m_application;
  Document m_document;
  JobRunner m_jobs;
  PlanController m_plans{m_document, m_jobs};
  PlayController m_play{m_document, m_plans, m_jobs};
  QStringList m_failed;
};

const planning::Nudge kUp{Eigen::Matrix3d::Identity(), {0, 0, 0.005}, {0, 0, 0}};

TEST_F(PlayCorrectionTest, NeedsAMotionUnderWay) {
  EXPECT_FALSE(m_play.state().why_not_correct.isEmpty());
  m_play.nudge(kUp);
  EXPECT_EQ(m_failed.size(), 1);
  EXPECT_EQ(player(), PlayerState::kEmpty);
}

TEST_F(PlayCorrectionTest, PausedMovesTheToolByTheStepAndWaitsForPlay) {
  m_play.play();
  run(0.4 * m_play.state().duration_s);
  m_play.pause();
  run(1);
  ASSERT_EQ(player(), PlayerState::kPaused);
  const Eigen::Vector3d before = tool().translation();
  m_play.nudge(kUp);
  m_play.nudge(kUp);
  settle();
  ASSERT_TRUE(m_failed.isEmpty()) << m_failed.join(QLatin1Char('\n')).toStdString();
  EXPECT_LT((tool().translation() - before - Eigen::Vector3d(0, 0, 0.01)).norm(), 1e-4);
  const Eigen::VectorXd rests = measured();
  run(1);
  EXPECT_LT((measured() - rests).norm(), 1e-6) << "it waits for Play";
  EXPECT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
  m_play.play();
  run(m_play.state().duration_s + 1);
  EXPECT_EQ(player(), PlayerState::kDone);
  EXPECT_LT((tool().translation() - m_document.plan()->plan.goal.translation()).norm(), 1e-3);
  m_play.backUp();
  run(m_play.state().duration_s + 2);
  EXPECT_EQ(player(), PlayerState::kReady);
  EXPECT_LT((measured() - m_home).norm(), 1e-3) << "back over the correction to where it began";
}

// Looking ahead along the motion changes nothing about where the arm is corrected.
TEST_F(PlayCorrectionTest, ACorrectionAfterScrubbingIsMadeWhereTheArmStands) {
  m_play.play();
  run(0.4 * m_play.state().duration_s);
  m_play.pause();
  run(1);
  const Eigen::Vector3d before = tool().translation();
  m_play.scrub(0.9 * m_play.state().duration_s);
  m_play.nudge(kUp);
  settle();
  ASSERT_TRUE(m_failed.isEmpty()) << m_failed.join(QLatin1Char('\n')).toStdString();
  EXPECT_LT((tool().translation() - before - Eigen::Vector3d(0, 0, 0.005)).norm(), 1e-4);
}

TEST_F(PlayCorrectionTest, MovingPausesCorrectsAndGoesOnByItself) {
  m_play.play();
  run(0.3 * m_play.state().duration_s);
  ASSERT_EQ(player(), PlayerState::kPlaying);
  m_play.nudge(kUp);
  settle();
  ASSERT_TRUE(m_failed.isEmpty()) << m_failed.join(QLatin1Char('\n')).toStdString();
  bool corrected = false;
  for (const auto& stage : m_document.plan()->plan.stages) corrected = corrected || stage.name == "correction";
  EXPECT_TRUE(corrected);
  run(m_play.state().duration_s + 1);
  EXPECT_EQ(player(), PlayerState::kDone) << "without another Play";
}

// The offset is eased out over 50 mm of way, or three times its size; from there on the arm is where it was planned to be.
TEST_F(PlayCorrectionTest, ResumingLeadsBackOntoThePlannedPathWithinAMillimetre) {
  const planning::Plan planned = m_document.plan()->plan;
  const auto toolOf = [this](const planning::Plan& plan, double t) {
    Eigen::VectorXd q = plan.start_configuration;
    planning::setGroupPositions(*m_workcell->model, m_workcell->arm, plan.trajectory.sample(t).positions, q);
    return m_workcell->model->forward(q, *m_workcell->model->linkIndex(m_workcell->arm.tip_link)).translation();
  };
  std::vector<Eigen::Vector3d> path;
  for (double t = 0; t <= planned.trajectory.duration(); t += 0.002) path.push_back(toolOf(planned, t));
  const auto off = [&path](const Eigen::Vector3d& p) {
    double least = 1e9;
    for (const auto& q : path) least = std::min(least, (q - p).norm());
    return least;
  };
  m_play.play();
  run(0.4 * m_play.state().duration_s);
  m_play.pause();
  run(1);
  m_play.nudge({Eigen::Matrix3d::Identity(), {0, 0, 0.02}, {0, 0, 0}});
  settle();
  ASSERT_TRUE(m_failed.isEmpty()) << m_failed.join(QLatin1Char('\n')).toStdString();
  EXPECT_GT(off(tool().translation()), 0.01) << "corrected";
  m_play.play();
  double way = 0, worst_after = 0;
  Eigen::Vector3d last = tool().translation();
  for (double t = 0; t < 60 && player() != PlayerState::kDone; t += 0.02) {
    run(0.02);
    const Eigen::Vector3d here = tool().translation();
    way += (here - last).norm();
    last = here;
    if (way > 0.08) worst_after = std::max(worst_after, off(here));
  }
  EXPECT_EQ(player(), PlayerState::kDone);
  EXPECT_GT(way, 0.12) << "there was way left to see it on";
  EXPECT_LT(worst_after, 1e-3);
}

// What was planned with another calibration, or for another cell, is not played; planning again, which is one button, is.
TEST_F(PlayCorrectionTest, ACalibrationThatChangedMakesThePlanStaleUntilItIsPlannedAgain) {
  ASSERT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
  auto changed = std::make_shared<planning::Workcell>(*m_workcell);
  changed->cameras.front().sigma_px = 0.7;
  m_document.setWorkcell(changed);
  m_play.refresh(m_runtime->status());
  EXPECT_TRUE(m_play.state().stale);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_TRUE(m_play.state().why_not_play.contains(QStringLiteral("calibration"))) << m_play.state().why_not_play.toStdString();
  m_play.play();
  run(0.5);
  EXPECT_EQ(player(), PlayerState::kEmpty) << "nothing moves";
  EXPECT_EQ(m_failed.size(), 1);
  ASSERT_TRUE(m_plans.replan().ok());
  waitFor([this] { return m_plans.state() == PlanController::State::kIdle; });
  m_play.refresh(m_runtime->status());
  EXPECT_FALSE(m_play.state().stale);
  EXPECT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
}

// Also under way: a paused motion does not go on by a calibration that it was not planned with.
TEST_F(PlayCorrectionTest, ACalibrationThatChangesWhilePausedHoldsTheMotion) {
  m_play.play();
  run(0.4 * m_play.state().duration_s);
  m_play.pause();
  run(1);
  m_document.setWorkcell(std::make_shared<planning::Workcell>(*m_workcell));
  m_play.refresh(m_runtime->status());
  EXPECT_TRUE(m_play.state().stale);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_FALSE(m_play.state().can_back_up);
}

TEST_F(PlayCorrectionTest, ARefusedOneLeavesTheMotionAsItWas) {
  m_play.play();
  run(0.4 * m_play.state().duration_s);
  m_play.pause();
  run(1);
  const auto id = m_document.plan()->id;
  const Eigen::VectorXd before = measured();
  m_play.nudge({Eigen::Matrix3d::Identity(), {0, 0, 5}, {0, 0, 0}});
  settle();
  EXPECT_EQ(m_failed.size(), 1);
  EXPECT_EQ(m_document.plan()->id, id);
  EXPECT_LT((measured() - before).norm(), 1e-6);
  m_play.play();
  run(m_play.state().duration_s + 1);
  EXPECT_EQ(player(), PlayerState::kDone);
}

}  // namespace
}  // namespace longarm::session
