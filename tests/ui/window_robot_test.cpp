// The whole window with the real virtual robot as a child process: the task, and what becomes of faults.
#include <csignal>

#include <QDockWidget>
#include <QLineEdit>
#include <QTest>
#include <QToolButton>

#include "tests/ui/window_fixture.h"
#include "ui/demonstration.h"

namespace longarm {
namespace {

using session::LinkState;
using ui::SimulatedHand;
using vision::PaneSide;

class WindowWithRobot : public tests::WindowFixture {
 protected:
  void openWithRobot(const QSize& size = {1280, 800}) {
    openWindow(QStringLiteral("dark"), size);
    bench->openRobot({});
    ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 30)) << bench->robot().status().link_text;
  }
  // The whole task as an operator does it.
  void grabsThePipe(const QString& variant) {
    openWindow(QStringLiteral("dark"), {1920, 1080});
    ui::RobotChoice choice;
    choice.variant = variant;
    bench->openRobot(choice);
    ui::DemonstrationOptions options;
    const QString pictures = qEnvironmentVariable("LONGARM_UI_PICTURES");
    options.folder = pictures.isEmpty() ? folder.filePath(QStringLiteral("pictures")) : pictures + QStringLiteral("/demo") + variant;
    ui::Demonstration demonstration(*window, options);
    const Status done = demonstration.run();
    EXPECT_TRUE(done.ok()) << done.error().message;
    EXPECT_GE(demonstration.picturesTaken(), 3);
    EXPECT_TRUE(bench->robot().runtime() != nullptr && bench->robot().runtime()->holding());
  }
  bool pairTaken() const {
    return bench->document().paneSnapshot(PaneSide::kLeft) && bench->document().paneSnapshot(PaneSide::kRight);
  }
};

TEST_F(WindowWithRobot, GrabsThePipeByMouseAlone) { grabsThePipe(QString()); }

TEST_F(WindowWithRobot, GrabsThePipeWithTwoHeadsThatAreAimedOneByOne) { grabsThePipe(QStringLiteral("ptz")); }

TEST_F(WindowWithRobot, OutlivesItsRobotAndTakesItBack) {
  openWithRobot();
  bench->takePair();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return pairTaken(); }, 40)) << window->strip()->message().toStdString();
  const auto state = bench->document().state();
  ASSERT_GT(bench->robot().runtime()->virtualRobotPid(), 0);
  ::kill(bench->robot().runtime()->virtualRobotPid(), SIGKILL);
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().status().link == LinkState::kLost; }, 10));
  look(QStringLiteral("robot-lost"));
  EXPECT_TRUE(window->isVisible());
  EXPECT_EQ(QApplication::activeModalWidget(), nullptr);
  EXPECT_TRUE(window->notices()->has(QStringLiteral("link")));
  EXPECT_EQ(bench->document().state(), state);
  EXPECT_FALSE(window->actions().whyNot(ui::ActionId::kTakePair).isEmpty());
  window->actions().at(ui::ActionId::kRestart)->trigger();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 30)) << bench->robot().status().link_text;
  EXPECT_EQ(bench->document().state(), state);
  EXPECT_TRUE(bench->robot().status().gate.stopped) << "nothing moves after a restart before the operator resets";
}

TEST_F(WindowWithRobot, SpaceStopsAMovingArmFromATextField) {
  openWithRobot();
  ASSERT_TRUE(hand.hold(window->stopPanel()->resetButton(), [this] { return !bench->robot().status().gate.stopped; }, 10));
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return window->actions().whyNot(ui::ActionId::kStow).isEmpty(); }, 10));
  bench->plan(QStringLiteral("stow"));
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->play().state().can_play; }, 30))
      << bench->play().state().why_not_play.toStdString();
  bench->play().play();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().status().moving; }, 5)) << window->strip()->message().toStdString();
  QLineEdit field(window.get());
  field.show();
  field.setFocus();
  QTest::keyClick(&field, Qt::Key_Space);
  EXPECT_TRUE(field.text().isEmpty());
  EXPECT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().status().gate.stopped; }, 2));
  EXPECT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().status().stop_confirmed; }, 3));
  EXPECT_FALSE(bench->play().state().can_play);
}

TEST_F(WindowWithRobot, JogsTheArmWhileAButtonIsHeld) {
  openWithRobot({1920, 1080});
  ASSERT_TRUE(hand.hold(window->stopPanel()->resetButton(), [this] { return !bench->robot().status().gate.stopped; }, 10));
  auto* panel = window->jog();
  window->findChild<QDockWidget*>(QStringLiteral("jog"))->raise();
  SimulatedHand::pump(100);
  panel->setFrame(planning::JogFrame::kBase);
  const auto height = [this] {
    const auto& cell = bench->robot().runtime()->workcell();
    return cell.model->forward(*bench->robot().runtime()->configuration(), *cell.model->linkIndex(cell.arm.tip_link)).translation().z();
  };
  auto* up = panel->button(2, 1);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return up->isEnabled(); }, 10)) << panel->message().toStdString();
  const double before = height();
  ASSERT_TRUE(hand.hold(up, [&] { return height() > before + 0.02; }, 20)) << panel->message().toStdString();
  look(QStringLiteral("jog"));
  EXPECT_TRUE(SimulatedHand::waitFor([this] { return !bench->robot().status().jogging; }, 5));
  const double after = height();
  SimulatedHand::pump(500);
  EXPECT_NEAR(height(), after, 0.003);
  EXPECT_EQ(bench->robot().status().gate.refused, 0u) << bench->robot().status().gate.reason;
}

TEST_F(WindowWithRobot, DrivesTheBaseWhileAButtonIsHeldAndMarksWhatWasMeasuredBefore) {
  openWithRobot({1920, 1080});
  ASSERT_TRUE(hand.hold(
      window->stopPanel()->resetButton(), [this] { return !bench->robot().status().gate.stopped; }, 10));
  window->findChild<QDockWidget*>(QStringLiteral("drive"))->raise();
  SimulatedHand::pump(100);
  auto* ahead = window->drive()->button(ui::DrivePanel::Way::kForward);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return ahead->isEnabled(); }, 10))
      << window->drive()->message().toStdString();
  const auto gone = [this] { return bench->robot().status().base ? bench->robot().status().base->x : 0; };
  ASSERT_TRUE(hand.hold(
      ahead, [&] { return gone() > 0.05; }, 20))
      << window->drive()->message().toStdString();
  look(QStringLiteral("drive"));
  EXPECT_TRUE(SimulatedHand::waitFor([this] { return !bench->robot().status().driving; }, 5));
  const double there = gone();
  SimulatedHand::pump(500);
  EXPECT_NEAR(gone(), there, 0.002);
  EXPECT_EQ(bench->robot().status().gate.refused, 0u) << bench->robot().status().gate.reason;
  ASSERT_TRUE(bench->document().base().has_value());
  EXPECT_NEAR(bench->document().base()->x, there, 0.002);
  bench->plan(QStringLiteral("stow"));
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->play().state().can_play; }, 60))
      << bench->play().state().why_not_play.toStdString();
  ASSERT_TRUE(hand.hold(
      window->drive()->button(ui::DrivePanel::Way::kTurnLeft),
      [this] { return bench->robot().status().base->yaw > 0.05; }, 20));
  EXPECT_TRUE(SimulatedHand::waitFor([this] { return bench->play().state().stale; }, 10))
      << "planned from another place";
  EXPECT_TRUE(window->notices()->has(QStringLiteral("plan")));
}

}  // namespace
}  // namespace longarm
