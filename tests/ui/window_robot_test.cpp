// The whole window with the real virtual robot as a child process: the task, and what becomes of faults.
#include <csignal>

#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QTest>
#include <QToolButton>

#include "session/commands/sketch_commands.h"
#include "tests/ui/window_fixture.h"
#include "ui/demonstration.h"
#include "ui/template_panel.h"
#include "ui/zoom_bar.h"

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
  double focalLength(PaneSide side) const {
    const auto view = window->pictures()->pane(side)->view();
    return view ? view->camera.fx : 0;
  }
  bool pairTaken() const {
    return bench->document().paneSnapshot(PaneSide::kLeft) && bench->document().paneSnapshot(PaneSide::kRight);
  }
};

TEST_F(WindowWithRobot, GrabsThePipeByMouseAlone) { grabsThePipe(QString()); }

TEST_F(WindowWithRobot, GrabsThePipeWithTwoHeadsThatAreAimedOneByOne) { grabsThePipe(QStringLiteral("ptz")); }

// By the buttons, the keys and a frame drawn with the mouse; what was taken before keeps its lens.
TEST_F(WindowWithRobot, ZoomsAndFramesInTheLivePane) {
  openWindow();
  ui::RobotChoice choice;
  choice.variant = QStringLiteral("ptz");
  bench->openRobot(choice);
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 30)) << bench->robot().status().link_text;
  auto* pane = window->pictures()->pane(PaneSide::kLeft);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return focalLength(PaneSide::kLeft) > 0; }, 60));
  EXPECT_EQ(focalLength(PaneSide::kLeft), 743.1);
  ASSERT_TRUE(pane->zoomBar()->isVisible());
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return pane->zoomBar()->closer()->isEnabled(); }, 10));
  bench->takePair();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return pairTaken(); }, 60)) << window->strip()->message().toStdString();
  EXPECT_FALSE(pane->zoomBar()->isVisible()) << "a snapshot cannot be zoomed into by a lens";
  pane->showLive(QStringLiteral("ptz_left"));
  ASSERT_TRUE(hand.hold(pane->zoomBar()->closer(), [&] { return focalLength(PaneSide::kLeft) > 900; }, 60));
  EXPECT_EQ(bench->document().paneSnapshot(PaneSide::kLeft)->view.camera.fx, 743.1);
  look(QStringLiteral("zoom-bar"));
  pane->canvas()->setFocus();
  const double before = *bench->zoomDrive().zoom(QStringLiteral("ptz_left"));
  QTest::keyPress(pane->canvas(), Qt::Key_PageDown);
  EXPECT_TRUE(SimulatedHand::waitFor([&] { return *bench->zoomDrive().zoom(QStringLiteral("ptz_left")) < before - 0.01; }, 10));
  QTest::keyRelease(pane->canvas(), Qt::Key_PageDown);
  SimulatedHand::pump(600);
  const double there = *bench->zoomDrive().zoom(QStringLiteral("ptz_left"));
  SimulatedHand::pump(300);
  EXPECT_NEAR(*bench->zoomDrive().zoom(QStringLiteral("ptz_left")), there, 0.002) << "let go, it stands";
  const double fx = focalLength(PaneSide::kLeft);
  hand.drag(pane->canvas(), *pane->canvas()->widgetOfPixel({250, 180}), *pane->canvas()->widgetOfPixel({330, 240}));
  EXPECT_TRUE(SimulatedHand::waitFor([&] { return focalLength(PaneSide::kLeft) > 3 * fx; }, 60)) << window->strip()->message().toStdString();
  look(QStringLiteral("zoom-framed"));
}

// Marked in the pictures, dropped, and worked by its own button up to the first motion that waits for Play.
TEST_F(WindowWithRobot, DropsADoorAndBeginsToOpenIt) {
  openWindow(QStringLiteral("dark"), {1920, 1080});
  ui::RobotChoice choice;
  choice.scenario = QStringLiteral("open_door");
  bench->openRobot(choice);
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->robot().linkUp(); }, 30)) << bench->robot().status().link_text;
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return focalLength(PaneSide::kLeft) > 0; }, 60));
  bench->takePair();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return pairTaken(); }, 60)) << window->strip()->message().toStdString();
  session::SketchItem face;
  face.id = bench->document().nextFeatureId();
  face.kind = vision::FeatureKind::kPlane;
  face.name = "door's face";
  const Eigen::Vector3d corners[] = {{0.93, 0.225, 0.88}, {0.93, 0.225, 0.22}, {0.93, -0.225, 0.22}};
  for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
    const auto snapshot = bench->document().paneSnapshot(side);
    for (int i = 0; i < 3; ++i) face.setPick(snapshot->id, i, {snapshot->view.project(corners[i]).value(), session::PickState::kFree});
  }
  bench->history().push(session::addItem(face));
  bench->targeting().select(face.id);
  auto* panel = window->templates();
  window->findChild<QDockWidget*>(QStringLiteral("templates"))->raise();
  panel->kinds()->setCurrentIndex(panel->kinds()->findData(QStringLiteral("door")));
  Q_EMIT panel->kinds()->activated(panel->kinds()->currentIndex());
  ASSERT_TRUE(panel->dropButton()->isEnabled()) << panel->dropButton()->toolTip().toStdString();
  hand.click(panel->dropButton());
  ASSERT_EQ(bench->world().items().size(), 1u);
  auto* open = panel->actionButton(QStringLiteral("open"));
  ASSERT_NE(open, nullptr);
  look(QStringLiteral("template"));
  ASSERT_TRUE(hand.hold(window->stopPanel()->resetButton(), [this] { return !bench->robot().status().gate.stopped; }, 10));
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return open->isEnabled(); }, 10)) << open->toolTip().toStdString();
  hand.click(open);
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->play().state().can_play; }, 60)) << window->strip()->message().toStdString();
  EXPECT_TRUE(bench->templates().running());
  EXPECT_NE(panel->message()->text().indexOf(QStringLiteral("Play")), -1) << panel->message()->text().toStdString();
  EXPECT_FALSE(bench->robot().status().moving) << "what was not shown is not played";
  look(QStringLiteral("template-plan"));
  bench->history().undo();
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return !bench->templates().running(); }, 10));
  EXPECT_TRUE(bench->world().items().empty());
}

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
  auto furnished = std::make_shared<planning::Workcell>(*bench->document().workcell());
  planning::WorldObject shelf;
  shelf.name = "shelf";
  shelf.X_WO.translation() = Eigen::Vector3d(3, 0.5, 0.5);
  furnished->objects.push_back(shelf);
  bench->setWorkcell(furnished);
  const auto shelfAt = [this] { return bench->document().workcell()->objects.front().X_WO.translation().x(); };
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
  EXPECT_TRUE(SimulatedHand::waitFor([&] { return std::abs(shelfAt() - (3 - there)) < 0.003; }, 5)) << "it stands in the room";
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
