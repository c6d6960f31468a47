// Match help on the real canvas: drag in one picture, Tab in it, and the other is marked.
#include <QSignalSpy>
#include <QTemporaryDir>
#include <gtest/gtest.h>

#include "session/commands/sketch_commands.h"
#include "tests/session/painted_views.h"
#include "ui/notice_bar.h"
#include "ui/simulated_hand.h"
#include "ui/sketch_watch.h"
#include "ui/snapshot_pane.h"

namespace longarm::ui {
namespace {

using session::PickState;
using session::ToolKind;
using vision::PaneSide;

struct PaintedRig {
  QTemporaryDir folder;
  Appearance appearance{QStringLiteral("dark")};
  Workbench bench{folder.filePath(QStringLiteral("autosave"))};
  tests::PaintedPair pair{tests::PaintedWall::textured(3)};
  SnapshotPane left{PaneSide::kLeft, bench, appearance}, right{PaneSide::kRight, bench, appearance};
  SimulatedHand hand;

  PaintedRig() {
    for (auto* pane : {&left, &right}) {
      pane->resize(640, 520);
      pane->show();
    }
    bench.history().push(session::addSnapshots(bench.document(), pair.snapshots()));
  }
  void zoom(double scale, const Eigen::Vector2d& about) {
    left.canvas()->fit();
    for (int i = 0; i < 4; ++i) {
      const auto at = left.canvas()->widgetOfPixel(about);
      left.canvas()->zoomAbout(*at, scale / left.canvas()->scale());
    }
  }
};

class MatchOnCanvas : public ::testing::TestWithParam<double> {};

TEST_P(MatchOnCanvas, IsFoundOffTheGuiThreadAndTakenWithTab) {
  PaintedRig rig;
  const Eigen::Vector2d at = rig.pair.pixel(PaneSide::kLeft, 0.05, 0.02);
  rig.zoom(GetParam(), at);
  ASSERT_NEAR(rig.left.canvas()->scale(), GetParam(), 0.01);
  rig.bench.targeting().setTool(ToolKind::kPoint);
  QSignalSpy found(&rig.bench.matches(), &session::MatchController::found);
  rig.hand.click(rig.left.canvas(), *rig.left.canvas()->widgetOfPixel(at));
  ASSERT_EQ(rig.bench.document().items().size(), 1U);
  ASSERT_TRUE(SimulatedHand::waitFor([&] { return found.count() > 0; }, 30));
  ASSERT_EQ(rig.bench.targeting().matchHelp().size(), 1U);
  EXPECT_TRUE(rig.bench.targeting().matchHelp()[0].offered());
  EXPECT_EQ(rig.bench.targeting().tool(), ToolKind::kPoint) << "found is not taken";
  rig.hand.key(rig.left.canvas(), Qt::Key_Tab);
  const auto* pick = rig.bench.document().items()[0].pick({2}, 0);
  ASSERT_NE(pick, nullptr);
  EXPECT_EQ(pick->state, PickState::kMatched);
  EXPECT_LT((pick->pixel - rig.pair.pixel(PaneSide::kRight, 0.05, 0.02)).norm(), 3.0) << "what was clicked, to a screen pixel";
  rig.bench.targeting().undo();
  EXPECT_NE(rig.bench.targeting().document().items()[0].placedCount(0), 2);
}
INSTANTIATE_TEST_SUITE_P(Zooms, MatchOnCanvas, ::testing::Values(0.25, 1.0, 4.0));

TEST(SketchWatch, PostsTheCalibrationNoticeAndTakesItAwayWithTheCause) {
  QTemporaryDir folder;
  Workbench bench(folder.filePath(QStringLiteral("autosave")));
  NoticeBar notices;
  SketchWatch watch(bench, notices);
  tests::StereoScene scene;
  bench.history().push(session::addSnapshots(bench.document(), {tests::snapshotOf(1, scene.left), tests::snapshotOf(2, scene.right)}));
  session::SketchItem item;
  item.id = bench.document().nextFeatureId();
  item.name = "Point 1";
  item.setPick({1}, 0, {scene.pixel(PaneSide::kLeft, scene.a), PickState::kFree});
  item.setPick({2}, 0, {scene.pixel(PaneSide::kRight, scene.a) + Eigen::Vector2d(0, 9), PickState::kReleased});
  bench.history().push(session::addItem(item));
  EXPECT_TRUE(notices.has(QStringLiteral("calibration")));
  bench.targeting().undo();
  EXPECT_FALSE(notices.has(QStringLiteral("calibration")));
}

}  // namespace
}  // namespace longarm::ui
