// Every gesture of the sketch with a mouse on the real canvas, at 25 %, 100 % and 400 %.
#include <QApplication>
#include <QMenu>
#include <QSignalSpy>
#include <gtest/gtest.h>

#include "tests/session/painted_views.h"
#include "tests/ui/canvas_rig.h"
#include "ui/sketch_edits.h"

namespace longarm::ui {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using session::PickState;
using session::ToolKind;
using tests::CanvasRig;
using vision::OverlayRole;
using vision::PaneSide;

constexpr PaneSide kLeft = PaneSide::kLeft, kRight = PaneSide::kRight;
constexpr PaneSide kBoth[] = {kLeft, kRight};
constexpr double kOnCurve_m = 1e-3;        // The curve is a polyline, 0.02 px from the true one.

class CanvasGesture : public ::testing::TestWithParam<double> {
 protected:
  CanvasGesture() : rig(GetParam()) {}
  void SetUp() override {
    rig.openPair();
    ASSERT_NEAR(rig.left.canvas()->scale(), GetParam(), 1e-9);
    ASSERT_NEAR(rig.right.canvas()->scale(), GetParam(), 1e-9);
  }
  FeatureId add(std::uint64_t line, const Vector2d& by = Vector2d::Zero()) {
    session::SketchItem item;
    item.id = {line};
    item.kind = vision::FeatureKind::kLine;
    item.name = "Line " + std::to_string(line);
    for (const PaneSide side : kBoth) {
      const auto state = side == kLeft ? PickState::kFree : PickState::kConstrained;
      item.setPick(rig.document().paneSnapshotId(side), 0, {rig.seen(side, rig.scene.a) + by, state});
      item.setPick(rig.document().paneSnapshotId(side), 1, {rig.seen(side, rig.scene.b) + by, state});
    }
    rig.bench.history().push(session::addItem(item));
    return item.id;
  }
  /// A pick as the document has it.
  Vector2d pickOf(FeatureId id, PaneSide side, int vertex) {
    return rig.document().item(id)->pick(rig.document().paneSnapshotId(side), vertex)->pixel;
  }
  /// A marker is drawn there, in this pane.
  bool drawnAt(PaneSide side, const Vector2d& pixel) {
    for (const auto& shape : rig.targeting().overlay(side).shapes) {
      if (shape.kind == vision::OverlayShape::Kind::kMarker && (shape.points[0] - pixel).norm() < 1e-6) return true;
    }
    return false;
  }
  void expectVertices(const std::vector<Vector3d>& truth) {
    ASSERT_EQ(rig.document().items().size(), 1U);
    ASSERT_TRUE(rig.measured().feature) << rig.measured().reason;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_LT((rig.measured().feature->vertices[i].xyz - truth[i]).norm(), kOnCurve_m) << "vertex " << i;
    }
    EXPECT_EQ(rig.targeting().tool(), ToolKind::kSelect) << "finished";
  }

  CanvasRig rig;
};
INSTANTIATE_TEST_SUITE_P(Zooms, CanvasGesture, ::testing::ValuesIn(tests::kZooms));

TEST_P(CanvasGesture, ClicksAPoint) {
  rig.targeting().setTool(ToolKind::kPoint);
  for (const PaneSide side : kBoth) rig.click(side, rig.seen(side, rig.scene.a));
  expectVertices({rig.scene.a});
}

TEST_P(CanvasGesture, StrokesALine) {
  rig.targeting().setTool(ToolKind::kLine);
  for (const PaneSide side : kBoth) rig.drag(side, rig.seen(side, rig.scene.a), rig.seen(side, rig.scene.b));
  expectVertices({rig.scene.a, rig.scene.b});
  EXPECT_EQ(rig.bench.history().size(), 2U) << "one gesture is one step";
}

TEST_P(CanvasGesture, DragsTheCopyOfALineByItsHandles) {
  rig.targeting().setTool(ToolKind::kLine);
  const Vector2d size(tests::kWidth - 1, tests::kHeight - 1);
  rig.drag(kLeft, size.cwiseProduct(Vector2d(0.35, 0.5)), rig.seen(kLeft, rig.scene.a));
  rig.drag(kLeft, size.cwiseProduct(Vector2d(0.65, 0.5)), rig.seen(kLeft, rig.scene.b));
  ASSERT_TRUE(rig.only().placedIn(rig.document().paneSnapshotId(kLeft)));
  for (int vertex = 0; vertex < 2; ++vertex) rig.drag(kRight, rig.pick(kRight, vertex), rig.seen(kRight, vertex == 0 ? rig.scene.a : rig.scene.b));
  expectVertices({rig.scene.a, rig.scene.b});
}

