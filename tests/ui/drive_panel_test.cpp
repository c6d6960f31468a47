// Driving and recording by panel: dead man's switches, reasons, and what becomes of a recording.
#include <gtest/gtest.h>
#include <QComboBox>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTableWidget>
#include <QTest>
#include <QToolButton>

#include "tests/ui/panel_rig.h"
#include "ui/drive_panel.h"
#include "ui/recorded_panel.h"

namespace longarm::ui {
namespace {

using Way = session::DriveController::Way;

struct DriveRig : tests::PanelRig {
  std::vector<BaseTwist> sent;
  Status answer;
  int released = 0;
  DriveRig() {
    bench.drive().setRobot(
        [this](const BaseTwist& twist) {
          sent.push_back(twist);
          return answer;
        },
        [this] { ++released; }, BaseLimits());
    bench.drive().setSpeed(0.5);
  }
};

TEST(DriveController, RepeatsWhatIsHeldAndAddsItUp) {
  DriveRig rig;
  auto& drive = rig.bench.drive();
  drive.hold(Way::kForward);
  ASSERT_TRUE(QTest::qWaitFor([&] { return rig.sent.size() >= 3; }, 5000));
  EXPECT_DOUBLE_EQ(rig.sent.back().forward, 0.15);
  drive.hold(Way::kTurnLeft);
  EXPECT_DOUBLE_EQ(rig.sent.back().turn, 0.25);
  EXPECT_DOUBLE_EQ(rig.sent.back().forward, 0.15);
  drive.release(Way::kForward);
  EXPECT_EQ(rig.released, 0) << "one direction is still held";
  EXPECT_EQ(drive.wanted().forward, 0);
  drive.release(Way::kTurnLeft);
  EXPECT_EQ(rig.released, 1);
  const auto before = rig.sent.size();
  QTest::qWait(200);
  EXPECT_EQ(rig.sent.size(), before);
}

TEST(DriveController, LetsGoWhenTheRobotRefuses) {
  DriveRig rig;
  rig.answer = Status(ErrorCode::kRefused, "drive: the arm still moves");
  QSignalSpy said(&rig.bench, &Workbench::said);
  rig.bench.drive().hold(Way::kBack);
  EXPECT_FALSE(rig.bench.drive().held());
  ASSERT_EQ(said.size(), 1);
  EXPECT_TRUE(said[0][0].toString().contains(QStringLiteral("arm still moves")));
}

TEST(DrivePanel, SaysWhyItCannotDriveAndWhoseCamerasItHas) {
  tests::PanelRig rig;
  DrivePanel panel(rig.bench);
  for (const auto way :
       {Way::kForward, Way::kBack, Way::kLeft, Way::kRight, Way::kTurnLeft, Way::kTurnRight}) {
    EXPECT_FALSE(panel.button(way)->isEnabled());
    EXPECT_FALSE(panel.button(way)->toolTip().isEmpty());
  }
  panel.show();
  panel.setFocus();
  QTest::keyPress(&panel, Qt::Key_Up);
  EXPECT_FALSE(rig.bench.drive().held()) << "keys do no more than the buttons";
}

TEST(DrivePanel, AHiddenPanelHoldsNothing) {
  DriveRig rig;
  DrivePanel panel(rig.bench);
  panel.show();
  rig.bench.drive().hold(Way::kForward);
  panel.hide();
  EXPECT_FALSE(rig.bench.drive().held());
  EXPECT_EQ(rig.released, 1);
}

TEST(RecordedPanel, ListsRenamesAndDeletesWhatWasRecorded) {
  tests::PanelRig rig;
  auto workcell = planning::loadBuiltInWorkcell();
  ASSERT_TRUE(workcell.ok()) << workcell.error().message;
  rig.bench.setWorkcell(std::make_shared<const planning::Workcell>(std::move(*workcell)));
  RecordedPanel panel(rig.bench);
  panel.show();
  EXPECT_FALSE(panel.recordButton()->isEnabled()) << "no robot";
  EXPECT_FALSE(panel.recordButton()->toolTip().isEmpty());
  auto& recorder = rig.bench.recorder();
  ASSERT_TRUE(recorder.start().ok());
  EXPECT_EQ(panel.recordButton()->text(), QStringLiteral("End recording"));
  JointState state;
  state.names = rig.bench.document().workcell()->armJointNames();
  state.positions = Eigen::VectorXd::Zero(6);
  for (const double turn : {0.0, 0.2, 0.4}) {
    state.positions[0] = turn;
    state.positions[1] = turn * turn;
    recorder.take(state);
  }
  ASSERT_TRUE(panel.recordButton()->isEnabled()) << "a recording can always be ended";
  panel.recordButton()->click();
  ASSERT_EQ(panel.list()->count(), 1);
  EXPECT_EQ(panel.points()->rowCount(), 3);
  bool listed = false;
  for (const auto& row : rig.bench.plans().macros())
    listed = listed || row.title == QStringLiteral("Motion 1");
  EXPECT_TRUE(listed) << "with the canned motions";
  panel.list()->lineEdit()->setText(QStringLiteral("Round the corner"));
  QTest::keyClick(panel.list()->lineEdit(), Qt::Key_Return);
  EXPECT_NE(recorder.motion(QStringLiteral("Round the corner")), nullptr);
  panel.points()->item(1, 0)->setText(QStringLiteral("corner"));
  EXPECT_EQ(recorder.motions().front().waypoints[1].name, "corner");
  panel.points()->selectRow(1);
  ASSERT_TRUE(panel.deleteButton()->isEnabled()) << panel.deleteButton()->toolTip().toStdString();
  panel.deleteButton()->click();
  EXPECT_EQ(panel.points()->rowCount(), 2);
}

}  // namespace
}  // namespace longarm::ui
