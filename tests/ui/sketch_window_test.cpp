// The whole window at work on a sketch: match help, pipe, box, world, library, third picture.
#include <QDockWidget>
#include <QListWidget>
#include <QTableView>
#include <QTableWidget>
#include <QToolButton>

#include "session/commands/sketch_commands.h"
#include "tests/session/painted_views.h"
#include "tests/ui/window_fixture.h"
#include "ui/compare_dialog.h"
#include "ui/snapshots_panel.h"

namespace longarm {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using session::PickState;
using ui::ActionId;
using ui::SimulatedHand;
using vision::PaneSide;

class SketchWindow : public tests::WindowFixture {
 protected:
  void openPainted() {
    openWindow(QStringLiteral("dark"), {1600, 950});
    auto snapshots = pair.snapshots();
    auto third = std::make_shared<vision::Snapshot>();
    third->id = {3};
    third->view = tests::viewOf(tests::lensCamera("mast"), {0.1, -0.2, 0.05}, {0.1, 0, 0});
    third->image = pair.wall.seenBy(third->view, nullptr, 1, 0);
    snapshots.push_back(third);
    for (auto& snapshot : snapshots) {
      auto placed = std::make_shared<vision::Snapshot>(*snapshot);
      placed->view.pose_covariance = 1e-6 * Matrix6d::Identity();
      snapshot = placed;
    }
    views = snapshots;
    bench->history().push(session::addSnapshots(bench->document(), snapshots));
    SimulatedHand::pump(200);
  }
  void drag(PaneSide side, const Vector2d& a, const Vector2d& b) {
    auto* canvas = window->pictures()->pane(side)->canvas();
    hand.drag(canvas, *canvas->widgetOfPixel(a), *canvas->widgetOfPixel(b));
  }
  const vision::View& view(PaneSide side) const { return views[static_cast<std::size_t>(side)]->view; }
  /// Marks vertices where both pictures see them.
  FeatureId add(vision::FeatureKind kind, const std::vector<Vector3d>& places) {
    session::SketchItem item;
    item.id = bench->document().nextFeatureId();
    item.kind = kind;
    item.name = bench->document().freeName(kind);
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      for (std::size_t i = 0; i < places.size(); ++i) {
        item.setPick(views[static_cast<std::size_t>(side)]->id, static_cast<int>(i), {view(side).project(places[i]).value(), PickState::kFree});
      }
    }
    bench->history().push(session::addItem(item));
    return item.id;
  }

  tests::PaintedPair pair{tests::PaintedWall::textured(3)};
  std::vector<vision::SnapshotPtr> views;
};

TEST_F(SketchWindow, OffersMatchesAndTakesThemWithTab) {
  openPainted();
  window->actions().at(ActionId::kToolLine)->trigger();
  drag(PaneSide::kLeft, pair.pixel(PaneSide::kLeft, -0.1, 0.02), pair.pixel(PaneSide::kLeft, 0.12, -0.05));
  ASSERT_TRUE(SimulatedHand::waitFor([this] { return bench->targeting().matchHelp().size() == 2; }, 30));
  look(QStringLiteral("match-offered"));
  for (int i = 0; i < 2; ++i) hand.key(window->pictures()->pane(PaneSide::kLeft)->canvas(), Qt::Key_Tab);
  ASSERT_EQ(bench->document().items().size(), 1U);
  EXPECT_TRUE(bench->document().measurement(bench->document().items()[0].id).feature);
  look(QStringLiteral("match-taken"));
}