TEST_P(CanvasGesture, ClicksAPlaneAndATriad) {
  for (const ToolKind kind : {ToolKind::kPlane, ToolKind::kTriad}) {
    rig.targeting().setTool(kind);
    for (const PaneSide side : kBoth) {
      for (const auto& corner : tests::trueCorners(kind)) rig.click(side, rig.seen(side, corner));
    }
    expectVertices(tests::trueCorners(kind));
    EXPECT_EQ(rig.measured().feature->box.has_value(), kind == ToolKind::kTriad);
    rig.targeting().remove(rig.only().id);
  }
}

TEST_P(CanvasGesture, StrokesTheOutlinesOfAPipe) {
  const tests::TruePipe truth;
  rig.targeting().setTool(ToolKind::kPipe);
  for (const PaneSide side : kBoth) {
    const auto ends = truth.outlines(rig.scene.view(side));
    rig.drag(side, ends[0], ends[1]);
    rig.drag(side, ends[2], ends[3]);
  }
  ASSERT_EQ(rig.document().items().size(), 1U);
  ASSERT_TRUE(rig.measured().feature) << rig.measured().reason;
  EXPECT_NEAR(rig.measured().feature->pipe->radius, truth.radius, 2e-4);
  EXPECT_EQ(rig.bench.history().size(), 4U);
}

TEST_P(CanvasGesture, DragsAHandleAlongItsCurveAndWithControlOffIt) {
  const FeatureId id = add(1);
  const Vector2d before = pickOf(id, kRight, 0), aside(6 + 8 / GetParam(), 14 + 4 / GetParam());
  rig.drag(kRight, before, before + aside);
  EXPECT_EQ(rig.only().pick({2}, 0)->state, PickState::kConstrained);
  EXPECT_GT((pickOf(id, kRight, 0) - before).norm(), 4);
  EXPECT_LT(rig.measured().feature->vertices[0].miss_m, 1e-3);
  rig.targeting().undo();
  EXPECT_EQ(pickOf(id, kRight, 0), before);
  rig.drag(kRight, before, before + aside, Qt::ControlModifier);
  EXPECT_EQ(rig.only().pick({2}, 0)->state, PickState::kReleased);
  EXPECT_LT((pickOf(id, kRight, 0) - before - aside).norm(), 1e-6);
}

TEST_P(CanvasGesture, DragsACopyIntoPlaceInOtherPictures) {
  const FeatureId first = add(1);
  rig.bench.history().push(session::addSnapshots(rig.document(), {tests::snapshotOf(3, rig.scene.left), tests::snapshotOf(4, rig.scene.right)}, kLeft));
  const auto copied = rig.targeting().copyToPictures(first);
  ASSERT_TRUE(copied.ok()) << copied.error().message;
  ASSERT_EQ(rig.document().items().size(), 2U);
  const FeatureId copy = rig.document().selection().primary;
  ASSERT_NE(copy, first);
  EXPECT_FALSE(rig.document().measurement(copy).feature);
  for (const PaneSide side : kBoth) {
    for (int vertex = 0; vertex < 2; ++vertex) {
      const Vector2d from = pickOf(copy, side, vertex);
      rig.drag(side, from, from + Vector2d(6 + 8 / GetParam(), 0));
      EXPECT_TRUE(rig.document().item(copy)->pick(rig.document().paneSnapshotId(side), vertex)->placed());
    }
  }
  EXPECT_TRUE(rig.document().measurement(copy).feature) << rig.document().measurement(copy).reason;
}

// Other places of the same edge: no curve holds the handles of a line whose ends differ.
TEST_P(CanvasGesture, DragsTheEndsOfAnEdgeToOtherPlacesOfIt) {
  const Vector3d a = rig.scene.a, b = a + 0.2 * rig.scene.left.X_WC.linear().col(1);
  rig.targeting().setTool(ToolKind::kLine);
  for (const PaneSide side : kBoth) rig.drag(side, rig.seen(side, a), rig.seen(side, b));
  ASSERT_EQ(rig.document().items().size(), 1U);
  const FeatureId id = rig.only().id;
  rig.targeting().select(id);
  rig.targeting().setEdge(id, true);
  const double places[2] = {0.4, 0.7};
  for (int vertex = 0; vertex < 2; ++vertex) {
    const Vector2d to = rig.seen(kRight, a + places[vertex] * (b - a));
    rig.drag(kRight, pickOf(id, kRight, vertex), to);
    EXPECT_LT((pickOf(id, kRight, vertex) - to).norm(), 0.3 + 1 / GetParam()) << "free of the curve";
  }
  const auto& feature = rig.measured().feature;
  ASSERT_TRUE(feature) << rig.measured().reason;
  const Vector3d along = (b - a).normalized(), off = feature->vertices[0].xyz - a;
  EXPECT_LT((off - off.dot(along) * along).norm(), 0.004);
  EXPECT_LT(std::acos(std::min(1.0, std::abs(feature->direction().dot(along)))), 0.1);
}

