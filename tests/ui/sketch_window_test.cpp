// The whole window at work on a sketch: match help, pipe, box, world, library, third picture.
#include <QDockWidget>
#include <QListWidget>
#include <QTableView>
#include <QTableWidget>

#include "session/commands/sketch_commands.h"
#include "tests/session/painted_views.h"
#include "tests/ui/window_fixture.h"

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
