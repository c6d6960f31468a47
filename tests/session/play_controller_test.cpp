// From a plan on the table to motion: preview until Play, and no motion from a stale plan.
#include <random>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QObject>

#include "session/controllers/play_hand.h"
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

// There and back again, as two stages.
TEST_F(PlayControllerTest, StepsFromStageToStageBothWays) {
  Trajectory there = motion();
  const double border = there.duration();
  const std::size_t n = there.points.size();
  there.points.back().accelerations.setZero();
  for (std::size_t i = 1; i < n; ++i) {
    TrajectoryPoint back = there.points[n - 1 - i];
    back.t = 2 * border - back.t;
    back.velocities = -back.velocities;
    there.points.push_back(back);
  }
  PlanRecord record;
  record.macro = "test";
  record.plan.status = planning::PlanStatus::kOk;
  record.plan.trajectory = there;
  record.plan.stages = {{"there", 0, border, false}, {"back", border, 2 * border, false}};
  m_document.setPlan(record);
  EXPECT_TRUE(m_play.state().why_not_stage.isEmpty()) << m_play.state().why_not_stage.toStdString();
  EXPECT_FALSE(m_play.state().why_not_stage_back.isEmpty());
  m_play.playStage();
  run(border + 1);
  EXPECT_EQ(player(), PlayerState::kPaused);
  EXPECT_EQ(m_runtime->status().arm_cursor, border);
  EXPECT_LT((measured() - there.sample(border).positions).norm(), 1e-6);
  m_play.playStage();
  run(border + 1);
  EXPECT_EQ(player(), PlayerState::kDone);
  EXPECT_FALSE(m_play.state().why_not_stage.isEmpty());
  m_play.backUpStage();
  run(0.5);
  EXPECT_TRUE(m_play.state().playing);
  run(border + 1);
  EXPECT_EQ(m_runtime->status().arm_cursor, border);
  m_play.backUpStage();
  run(border + 1);
  EXPECT_EQ(player(), PlayerState::kReady);
}

// Two stages with the gripper between them, and one after.
class GripperBetweenStages : public PlayControllerTest {
 protected:
  void SetUp() override {
    PlayControllerTest::SetUp();
    m_gripper->setObject(0.02);
    run(0.2);                            // until it is active
    ASSERT_TRUE(m_runtime->setGripper(0).ok());
    run(1);
    ASSERT_TRUE(m_runtime->holding());
    Trajectory there = motion();
    m_border = there.duration();
    const std::size_t n = there.points.size();
    for (int leg = 1; leg < 3; ++leg) {
      for (std::size_t i = 1; i < n; ++i) {
        TrajectoryPoint point = there.points[leg == 1 ? n - 1 - i : i];
        if (leg == 1) point.velocities = -point.velocities;
        point.t = leg == 1 ? 2 * m_border - point.t : point.t + 2 * m_border;
        there.points.push_back(point);
      }
    }
    PlanRecord record;
    record.macro = "test";
    record.plan.status = planning::PlanStatus::kOk;
    record.plan.trajectory = there;
    record.plan.stages = {{"act", 0, m_border, false, planning::GripperStep{0.05, false}},
                          {"return", m_border, 2 * m_border, false, planning::GripperStep{0, true}},
                          {"act", 2 * m_border, 3 * m_border, false}};
    m_document.setPlan(record);
    QObject::connect(&m_play, &PlayController::failed, &m_play, [this](const QString& why) { m_failed << why; });
  }
  bool open() const { return m_runtime->gripperPosition() > 0.049; }
  double cursor() const { return m_runtime->status().arm_cursor; }

  double m_border = 0;
  QStringList m_failed;
};