TEST_P(CanvasGesture, DragsAWholeFeatureAndEscTakesItBack) {
  const FeatureId id = add(1);
  const Vector2d a = pickOf(id, kLeft, 0), b = pickOf(id, kLeft, 1), by(12, -9 - 4 / GetParam());
  rig.drag(kLeft, (a + b) / 2, (a + b) / 2 + by);
  EXPECT_LT((pickOf(id, kLeft, 0) - a - by).norm(), 1e-6);
  EXPECT_LT((pickOf(id, kLeft, 1) - b - by).norm(), 1e-6);
  const auto done = rig.document().state();
  auto* canvas = rig.canvas(kLeft);
  const QPointF from = rig.on(kLeft, (a + b) / 2 + by), to = from + QPointF(30, 30);
  rig.hand.press(canvas, from);
  rig.hand.dragTo(canvas, to);
  EXPECT_FALSE(rig.targeting().canUndo()) << "a drag is going on";
  rig.key(kLeft, Qt::Key_Escape);
  rig.hand.release(canvas, to);
  EXPECT_EQ(rig.document().state(), done);
}

// Before the button is let go both members are drawn where they will be, in both pictures; the document waits.
TEST_P(CanvasGesture, DragsAGroupWhoseMembersAllFollowLive) {
  const FeatureId first = add(1), second = add(2, {0, 50});
  rig.bench.history().push(session::groupItems(rig.document(), {first, second}, true));
  const auto before = rig.document().state();
  auto* canvas = rig.canvas(kLeft);
  const Vector2d middle = (pickOf(first, kLeft, 0) + pickOf(first, kLeft, 1)) / 2, by(14, -8 - 4 / GetParam());
  rig.hand.press(canvas, rig.on(kLeft, middle));
  const QPointF to = rig.on(kLeft, middle + by);
  rig.hand.dragTo(canvas, to);
  EXPECT_EQ(rig.document().state(), before);
  std::vector<Vector2d> followed;
  for (const FeatureId id : {first, second}) {
    for (int vertex = 0; vertex < 2; ++vertex) {
      EXPECT_TRUE(drawnAt(kLeft, pickOf(id, kLeft, vertex) + by)) << "feature " << id.value;
      EXPECT_FALSE(drawnAt(kRight, pickOf(id, kRight, vertex))) << "its picks on the curve follow, feature " << id.value;
    }
  }
  rig.hand.release(canvas, to);
  for (const FeatureId id : {first, second}) {
    for (int vertex = 0; vertex < 2; ++vertex) {
      EXPECT_TRUE(drawnAt(kRight, pickOf(id, kRight, vertex)));
      EXPECT_LT((pickOf(id, kLeft, vertex) - before.items[id.value - 1].pick({1}, vertex)->pixel - by).norm(), 1e-6);
    }
  }
  rig.targeting().undo();
  EXPECT_EQ(rig.document().state(), before) << "one step";
}

TEST_P(CanvasGesture, DragsWhatIsSelectedTogetherAndWithAltAlone) {
  const FeatureId first = add(1), second = add(2, {0, 50});
  rig.targeting().select({{first, second}, first});
  const Vector2d middle = (pickOf(first, kLeft, 0) + pickOf(first, kLeft, 1)) / 2, other = pickOf(second, kLeft, 0), by(20, -10 - 4 / GetParam());
  rig.drag(kLeft, middle, middle + by);
  EXPECT_LT((pickOf(second, kLeft, 0) - other - by).norm(), 1e-6);
  rig.drag(kLeft, middle + by, middle, Qt::AltModifier);
  EXPECT_LT((pickOf(second, kLeft, 0) - other - by).norm(), 1e-6) << "left where it was";
}

TEST_P(CanvasGesture, SelectsWithAFrame) {
  const FeatureId first = add(1), second = add(2, {0, 100});
  add(3, {0, -140});
  rig.targeting().select(FeatureId{});
  const Vector2d a = pickOf(first, kLeft, 0);
  rig.drag(kLeft, a + Vector2d(-70, -60), a + Vector2d(40, 130));
  EXPECT_EQ(rig.document().selection().items, (std::set<FeatureId>{first, second}));
  rig.drag(kLeft, a + Vector2d(-70, -60), a + Vector2d(-45, -35));
  EXPECT_TRUE(rig.document().selection().items.empty());
}

