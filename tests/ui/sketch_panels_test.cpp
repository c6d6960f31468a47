// Panels and dialogs of the sketch: world, library, numbers, notes, third picture.
#include <algorithm>

#include <QComboBox>
#include <QFileInfo>
#include <QInputDialog>
#include <QListWidget>
#include <QPushButton>
#include <QSlider>
#include <QTableWidget>
#include <QToolButton>
#include <gtest/gtest.h>

#include "session/commands/world_commands.h"
#include "tests/ui/panel_rig.h"
#include "ui/compare_dialog.h"
#include "ui/notice_bar.h"
#include "ui/numbers_dialog.h"
#include "ui/simulated_hand.h"
#include "ui/sketch_actions.h"
#include "ui/sketch_edits.h"
#include "ui/sketch_watch.h"
#include "ui/snapshots_panel.h"
#include "ui/third_pane.h"
#include "ui/world_panel.h"

namespace longarm::ui {
namespace {

using tests::PanelRig;
using vision::PaneSide;

struct EditRig : PanelRig {
  QWidget window;
  SketchActions sketch{bench.targeting(), actions};
  SketchEdits edits{bench, actions, &window};

  /// A measured point of the scene.
  FeatureId addPoint(const Eigen::Vector3d& at) {
    if (bench.document().snapshots().empty()) addLine("Line 1");
    session::SketchItem item;
    item.id = bench.document().nextFeatureId();
    item.name = bench.document().freeName(item.kind);
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      item.setPick(bench.document().paneSnapshotId(side), 0, {scene.pixel(side, at), session::PickState::kFree});
    }
    bench.history().push(session::addItem(item));
    return item.id;
  }
};

TEST(WorldPanel, ListsEditsAndRemovesWhatWasAddedEachAsOneUndoStep) {
  EditRig rig;
  WorldPanel panel(rig.bench, rig.actions);
  EXPECT_FALSE(rig.actions.at(ActionId::kAddToWorld)->isEnabled());
  const FeatureId line = rig.addLine("Line 1");
  EXPECT_TRUE(rig.actions.whyNot(ActionId::kAddToWorld).contains(QStringLiteral("pipe tool"))) << "a bare line has no thickness";
  const FeatureId point = rig.addPoint({1.5, 0.0, 1.0});
  rig.bench.targeting().select(point);
  ASSERT_TRUE(rig.actions.at(ActionId::kAddToWorld)->isEnabled()) << rig.actions.whyNot(ActionId::kAddToWorld).toStdString();
  const auto steps = rig.bench.history().position();
  rig.actions.at(ActionId::kAddToWorld)->trigger();
  ASSERT_EQ(panel.table()->rowCount(), 1);
  EXPECT_EQ(rig.bench.world().items()[0].source, point);
  panel.table()->item(0, WorldPanel::kSizeX)->setText(QStringLiteral("50"));
  EXPECT_DOUBLE_EQ(rig.bench.world().items()[0].size.x(), 0.05);
  panel.table()->item(0, WorldPanel::kMargin)->setText(QStringLiteral("12.5"));
  auto* role = qobject_cast<QComboBox*>(panel.table()->cellWidget(0, WorldPanel::kRole));
  ASSERT_NE(role, nullptr);
  EXPECT_EQ(role->findText(QStringLiteral("workspace")), -1) << "a point cannot be one";
  role->setCurrentIndex(role->findText(QStringLiteral("drawn only")));
  Q_EMIT role->activated(role->currentIndex());
  QCoreApplication::processEvents();
  EXPECT_DOUBLE_EQ(rig.bench.world().items()[0].margin_m, 0.0125);
  EXPECT_EQ(rig.bench.world().items()[0].role, session::WorldRole::kDrawn);
  panel.table()->item(0, WorldPanel::kSizeX)->setText(QStringLiteral("-3"));
  EXPECT_DOUBLE_EQ(rig.bench.world().items()[0].size.x(), 0.05) << "refused";
  EXPECT_EQ(panel.table()->item(0, WorldPanel::kSizeX)->text(), QStringLiteral("50.0"));
  EXPECT_EQ(rig.bench.history().position(), steps + 4);
  panel.table()->selectRow(0);
  panel.removeButton()->click();
  EXPECT_EQ(panel.table()->rowCount(), 0);
  for (int i = 0; i < 5; ++i) rig.bench.targeting().undo();
  EXPECT_TRUE(rig.bench.world().items().empty());
  EXPECT_NE(rig.bench.document().item(line), nullptr) << "only the world was undone";
}

/// The built-in robot standing at home.
struct PlanRig : EditRig {
  std::shared_ptr<JointState> joints = std::make_shared<JointState>();
  PlanRig() {
    auto workcell = planning::loadBuiltInWorkcell();
    EXPECT_TRUE(workcell.ok());
    bench.setWorkcell(std::make_shared<const planning::Workcell>(std::move(*workcell)));
    const auto& model = *bench.document().workcell()->model;
    joints->names = model.actuatedNames();
    joints->positions = model.neutral();
    for (const auto& [name, value] : bench.document().workcell()->poses.at("home")) {
      const auto found = std::find(joints->names.begin(), joints->names.end(), name);
      if (found != joints->names.end()) joints->positions(found - joints->names.begin()) = value;
    }
    bench.plans().setJointSource([this] { return joints; });
  }
  /// Plans and waits.  @returns the reason of a plan that failed, or "ok".
  std::string plan(const QString& macro) {
    int answers = 0;
    const auto connection = QObject::connect(&bench.plans(), &session::PlanController::planned, [&answers](bool) { ++answers; });
    const Status started = bench.plans().plan(macro);
    if (!started) return started.error().message;
    SimulatedHand::waitFor([&answers] { return answers > 0; }, 60);
    QObject::disconnect(connection);
    const auto& record = bench.document().plan();
    if (!record) return "no answer";
    return record->plan.ok() ? "ok" : record->plan.reason;
  }
};

TEST(SketchedWorld, IsKeptClearOfByPlansWhichGoStaleWhenItChanges) {
  PlanRig rig;
  ASSERT_EQ(rig.plan(QStringLiteral("ready")), "ok");
  const auto path = session::planPath(*rig.bench.document().workcell(), rig.bench.document().plan()->plan);
  ASSERT_FALSE(path.empty());
  ASSERT_TRUE(rig.bench.plans().checkFresh(*rig.joints));
  session::WorldItem body;
  body.id = rig.bench.document().nextWorldId();
  body.name = "sketched crate";
  body.parent = rig.bench.document().workcell()->model->links()[static_cast<std::size_t>(rig.bench.document().workcell()->model->rootLink())].name;
  body.size.setConstant(0.15);
  body.X_WO.translation() = path.back();
  rig.bench.history().push(session::addWorldItem(body));
  EXPECT_FALSE(rig.bench.plans().checkFresh(*rig.joints)) << "the world is not what the plan was made for";
  const std::string reason = rig.plan(QStringLiteral("ready"));
  EXPECT_NE(reason.find("sketched crate"), std::string::npos) << reason;
  body.role = session::WorldRole::kDrawn;
  ASSERT_TRUE(rig.bench.world().edit(body));
  EXPECT_EQ(rig.plan(QStringLiteral("ready")), "ok") << "drawn, but planned through";
}

TEST(SketchEdits, ExportsTheWorldOffTheGuiThread) {
  EditRig rig;
  rig.bench.targeting().select(rig.addPoint({1.5, 0.0, 1.0}));
  rig.actions.at(ActionId::kAddToWorld)->trigger();
  const QString path = rig.folder.filePath(QStringLiteral("world.glb"));
  rig.edits.exportWorld(path);
  EXPECT_TRUE(SimulatedHand::waitFor([&] { return QFileInfo(path).size() > 100; }, 20));
}

TEST(SketchEdits, StandsTheRemovalOfWhatIsSelected) {
  EditRig rig;
  rig.bench.targeting().select(rig.addPoint({1.5, 0.0, 1.0}));
  EXPECT_TRUE(rig.actions.at(ActionId::kAddToWorld)->isEnabled());
  rig.actions.at(ActionId::kDelete)->trigger();
  EXPECT_FALSE(rig.actions.at(ActionId::kAddToWorld)->isEnabled());
  rig.bench.targeting().undo();
  EXPECT_TRUE(rig.actions.at(ActionId::kAddToWorld)->isEnabled());
}

TEST(SketchEdits, WritesANoteGroupsAndUngroups) {
  EditRig rig;
  const FeatureId first = rig.addLine("Line 1"), second = rig.addLine("Line 2");
  rig.bench.targeting().select(first);
  auto* dialog = rig.edits.askNote();
  ASSERT_NE(dialog, nullptr);
  EXPECT_FALSE(dialog->isModal());
  dialog->setTextValue(QStringLiteral("valve 3"));
  dialog->accept();
  EXPECT_EQ(rig.bench.document().item(first)->note, "valve 3");
  EXPECT_FALSE(rig.actions.at(ActionId::kGroup)->isEnabled()) << "one feature is no group";
  rig.actions.at(ActionId::kSelectAll)->trigger();
  rig.actions.at(ActionId::kGroup)->trigger();
  EXPECT_NE(rig.bench.document().item(first)->group, 0U);
  EXPECT_EQ(rig.bench.document().item(first)->group, rig.bench.document().item(second)->group);
  rig.actions.at(ActionId::kUngroup)->trigger();
  EXPECT_EQ(rig.bench.document().item(second)->group, 0U);
  EXPECT_FALSE(rig.actions.at(ActionId::kUngroup)->isEnabled());
}

TEST(NumbersDialog, MovesAVertexByMillimetresAndByPixelsAndSaysWhyNot) {
  EditRig rig;
  const FeatureId id = rig.addLine("Line 1");
  rig.bench.targeting().select(id);
  NumbersDialog& dialog = *rig.edits.showNumbers();
  ASSERT_EQ(dialog.table()->rowCount(), 2);
  dialog.table()->item(0, NumbersDialog::kX)->setText(QStringLiteral("1540"));
  const auto measured = rig.bench.document().measurement(id).feature;
  ASSERT_TRUE(measured);
  EXPECT_NEAR(measured->vertices[0].xyz.x(), 1.540, 1e-5);
  EXPECT_NEAR(measured->vertices[0].xyz.y(), rig.scene.a.y(), 1e-4) << "the other numbers stay";
  dialog.table()->item(1, NumbersDialog::kRightU)->setText(QStringLiteral("321.25"));
  EXPECT_DOUBLE_EQ(rig.bench.document().item(id)->pick(rig.bench.document().paneSnapshotId(PaneSide::kRight), 1)->pixel.x(), 321.25);
  dialog.table()->item(0, NumbersDialog::kX)->setText(QStringLiteral("-9000"));
  EXPECT_FALSE(dialog.message().isEmpty()) << "no picture sees that";
  EXPECT_NE(dialog.table()->item(0, NumbersDialog::kX)->text(), QStringLiteral("-9000.00"));
  dialog.table()->item(0, NumbersDialog::kX)->setText(QStringLiteral("abc"));
  EXPECT_TRUE(dialog.message().contains(QStringLiteral("number")));
  rig.bench.targeting().setLocked(id, true);
  EXPECT_FALSE(dialog.table()->item(0, NumbersDialog::kX)->flags() & Qt::ItemIsEditable);
}

/// Three pictures: the pair and one from above.
struct ThirdRig : EditRig {
  vision::View mast = tests::viewAt("mast", {0.1, 0.0, 1.3}, 0.0);
  FeatureId line = addLine("Line 1");
  ThirdRig() {
    bench.history().push(session::addSnapshots(bench.document(), {tests::snapshotOf(3, mast)}, PaneSide::kRight));
    bench.targeting().showSnapshot(PaneSide::kRight, SnapshotId{2});
    bench.targeting().select(line);
  }
};

TEST(SnapshotsPanel, ShowsChoosesPinsAndDeletes) {
  ThirdRig rig;
  SnapshotsPanel panel(rig.bench, rig.appearance);
  ASSERT_EQ(panel.list()->count(), 3);
  EXPECT_FALSE(panel.list()->item(0)->icon().isNull());
  EXPECT_TRUE(panel.list()->item(2)->text().contains(QStringLiteral("mast")));
  using Button = SnapshotsPanel::Button;
  EXPECT_FALSE(panel.button(Button::kDelete)->isEnabled()) << "nothing is chosen";
  panel.list()->setCurrentRow(0);
  EXPECT_FALSE(panel.button(Button::kThird)->isEnabled()) << "it is in a pane";
  panel.list()->setCurrentRow(2);
  panel.button(Button::kPin)->click();
  EXPECT_TRUE(rig.bench.document().pinned({3}));
  EXPECT_FALSE(panel.button(Button::kDelete)->isEnabled());
  panel.button(Button::kLeft)->click();
  EXPECT_EQ(rig.bench.document().paneSnapshotId(PaneSide::kLeft), SnapshotId{3});
  EXPECT_EQ(panel.chosen(), SnapshotId{3}) << "the choice is kept";
  panel.button(Button::kPin)->click();
  panel.button(Button::kDelete)->click();
  EXPECT_EQ(panel.list()->count(), 2);
  rig.bench.targeting().undo();
  EXPECT_EQ(panel.list()->count(), 3);
}

TEST(SnapshotsPanel, OffersThePairForComparing) {
  ThirdRig rig;
  SnapshotsPanel panel(rig.bench, rig.appearance);
  vision::SnapshotPtr a, b;
  QObject::connect(&panel, &SnapshotsPanel::compareRequested, [&](const vision::SnapshotPtr& first, const vision::SnapshotPtr& second) {
    a = first;
    b = second;
  });
  panel.list()->setCurrentRow(1);
  panel.button(SnapshotsPanel::Button::kCompare)->click();
  ASSERT_TRUE(a && b);
  CompareDialog dialog(a, b, rig.appearance.theme());
  dialog.slider()->setValue(100);
  EXPECT_EQ(dialog.shown().at<cv::Vec3b>(5, 5)[0], b->image.at<unsigned char>(5, 5));
}

TEST(CompareDialog, BlinksBetweenBothPicturesUntilItIsTold) {
  PanelRig rig;
  auto dark = std::make_shared<vision::Snapshot>(*tests::snapshotOf(1, rig.scene.left)), bright = std::make_shared<vision::Snapshot>(*dark);
  bright->image = cv::Mat(dark->image.size(), CV_8UC1, cv::Scalar(220));
  CompareDialog dialog(dark, bright, rig.appearance.theme());
  dialog.blinkButton()->click();
  const auto shows = [&](int grey) { return [&dialog, grey] { return dialog.shown().at<cv::Vec3b>(5, 5)[0] == grey; }; };
  EXPECT_TRUE(shows(80)());
  EXPECT_TRUE(SimulatedHand::waitFor(shows(220), 20));
  EXPECT_TRUE(SimulatedHand::waitFor(shows(80), 20));
  EXPECT_FALSE(dialog.slider()->isEnabled());
  dialog.blinkButton()->click();
  dialog.slider()->setValue(100);
  EXPECT_TRUE(shows(220)());
  EXPECT_FALSE(SimulatedHand::waitFor(shows(80), 1.2)) << "stands still again";
}

class ThirdOnCanvas : public ::testing::TestWithParam<double> {};

TEST_P(ThirdOnCanvas, ShowsBothCurvesAndFlagsAClickThatIsOff) {
  ThirdRig rig;
  ThirdPane pane(rig.bench, rig.appearance);
  EXPECT_TRUE(pane.isHidden()) << "no third picture yet";
  pane.resize(640, 560);
  rig.bench.targeting().setThird(SnapshotId{3});
  EXPECT_FALSE(pane.isHidden());
  pane.show();
  const Eigen::Vector2d truth = rig.mast.project(rig.scene.a).value();
  for (int i = 0; i < 4; ++i) pane.canvas()->zoomAbout(*pane.canvas()->widgetOfPixel(truth), GetParam() / pane.canvas()->scale());
  int curves = 0;
  for (const auto& shape : rig.bench.targeting().thirdOverlay().shapes) {
    curves += shape.role == vision::OverlayRole::kEpipolar && shape.kind == vision::OverlayShape::Kind::kPolyline ? 1 : 0;
  }
  EXPECT_EQ(curves, 2);
  const auto warned = [&] {
    for (const auto& shape : rig.bench.targeting().thirdOverlay().shapes) {
      if (shape.role == vision::OverlayRole::kWarning) return true;
    }
    return false;
  };
  SimulatedHand hand;
  hand.click(pane.canvas(), *pane.canvas()->widgetOfPixel(truth));
  ASSERT_NE(rig.bench.document().item(rig.line)->pick({3}, 0), nullptr);
  if (GetParam() >= 1) {
    EXPECT_FALSE(warned());
  }
  hand.click(pane.canvas(), *pane.canvas()->widgetOfPixel(truth + Eigen::Vector2d(0, 18)));
  EXPECT_TRUE(warned());
  rig.bench.targeting().undo();
  rig.bench.targeting().undo();
  EXPECT_EQ(rig.bench.document().item(rig.line)->pick({3}, 0), nullptr);
  rig.bench.targeting().setThird({});
  EXPECT_TRUE(pane.isHidden());
}
INSTANTIATE_TEST_SUITE_P(Zooms, ThirdOnCanvas, ::testing::Values(0.25, 1.0, 4.0));

TEST(SketchWatch, WarnsOfAPoorPairBeforeAnythingIsPicked) {
  PanelRig rig;
  NoticeBar notices;
  SketchWatch watch(rig.bench, notices);
  vision::View again = rig.scene.left;
  again.name = "again";
  again.X_WC.translation().y() -= 0.005;
  rig.bench.history().push(session::addSnapshots(rig.bench.document(), {tests::snapshotOf(1, rig.scene.left), tests::snapshotOf(2, again)}));
  EXPECT_TRUE(notices.has(QStringLiteral("baseline")));
  rig.bench.history().push(session::addSnapshots(rig.bench.document(), {tests::snapshotOf(3, rig.scene.right)}, PaneSide::kRight));
  EXPECT_FALSE(notices.has(QStringLiteral("baseline")));
}

}  // namespace
}  // namespace longarm::ui