TEST_F(GripperBetweenStages, IsCommandedWhileTheArmRestsAndThenTheMotionGoesOnByItself) {
  m_play.play();
  double opened_at = -1;
  for (double t = 0; t < 4 * m_border + 8 && player() != PlayerState::kDone; t += 0.02) {
    run(0.02);
    const double finger = m_runtime->gripperPosition();
    if (finger > 0.021 && finger < 0.049 && opened_at < 0) opened_at = cursor();
    if (!m_play.state().gripper.isEmpty()) {
      EXPECT_TRUE(m_play.state().playing) << "Pause is there for it";
      EXPECT_FALSE(m_runtime->status().moving) << "the arm rests meanwhile";
      EXPECT_FALSE(m_play.state().can_back_up);
    }
  }
  EXPECT_EQ(player(), PlayerState::kDone) << m_failed.join(QLatin1Char('\n')).toStdString();
  EXPECT_NEAR(opened_at, m_border, 1e-6);
  EXPECT_TRUE(m_runtime->holding()) << "it has gripped again";
  EXPECT_TRUE(m_failed.isEmpty());
}

TEST_F(GripperBetweenStages, IsNotBackedUpOver) {
  m_play.play();
  for (int i = 0; i < 6000 && cursor() < 1.5 * m_border; ++i) run(0.02);
  m_play.backUp();
  run(1.5 * m_border);
  EXPECT_NEAR(cursor(), m_border, 1e-6) << "back to where it let go, and no further";
  EXPECT_FALSE(m_play.state().playing);
  EXPECT_FALSE(m_play.state().can_back_up);
  EXPECT_TRUE(m_play.state().why_not_back_up.contains(QStringLiteral("1 of 2"))) << m_play.state().why_not_back_up.toStdString();
  EXPECT_FALSE(m_play.state().why_not_stage_back.isEmpty());
  EXPECT_TRUE(open());
  m_play.backUp();
  run(1);
  EXPECT_NEAR(cursor(), m_border, 1e-6);
  m_play.play();
  for (int i = 0; i < 6000 && player() != PlayerState::kDone; ++i) run(0.02);
  EXPECT_EQ(player(), PlayerState::kDone) << "forwards it goes on";
}

TEST_F(GripperBetweenStages, PauseLetsItFinishAndThenWaitsForPlay) {
  m_play.play();
  for (int i = 0; i < 6000 && m_play.state().gripper.isEmpty(); ++i) run(0.02);
  m_play.pause();
  run(3);
  EXPECT_TRUE(open());
  EXPECT_NEAR(cursor(), m_border, 1e-6) << "nothing goes on by itself after a pause";
  EXPECT_FALSE(m_play.state().playing);
  EXPECT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
  m_play.play();
  run(1);
  EXPECT_GT(cursor(), m_border + 0.1);
}

TEST_F(GripperBetweenStages, StopEndsItAndPlayAfterResetBeginsWithItAgain) {
  m_play.play();
  for (int i = 0; i < 6000 && m_play.state().gripper.isEmpty(); ++i) run(0.02);
  run(0.1);
  m_runtime->stop("operator", "test");
  run(2);
  EXPECT_FALSE(open()) << "STOP halts the fingers too";
  EXPECT_NEAR(cursor(), m_border, 1e-6);
  ASSERT_EQ(m_failed.size(), 1);
  ASSERT_TRUE(m_runtime->resetStop().ok());
  run(2);
  EXPECT_FALSE(open()) << "nothing resumes by itself";
  m_play.play();
  run(2);
  EXPECT_TRUE(open());
  EXPECT_GT(cursor(), m_border) << "and the motion goes on";
}

TEST_F(GripperBetweenStages, AHandThatClosesOnNothingHoldsTheMotionAndPlayTriesAgain) {
  m_play.play();
  for (int i = 0; i < 6000 && cursor() < 1.5 * m_border; ++i) run(0.02);
  m_gripper->setObject(std::nullopt);    // it has gone
  run(m_border + 6);
  EXPECT_NEAR(cursor(), 2 * m_border, 1e-6) << "the arm holds";
  ASSERT_EQ(m_failed.size(), 1);
  EXPECT_TRUE(m_failed.front().contains(QStringLiteral("closed on nothing"))) << m_failed.front().toStdString();
  EXPECT_FALSE(m_play.state().playing);
  m_gripper->setObject(0.02);            // somebody has put it back
  m_play.play();
  for (int i = 0; i < 6000 && player() != PlayerState::kDone; ++i) run(0.02);
  EXPECT_EQ(player(), PlayerState::kDone);
}

