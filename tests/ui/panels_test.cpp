// Panels on a bench without a robot: what they show, what they allow, and why not.
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTableView>
#include <QTemporaryDir>
#include <QTest>
#include <QToolButton>
#include <gtest/gtest.h>

#include "tests/ui/panel_rig.h"
#include "ui/feature_panel.h"
#include "ui/file_actions.h"
#include "ui/head_panel.h"
#include "ui/jog_panel.h"
#include "ui/macro_panel.h"
#include "ui/motion_panel.h"
#include "ui/notice_bar.h"
#include "ui/picture_files_dialog.h"
#include "ui/simulated_hand.h"
#include "ui/sketch_actions.h"
#include "ui/snapshot_pane.h"
#include "ui/status_strip.h"
#include "ui/stop_panel.h"

namespace longarm::ui {
namespace {

using tests::PanelRig;
using vision::PaneSide;

TEST(FeaturePanel, ListsWhatIsMeasuredAndSelectsBothWays) {
  PanelRig rig;
  FeaturePanel panel(rig.bench.targeting(), rig.actions, rig.appearance);
  panel.resize(600, 200);
  panel.show();
  const FeatureId first = rig.addLine("Line 1"), second = rig.addLine("Line 2");
  auto* model = panel.view()->model();
  ASSERT_EQ(model->rowCount(), 2);
  const double length = (rig.scene.a - rig.scene.b).norm() * 1000;
  const QString shown = model->index(0, FeatureTable::kLength).data().toString();
  EXPECT_NEAR(shown.section(QLatin1Char(' '), 0, 0).toDouble(), length, 0.1) << shown.toStdString();
  rig.bench.targeting().select(first);
  EXPECT_TRUE(panel.view()->selectionModel()->isRowSelected(0, {}));
  EXPECT_FALSE(panel.view()->selectionModel()->isRowSelected(1, {}));
  panel.view()->selectRow(1);
  EXPECT_EQ(rig.bench.document().selection().primary, second);
}

TEST(FeaturePanel, RenamesHidesAndLocksEachAsOneUndoStep) {
  PanelRig rig;
  FeaturePanel panel(rig.bench.targeting(), rig.actions, rig.appearance);
  panel.resize(600, 200);
  panel.show();
  const FeatureId id = rig.addLine("Line 1");
  auto* model = panel.view()->model();
  const auto steps = rig.bench.history().position();
  EXPECT_TRUE(model->setData(model->index(0, FeatureTable::kName), QStringLiteral("pipe")));
  EXPECT_FALSE(model->setData(model->index(0, FeatureTable::kName), QStringLiteral("   "))) << "a name cannot be empty";
  EXPECT_EQ(rig.bench.document().item(id)->name, "pipe");
  for (const int column : {FeatureTable::kShown, FeatureTable::kLocked}) {
    const QRect cell = panel.view()->visualRect(model->index(0, column));
    QTest::mouseClick(panel.view()->viewport(), Qt::LeftButton, {}, cell.center());
  }
  EXPECT_TRUE(rig.bench.document().item(id)->hidden);
  EXPECT_TRUE(rig.bench.document().item(id)->locked);
  EXPECT_EQ(rig.bench.history().position(), steps + 3);
  for (int i = 0; i < 3; ++i) rig.bench.targeting().undo();
  EXPECT_EQ(rig.bench.document().item(id)->name, "Line 1");
  EXPECT_FALSE(rig.bench.document().item(id)->hidden);
}

TEST(SketchActions, FollowSelectionHistoryAndTool) {
  PanelRig rig;
  SketchActions sketch(rig.bench.targeting(), rig.actions);
  EXPECT_FALSE(rig.actions.at(ActionId::kUndo)->isEnabled());
  EXPECT_FALSE(rig.actions.whyNot(ActionId::kToolLine).isEmpty()) << "no picture to draw on";
  rig.addLine("Line 1");
  EXPECT_TRUE(rig.actions.at(ActionId::kToolLine)->isEnabled());
  EXPECT_TRUE(rig.actions.at(ActionId::kUndo)->text().contains(QStringLiteral("Line 1"))) << rig.actions.at(ActionId::kUndo)->text().toStdString();
  rig.actions.at(ActionId::kToolLine)->trigger();
  EXPECT_EQ(rig.bench.targeting().tool(), session::ToolKind::kLine);
  EXPECT_TRUE(rig.actions.at(ActionId::kToolLine)->isChecked());
  rig.actions.at(ActionId::kCancel)->trigger();
  EXPECT_EQ(rig.bench.targeting().tool(), session::ToolKind::kSelect);
  rig.actions.at(ActionId::kSelectAll)->trigger();
  rig.actions.at(ActionId::kDelete)->trigger();
  EXPECT_TRUE(rig.bench.document().items().empty());
  rig.actions.at(ActionId::kUndo)->trigger();
  EXPECT_EQ(rig.bench.document().items().size(), 1U);
}

TEST(SketchActions, UndoAHundredStepsAndRedoThemBitForBit) {
  PanelRig rig;
  SketchActions sketch(rig.bench.targeting(), rig.actions);
  const FeatureId id = rig.addLine("Line 1");
  const auto before = rig.bench.document().state();
  for (int i = 0; i < 120; ++i) rig.bench.targeting().rename(id, QStringLiteral("name %1").arg(i));
  const auto after = rig.bench.document().state();
  for (int i = 0; i < 120; ++i) rig.actions.at(ActionId::kUndo)->trigger();
  EXPECT_EQ(rig.bench.document().state(), before);
  for (int i = 0; i < 120; ++i) rig.actions.at(ActionId::kRedo)->trigger();
  EXPECT_EQ(rig.bench.document().state(), after);
}

TEST(PanelsWithoutARobot, DisableWhatCannotBeDoneAndSayWhy) {
  PanelRig rig;
  HeadPanel head(rig.bench, rig.actions, rig.appearance);
  MotionPanel motion(rig.bench, rig.actions, rig.appearance);
  StopPanel stop(rig.bench, rig.actions, rig.appearance);
  MacroPanel macros(rig.bench, rig.actions, rig.appearance);
  for (const auto id : {ActionId::kTakePair, ActionId::kGripperOpen, ActionId::kGripperClose, ActionId::kPlayPause, ActionId::kBackUp,
                        ActionId::kReset, ActionId::kGrabPipe, ActionId::kHome, ActionId::kReplan, ActionId::kCancelPlanning}) {
    EXPECT_FALSE(rig.actions.at(id)->isEnabled()) << rig.actions.at(id)->text().toStdString();
    EXPECT_FALSE(rig.actions.whyNot(id).isEmpty());
  }
  EXPECT_FALSE(head.stick()->isEnabled());
  EXPECT_FALSE(stop.resetButton()->isEnabled());
  EXPECT_TRUE(stop.stopButton()->isEnabled()) << "STOP is never disabled";
}

TEST(MacroPanel, OffersCannedMotionsOfTheWorkcellAndSaysWhatIsMissing) {
  PanelRig rig;
  MacroPanel panel(rig.bench, rig.actions, rig.appearance);
  auto workcell = planning::loadBuiltInWorkcell();
  ASSERT_TRUE(workcell.ok()) << workcell.error().message;
  rig.bench.setWorkcell(std::make_shared<const planning::Workcell>(std::move(*workcell)));
  for (const char* name : {"home", "stow", "ready", "look_ahead", "grab_pipe"}) {
    ASSERT_NE(panel.button(QString::fromLatin1(name)), nullptr) << name;
    EXPECT_FALSE(panel.button(QString::fromLatin1(name))->isEnabled());
    EXPECT_TRUE(panel.button(QString::fromLatin1(name))->toolTip().contains(QStringLiteral("Not now")));
  }
}

TEST(SnapshotPane, ShowsWhatIsTakenAndKeepsTheSketchOffLivePictures) {
  PanelRig rig;
  SnapshotPane pane(PaneSide::kLeft, rig.bench, rig.appearance);
  pane.resize(500, 420);
  pane.show();
  EXPECT_TRUE(pane.live());
  EXPECT_FALSE(pane.canvas()->hasPicture());
  rig.addLine("Line 1");
  EXPECT_FALSE(pane.live()) << "a picture that was taken is shown";
  EXPECT_TRUE(pane.canvas()->hasPicture());
  ASSERT_TRUE(pane.view().has_value());
  SimulatedHand hand;
  const auto at = pane.canvas()->widgetOfPixel(rig.scene.pixel(PaneSide::kLeft, rig.scene.a));
  hand.click(pane.canvas(), *at);
  EXPECT_TRUE(rig.bench.document().selection().primary.valid()) << "a click on a handle selects";
  hand.click(pane.liveButton());
  EXPECT_TRUE(pane.live());
  rig.bench.targeting().select(FeatureId{});
  hand.click(pane.canvas(), *at);
  EXPECT_FALSE(rig.bench.document().selection().primary.valid()) << "live pictures are for aiming";
}

TEST(SnapshotPane, TellsBothPanesApartWhenOneSnapshotIsChosenElsewhere) {
  PanelRig rig;
  SnapshotPane left(PaneSide::kLeft, rig.bench, rig.appearance), right(PaneSide::kRight, rig.bench, rig.appearance);
  rig.addLine("Line 1");
  left.showLive({});
  rig.bench.targeting().showSnapshot(PaneSide::kRight, rig.bench.document().snapshots()[1]->id);
  EXPECT_TRUE(left.live()) << "a change of the right pane is none of the left";
}

TEST(StatusStrip, ShowsTheLastSentenceAndTheMode) {
  PanelRig rig;
  StatusStrip strip(rig.bench, rig.actions, rig.appearance);
  strip.resize(1200, 36);
  rig.bench.say(QStringLiteral("The gripper is stuck."));
  EXPECT_EQ(strip.message(), QStringLiteral("The gripper is stuck."));
  bool mode = false;
  for (const auto* label : strip.findChildren<QLabel*>()) mode = mode || label->text() == QStringLiteral("VIRTUAL");
  EXPECT_TRUE(mode);
}

TEST(NoticeBar, HidesWithoutNoticesAndAnAnswerTakesItsNoticeAway) {
  NoticeBar bar;
  EXPECT_FALSE(bar.isVisibleTo(nullptr));
  int answered = 0;
  bar.post(QStringLiteral("a"), QStringLiteral("Take it back?"), {{QStringLiteral("Yes"), [&answered] { ++answered; }}});
  bar.post(QStringLiteral("b"), QStringLiteral("Gone."), {});
  EXPECT_TRUE(bar.has(QStringLiteral("a")));
  auto* button = bar.findChild<QPushButton*>();
  ASSERT_NE(button, nullptr);
  button->click();
  EXPECT_EQ(answered, 1);
  EXPECT_FALSE(bar.has(QStringLiteral("a")));
  bar.clear(QStringLiteral("b"));
  EXPECT_TRUE(bar.isHidden());
}

TEST(PictureFilesDialog, OpensOnlyWhatExistsAndNamesWhatIsMissing) {
  QTemporaryDir folder;
  PictureFilesDialog dialog;
  EXPECT_FALSE(dialog.isModal());
  QPushButton* open = nullptr;
  for (auto* button : dialog.findChildren<QPushButton*>()) {
    if (button->text().contains(QStringLiteral("Open"))) open = button;
  }
  ASSERT_NE(open, nullptr);
  EXPECT_FALSE(open->isEnabled());
  session::PictureFiles left, right;
  for (auto* path : {&left.image, &left.camera, &right.image, &right.camera}) {
    const QString file = folder.filePath(QStringLiteral("f%1").arg(reinterpret_cast<quintptr>(path)));
    QFile(file).open(QIODevice::WriteOnly);
    *path = file.toStdString();
  }
  dialog.setFiles(left, right);
  EXPECT_TRUE(open->isEnabled());
  right.camera = "/nowhere/camera.yaml";
  dialog.setFiles(left, right);
  EXPECT_FALSE(open->isEnabled());
  EXPECT_TRUE(open->toolTip().contains(QStringLiteral("/nowhere/camera.yaml")));
}

TEST(FileActions, AnOpenedSketchTakesThePlaceOfAnotherWhichUndoBringsBack) {
  PanelRig rig;
  QSettings settings(rig.folder.filePath(QStringLiteral("settings.ini")), QSettings::IniFormat);
  FileActions files(rig.bench, rig.actions, settings, nullptr);
  QSignalSpy folder_changed(&files, &FileActions::sketchFolderChanged);
  const QString cellar = rig.folder.filePath(QStringLiteral("cellar")), attic = rig.folder.filePath(QStringLiteral("attic"));
  rig.addLine("Line 1");
  files.saveSketch(cellar);
  ASSERT_TRUE(folder_changed.wait(10000));
  rig.addLine("Line 2");
  files.openSketch(cellar);
  ASSERT_TRUE(folder_changed.wait(10000));
  EXPECT_EQ(rig.bench.document().items().size(), 1u);
  EXPECT_EQ(files.sketchFolder(), cellar);
  EXPECT_TRUE(rig.bench.history().isClean());
  rig.bench.history().undo();
  EXPECT_EQ(rig.bench.document().items().size(), 2u) << "what was not saved must come back";
  EXPECT_TRUE(files.sketchFolder().isEmpty()) << "saving now would write over the opened sketch";
  files.saveSketch(attic);
  ASSERT_TRUE(folder_changed.wait(10000));
  EXPECT_EQ(files.sketchFolder(), attic);
  rig.bench.history().redo();
  EXPECT_TRUE(files.sketchFolder().isEmpty());
}

struct JogRig : PanelRig {
  JogRig() {
    bench.setWorkcell(std::make_shared<const planning::Workcell>(*planning::loadBuiltInWorkcell()));
    bench.jog().setRobot(
        [this](const planning::JogCommand& command) {
          sent.push_back(command);
          return answer;
        },
        [this] { ++released; });
    panel.resize(560, 170);
    panel.show();
  }
  std::vector<planning::JogCommand> sent;
  Status answer;
  int released = 0;
  JogPanel panel{bench};
};

TEST(JogPanel, HasAPairOfButtonsForEveryAxisAndSaysWhyTheyDoNotWork) {
  JogRig rig;
  for (const auto frame : {planning::JogFrame::kTool, planning::JogFrame::kBase, planning::JogFrame::kCamera, planning::JogFrame::kJoint}) {
    rig.panel.setFrame(frame);
    for (int axis = 0; axis < 6; ++axis) {
      ASSERT_NE(rig.panel.button(axis, -1), nullptr);
      EXPECT_FALSE(rig.panel.button(axis, 1)->isEnabled()) << "there is no robot";
      EXPECT_FALSE(rig.panel.button(axis, 1)->toolTip().isEmpty());
    }
    EXPECT_EQ(rig.panel.button(6, 1), nullptr);
  }
  EXPECT_FALSE(rig.panel.message().isEmpty());
}

TEST(JogPanel, RepeatsAKeyUntilItIsLetGoOf) {
  JogRig rig;
  rig.panel.setFrame(planning::JogFrame::kBase);
  rig.panel.setFocus();
  QTest::keyPress(&rig.panel, Qt::Key_PageUp);
  ASSERT_TRUE(QTest::qWaitFor([&] { return rig.sent.size() >= 3; }, 5000));
  EXPECT_EQ(rig.sent.back().linear, Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(rig.sent.back().frame, planning::JogFrame::kBase);
  QTest::keyRelease(&rig.panel, Qt::Key_PageUp);
  EXPECT_EQ(rig.released, 1);
  const std::size_t before = rig.sent.size();
  QTest::qWait(200);
  EXPECT_EQ(rig.sent.size(), before);
  QTest::keyPress(&rig.panel, Qt::Key_Right, Qt::ShiftModifier);
  EXPECT_EQ(rig.sent.back().angular, Eigen::Vector3d(0, -1, 0));
  rig.panel.hide();
  EXPECT_EQ(rig.released, 2) << "a hidden panel holds nothing";
}

TEST(JogPanel, LetsGoWhenTheRobotRefuses) {
  JogRig rig;
  rig.answer = Status(ErrorCode::kRefused, "jog: a motion is being played; pause it first");
  QSignalSpy said(&rig.bench, &Workbench::said);
  rig.panel.setFocus();
  QTest::keyPress(&rig.panel, Qt::Key_Up);
  EXPECT_EQ(rig.sent.size(), 1u);
  EXPECT_FALSE(rig.bench.jog().held());
  ASSERT_EQ(said.size(), 1);
  EXPECT_TRUE(said[0][0].toString().contains(QStringLiteral("pause it first")));
}

}  // namespace
}  // namespace longarm::ui