TEST_P(CanvasGesture, MeasuresADistanceAndAnAngle) {
  const FeatureId first = add(1), second = add(2, {0, 60});
  rig.targeting().setTool(ToolKind::kMeasure);
  rig.click(kLeft, pickOf(first, kLeft, 0));
  rig.click(kRight, pickOf(first, kRight, 1));
  EXPECT_TRUE(rig.targeting().hint().startsWith(QStringLiteral("Distance "))) << rig.targeting().hint().toStdString();
  rig.click(kLeft, pickOf(second, kLeft, 1));
  EXPECT_TRUE(rig.targeting().hint().startsWith(QStringLiteral("Angle "))) << rig.targeting().hint().toStdString();
  rig.key(kLeft, Qt::Key_Escape);
  rig.key(kLeft, Qt::Key_Escape);
  EXPECT_EQ(rig.targeting().tool(), ToolKind::kSelect);
}

TEST_P(CanvasGesture, NudgesByATenthOfAPixelAtAnyZoom) {
  const FeatureId id = add(1);
  rig.click(kLeft, pickOf(id, kLeft, 0));
  const Vector2d before = pickOf(id, kLeft, 0);
  rig.key(kLeft, Qt::Key_Right);
  EXPECT_NEAR(pickOf(id, kLeft, 0).x(), before.x() + 0.1, 1e-9);
  rig.key(kLeft, Qt::Key_Up, Qt::ShiftModifier);
  EXPECT_NEAR(pickOf(id, kLeft, 0).y(), before.y() - 1, 1e-9);
  rig.targeting().undo();
  EXPECT_EQ(pickOf(id, kLeft, 0), before) << "nudges in a row are one step";
}

TEST_P(CanvasGesture, DeletesWhatIsSelectedWithTheKey) {
  const FeatureId id = add(1);
  rig.click(kLeft, pickOf(id, kLeft, 0));
  rig.key(kLeft, Qt::Key_Delete);
  EXPECT_TRUE(rig.document().items().empty());
}

TEST_P(CanvasGesture, OpensTheMenuOfWhatLiesUnderTheRightButton) {
  const FeatureId id = add(1);
  rig.targeting().select(FeatureId{});
  QWidget window;
  SketchEdits edits(rig.bench, rig.actions, &window);
  QObject::connect(&rig.left, &SnapshotPane::menuRequested, &edits, [&](const QPoint& at) { edits.showMenu(rig.left, at); });
  const auto open = [&](const Vector2d& pixel) -> QMenu* {
    rig.hand.click(rig.canvas(kLeft), rig.on(kLeft, pixel), Qt::RightButton);
    return qobject_cast<QMenu*>(QApplication::activePopupWidget());
  };
  QMenu* menu = open(pickOf(id, kLeft, 0));
  ASSERT_NE(menu, nullptr);
  EXPECT_TRUE(menu->actions().contains(rig.actions.at(ActionId::kRename)));
  EXPECT_TRUE(rig.document().selection().contains(id)) << "what was clicked is what the menu is about";
  menu->close();
  menu = open({20, 20});
  ASSERT_NE(menu, nullptr);
  EXPECT_TRUE(menu->actions().contains(rig.actions.at(ActionId::kToolLine)));
  EXPECT_FALSE(menu->actions().contains(rig.actions.at(ActionId::kRename)));
  menu->close();
}

/// A checkerboard in the left picture, with a corner where line end a is seen.
class CanvasSnap : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Zooms, CanvasSnap, ::testing::ValuesIn(tests::kZooms));

TEST_P(CanvasSnap, DrawsAHandleToACornerWithShiftOnly) {
  CanvasRig rig(GetParam());
  const Vector2d corner(251.3, 207.8);
  auto board = std::make_shared<vision::Snapshot>(*tests::snapshotOf(1, rig.scene.left));
  board->image = tests::checkerPicture(corner);
  rig.open(board, tests::snapshotOf(2, rig.scene.right));
  const Vector2d near = corner + Vector2d(2.6, -1.9);
  rig.targeting().setTool(ToolKind::kPoint);
  rig.click(kLeft, near);
  EXPECT_LT((rig.pick(kLeft) - near).norm(), 1e-6) << "not asked for";
  rig.targeting().undo();
  rig.click(kLeft, near, Qt::ShiftModifier);
  EXPECT_LT((rig.pick(kLeft) - corner).norm(), 0.15);
  rig.targeting().undo();
  rig.drag(kLeft, {60, 60}, near, Qt::ShiftModifier);
  EXPECT_LT((rig.pick(kLeft) - corner).norm(), 0.15);
  // The other way round where the operator wants it so.
  rig.targeting().undo();
  rig.targeting().pictures()->setSnapping(true);
  rig.click(kLeft, near);
  EXPECT_LT((rig.pick(kLeft) - corner).norm(), 0.15);
  rig.targeting().undo();
  rig.click(kLeft, near, Qt::ShiftModifier);
  EXPECT_LT((rig.pick(kLeft) - near).norm(), 1e-6) << "held for none";
}

}  // namespace
}  // namespace longarm::ui