TEST_F(GripperBetweenStages, StagesAreSteppedOverItOneByOne) {
  m_play.playStage();
  run(m_border + 2);
  EXPECT_NEAR(cursor(), m_border, 1e-6);
  EXPECT_FALSE(open()) << "the stage ends before the gripper acts";
  m_play.playStage();
  run(m_border + 4);
  EXPECT_TRUE(open());
  EXPECT_NEAR(cursor(), 2 * m_border, 1e-6);
  EXPECT_FALSE(m_runtime->holding());
}

TEST_F(GripperBetweenStages, WithHoldToRunNothingGoesOnAfterTheButtonIsLetGoOf) {
  m_play.setOnlyHeld(true);
  m_play.play();
  for (int i = 0; i < 6000 && m_play.state().gripper.isEmpty(); ++i) {
    m_play.keepRunning();
    run(0.02);
  }
  EXPECT_NEAR(cursor(), m_border, 1e-6);
  run(3);                                // the window no longer says that it is held
  EXPECT_NEAR(cursor(), m_border, 1e-6);
}

TEST_F(PlayControllerTest, HoldToRunMovesOnlyWhileItIsHeld) {
  showPlan(motion());
  PlayHand hand(m_play);
  QStringList said;
  QObject::connect(&hand, &PlayHand::said, &hand, [&said](const QString& sentence) { said << sentence; });
  hand.setHoldToRun(true);
  EXPECT_TRUE(m_play.state().only_held);
  hand.click(PlayHand::Order::kPlay);
  run(0.2);
  EXPECT_EQ(player(), PlayerState::kEmpty) << "a click is not enough";
  EXPECT_EQ(said.size(), 1);
  hand.press(PlayHand::Order::kPlay);
  for (int i = 0; i < 10; ++i) {
    run(0.1);
    m_play.keepRunning();  // as its timer does; the robot's time here is not the clock's
  }
  EXPECT_EQ(player(), PlayerState::kPlaying);
  hand.release();
  run(0.3);
  EXPECT_EQ(player(), PlayerState::kPaused);
  const Eigen::VectorXd stands = measured();
  run(1);
  EXPECT_EQ((measured() - stands).norm(), 0);
}

TEST_F(PlayControllerTest, AHandThatIsGonePausesByItself) {
  showPlan(motion());
  m_play.setOnlyHeld(true);
  m_play.play();
  run(0.2);
  EXPECT_EQ(player(), PlayerState::kPlaying);
  run(0.1);
  EXPECT_EQ(player(), PlayerState::kPausing);
  run(0.3);
  EXPECT_EQ(player(), PlayerState::kPaused);
  EXPECT_NE(m_runtime->status().notice.find("not held"), std::string::npos) << m_runtime->status().notice;
}

TEST_F(PlayControllerTest, OnALiveRobotPlayIsHeldForAWhile) {
  showPlan(motion());
  PlayHand hand(m_play);
  hand.setLive(true);
  EXPECT_FALSE(hand.whyHold().isEmpty());
  hand.press(PlayHand::Order::kPlay);
  hand.release();
  run(0.2);
  EXPECT_EQ(player(), PlayerState::kEmpty);
  int argc = 1;
  char name[] = "test";
  char* argv[] = {name, nullptr};
  const auto application =
      QCoreApplication::instance() != nullptr ? nullptr : std::make_unique<QCoreApplication>(argc, argv);
  hand.press(PlayHand::Order::kPlay);
  QElapsedTimer since;
  since.start();
  while (player() == PlayerState::kEmpty && since.elapsed() < 20000)
    QCoreApplication::processEvents(QEventLoop::AllEvents, 20);
  EXPECT_GE(since.elapsed(), PlayHand::kConfirm_ms - 20);
  hand.release();
  run(0.5);
  EXPECT_EQ(player(), PlayerState::kPlaying) << "it goes on by itself";
}