TEST_F(SketchWindow, MeasuresBetweenFeaturesThatArePickedInTheScene) {
  openPainted();
  const Vector3d a(-0.1, 0.05, 1.4), b(0.2, -0.1, 1.5), c(0.1, 0.15, 1.45);
  const FeatureId first = add(vision::FeatureKind::kPoint, {a}), line = add(vision::FeatureKind::kLine, {b, c});
  window->actions().at(ActionId::kToolMeasure)->trigger();
  auto* view = window->scene()->view();
  if (!view->usable()) GTEST_SKIP() << "skipped: no OpenGL";
  view->lookFromView(this->view(PaneSide::kLeft));
  look(QStringLiteral("scene-before"));
  const auto pick = [&](const Vector3d& place) {
    const auto at = view->widgetOfPoint(place);
    ASSERT_TRUE(at);
    QWidget* surface = view->childAt(at->toPoint());
    ASSERT_NE(surface, nullptr);
    hand.click(surface, surface->mapFrom(view, at->toPoint()));
  };
  pick(a);
  pick(b);
  const auto distance = bench->targeting().dimension();
  ASSERT_TRUE(distance);
  ASSERT_EQ(distance->points.size(), 2U);
  EXPECT_EQ(distance->text, session::distanceBetween(bench->document(), {first, 0}, {line, 0})->text());
  EXPECT_TRUE(bench->targeting().hint().startsWith(QStringLiteral("Distance ")));
  look(QStringLiteral("scene-distance"));
  pick(c);
  EXPECT_EQ(bench->targeting().dimension()->text, session::angleAt(bench->document(), {first, 0}, {line, 0}, {line, 1})->text());
  look(QStringLiteral("scene-angle"));
  EXPECT_TRUE(bench->document().selection().contains(line)) << "the tool measures, it does not select";
  bench->targeting().key(vision::SketchKey::kEscape);
  EXPECT_FALSE(bench->targeting().dimension());
}

TEST_F(SketchWindow, KeepsALibraryWhosePicturesAreChosenPinnedComparedAndDeleted) {
  openPainted();
  window->findChild<QDockWidget*>(QStringLiteral("snapshots"))->raise();
  SimulatedHand::pump(50);
  auto* panel = window->snapshots();
  using Button = ui::SnapshotsPanel::Button;
  ASSERT_EQ(panel->list()->count(), 3);
  for (int row = 0; row < 3; ++row) {
    EXPECT_FALSE(panel->list()->item(row)->icon().isNull()) << "a thumbnail";
    EXPECT_TRUE(panel->list()->item(row)->text().contains(QString::fromStdString(views[static_cast<std::size_t>(row)]->view.name)));
  }
  panel->list()->setCurrentRow(2);
  hand.click(panel->button(Button::kPin));
  EXPECT_TRUE(bench->document().pinned({3}));
  hand.click(panel->button(Button::kRight));
  EXPECT_EQ(bench->document().paneSnapshotId(PaneSide::kRight), SnapshotId{3});
  EXPECT_FALSE(window->pictures()->pane(PaneSide::kRight)->live());
  panel->list()->setCurrentRow(1);
  hand.click(panel->button(Button::kCompare));
  auto* compare = window->findChild<ui::CompareDialog*>();
  ASSERT_NE(compare, nullptr);
  EXPECT_TRUE(compare->isVisible());
  EXPECT_FALSE(compare->isModal());
  hand.click(compare->blinkButton());
  look(QStringLiteral("compare"));
  compare->close();
  hand.click(panel->button(Button::kThird));
  EXPECT_EQ(bench->targeting().third(), SnapshotId{2});
  EXPECT_TRUE(window->pictures()->third()->isVisible());
  hand.click(panel->button(Button::kDelete));
  EXPECT_EQ(panel->list()->count(), 2);
  EXPECT_FALSE(window->pictures()->third()->isVisible()) << "gone with its picture";
  panel->list()->setCurrentRow(1);
  EXPECT_FALSE(panel->button(Button::kDelete)->isEnabled()) << "pinned";
}

TEST_F(SketchWindow, MeasuresABoxMakesItWorldAndChecksItInAThirdPicture) {
  openPainted();
  const Vector3d o(0.05, 0.1, 1.3);
  const Eigen::Matrix3d R = expSO3({0.5, 0.6, 0.1});
  add(vision::FeatureKind::kTriad, {o, o + 0.2 * R.col(0), o - 0.15 * R.col(1), o + 0.12 * R.col(2)});
  look(QStringLiteral("box-measured"));
  ASSERT_TRUE(window->actions().at(ActionId::kAddToWorld)->isEnabled()) << window->actions().whyNot(ActionId::kAddToWorld).toStdString();
  window->actions().at(ActionId::kAddToWorld)->trigger();
  ASSERT_EQ(window->world()->table()->rowCount(), 1);
  window->findChild<QDockWidget*>(QStringLiteral("world"))->raise();
  look(QStringLiteral("box-world"));
  bench->targeting().setThird(SnapshotId{3});
  window->findChild<QDockWidget*>(QStringLiteral("snapshots"))->raise();
  EXPECT_EQ(window->snapshots()->list()->count(), 3);
  EXPECT_TRUE(window->pictures()->third()->isVisible());
  look(QStringLiteral("third-picture"));
}

}  // namespace
}  // namespace longarm