TEST_F(PlayControllerTest, AHaltTellsWhatHappenedAndTheArmCanGoOnOrBack) {
  showPlan(motion());
  m_play.play();
  run(1);
  m_arm->injectFault("joint 2 is too hot");
  run(1);
  EXPECT_TRUE(m_play.state().halted);
  EXPECT_FALSE(m_play.state().halt_reason.isEmpty());
  ASSERT_TRUE(m_runtime->resetStop().ok());
  refresh();
  EXPECT_TRUE(m_play.state().can_play) << m_play.state().why_not_play.toStdString();
  EXPECT_TRUE(m_play.state().can_back_up) << m_play.state().why_not_back_up.toStdString();
  m_play.backUp();
  run(3);
  EXPECT_FALSE(m_play.state().halted);
  EXPECT_EQ(player(), PlayerState::kReady);
}

// Whatever else is pressed: a paused arm stands until somebody plays, backs up or jogs.
TEST_F(PlayControllerTest, TenThousandOtherCommandsMoveNothingWhilePaused) {
  std::mt19937 random(5);
  const auto any = [&random](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  const auto one_in = [&random](unsigned n) { return random() % n == 0; };
  PlayHand hand(m_play);
  for (int motions = 0; motions < 20; ++motions) {
    m_home = measured();
    m_play.setOnlyHeld(false);
    m_play.setSpeed(any(0.5, 2));
    showPlan(motion(random() % 50 + 1));
    m_play.play();
    run(any(0.8, 2));
    m_play.pause();
    run(0.5);
    ASSERT_EQ(player(), PlayerState::kPaused) << m_play.state().why_not_play.toStdString();
    const Eigen::VectorXd stands = measured();
    for (int i = 0; i < 500; ++i) {
      switch (random() % 12) {
        case 0:
          m_play.setSpeed(any(-3, 3));
          break;
        case 1:
          m_play.scrub(any(-1, 20));
          break;
        case 2:
          m_play.pause();
          break;
        case 3:
          m_play.setOnlyHeld(one_in(2));
          break;
        case 4:
          m_play.keepRunning();
          break;
        case 5:
          m_play.acceptAccuracy();
          break;
        case 6:
          hand.release();
          break;
        case 7:
          (void)m_runtime->scrub(any(0, 5)).ok();
          break;
        case 8:
          m_runtime->releaseJog();
          break;
        case 9:
          (void)m_runtime->resetStop().ok();
          break;
        case 10:
          m_runtime->setObstacles({});
          break;
        case 11:
          if (one_in(20)) m_runtime->stop("operator", "test");
          if (one_in(60)) (void)m_runtime->load(motion(random() % 5 + 1)).ok();
          if (one_in(60)) showPlan(motion(random() % 5 + 1));
          break;
      }
      step(0.02);
      refresh();
      ASSERT_EQ((measured() - stands).norm(), 0) << "motion " << motions << ", command " << i;
      ASSERT_FALSE(m_play.state().playing);
    }
    (void)m_runtime->resetStop().ok();
    step(0.5);
    ASSERT_TRUE(m_runtime->resetStop().ok());
    refresh();
  }
}

TEST_F(PlayControllerTest, CannotPlayWithoutARobot) {
  showPlan(motion());
  m_play.setRuntime(nullptr);
  EXPECT_FALSE(m_play.state().can_play);
  EXPECT_TRUE(m_play.state().can_scrub) << "looking needs no robot";
}

}  // namespace
}  // namespace longarm::session
