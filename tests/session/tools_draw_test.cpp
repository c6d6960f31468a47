// Point and line tools: whole gestures on two synthetic cameras, measured against the truth.
#include <gtest/gtest.h>

#include "session/tools/line_tool.h"
#include "session/tools/point_tool.h"
#include "tests/session/synthetic_views.h"
#include "vision/stereo/epipolar.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::Hand;
using vision::OverlayRole;
using vision::SketchKey;

// The right handle stands on a polyline whose chords deviate 0.02 px from the curve: 0.4 mm in depth at 1.6 m.
constexpr double kOnCurve_m = 5e-4;

const SketchItem& only(const Bench& bench) {
  EXPECT_EQ(bench.document.items().size(), 1u);
  return bench.document.items().front();
}

Eigen::Vector2d handleAt(const Bench& bench, PaneSide side, int vertex) {
  const SketchPick* pick = nullptr;
  const vision::Overlay overlay = bench.tools.overlay(side);
  if (!bench.document.items().empty()) pick = bench.document.items().back().pick(bench.snapshot(side), vertex);
  if (pick != nullptr) return pick->pixel;
  // The tool's own copy: dashed markers in vertex order, the active one among them.
  std::vector<Eigen::Vector2d> markers;
  for (const auto& shape : overlay.shapes) {
    const bool handle = shape.role == OverlayRole::kUnplaced || shape.role == OverlayRole::kActiveHandle;
    if (shape.kind == vision::OverlayShape::Kind::kMarker && handle) markers.push_back(shape.points[0]);
  }
  return markers.at(static_cast<std::size_t>(vertex));
}

void expectTrueLine(const Bench& bench) {
  const auto& measured = bench.document.measurement(only(bench).id);
  ASSERT_TRUE(measured.feature) << measured.reason;
  const auto& vertices = measured.feature->vertices;
  EXPECT_NEAR((vertices[0].xyz - bench.scene.a).norm(), 0, kOnCurve_m);
  EXPECT_NEAR((vertices[1].xyz - bench.scene.b).norm(), 0, kOnCurve_m);
  EXPECT_NEAR(measured.feature->length(), (bench.scene.a - bench.scene.b).norm(), kOnCurve_m);
}

int countRole(const vision::Overlay& overlay, OverlayRole role) {
  int count = 0;
  for (const auto& shape : overlay.shapes) count += shape.role == role ? 1 : 0;
  return count;
}

TEST(LineTool, PlacesADashedCopyInBothPicturesAndWritesNothing) {
  Bench bench;
  const DocumentState before = bench.document.state();
  bench.tools.setTool(ToolKind::kLine);
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    const auto overlay = bench.tools.overlay(side);
    EXPECT_GE(countRole(overlay, OverlayRole::kUnplaced), 2) << "an edge and its handles";
    for (int vertex = 0; vertex < 2; ++vertex) {
      const Eigen::Vector2d at = handleAt(bench, side, vertex);
      EXPECT_NEAR(at.y(), tests::kHeight / 2.0, 2);
      EXPECT_GT(at.x(), 0.3 * tests::kWidth);
      EXPECT_LT(at.x(), 0.7 * tests::kWidth);
    }
  }
  EXPECT_EQ(bench.document.state(), before);
  EXPECT_FALSE(bench.history.canUndo());
}

/// Zoom of the canvas, the pane that is marked first, and how: drag the handles, click, or one stroke per picture.
enum class Manner { kDrag, kClick, kStroke };
using Case = std::tuple<double, PaneSide, Manner>;

class LineGesture : public testing::TestWithParam<Case> {};

TEST_P(LineGesture, MeasuresTheTrueLineInOneStepPerGesture) {
  const auto [zoom, first, manner] = GetParam();
  Bench bench;
  Hand hand(bench.tools, zoom);
  bench.tools.setTool(ToolKind::kLine);
  std::size_t gestures = 0;
  for (const PaneSide side : {first, otherSide(first)}) {
    const Eigen::Vector2d a = bench.scene.pixel(side, bench.scene.a), b = bench.scene.pixel(side, bench.scene.b);
    if (manner == Manner::kStroke) {
      hand.drag(side, a, b);
      gestures += 1;
    } else {
      for (int vertex = 0; vertex < 2; ++vertex) {
        const Eigen::Vector2d to = vertex == 0 ? a : b;
        if (manner == Manner::kClick) hand.click(side, to);
        else hand.drag(side, handleAt(bench, side, vertex), to);
      }
      gestures += 2;
    }
    EXPECT_EQ(bench.history.size(), gestures) << "one gesture is one command";
  }
  expectTrueLine(bench);
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect) << "finished";
  EXPECT_TRUE(bench.document.selection().contains(only(bench).id));
  for (int vertex = 0; vertex < 2; ++vertex) {
    EXPECT_EQ(only(bench).pick(bench.snapshot(first), vertex)->state, PickState::kFree);
    EXPECT_EQ(only(bench).pick(bench.snapshot(otherSide(first)), vertex)->state, PickState::kConstrained);
  }
  const DocumentState done = bench.document.state();
  while (bench.history.canUndo()) bench.history.undo();
  EXPECT_TRUE(bench.document.items().empty());
  while (bench.history.canRedo()) bench.history.redo();
  EXPECT_EQ(bench.document.state(), done);
}

INSTANTIATE_TEST_SUITE_P(AtAnyZoomEitherPaneFirstInAnyManner, LineGesture,
                         testing::Combine(testing::Values(0.25, 1.0, 4.0),
                                          testing::Values(PaneSide::kLeft, PaneSide::kRight),
                                          testing::Values(Manner::kDrag, Manner::kClick, Manner::kStroke)));

TEST(PointTool, MeasuresAPointWithTwoClicks) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.click(PaneSide::kRight, bench.scene.pixel(PaneSide::kRight, bench.scene.a));
  EXPECT_EQ(bench.tools.tool(), ToolKind::kPoint);
  hand.click(PaneSide::kLeft, bench.scene.pixel(PaneSide::kLeft, bench.scene.a));
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect);
  const auto& measured = bench.document.measurement(only(bench).id);
  ASSERT_TRUE(measured.feature) << measured.reason;
  EXPECT_NEAR((measured.feature->vertices[0].xyz - bench.scene.a).norm(), 0, kOnCurve_m);
}

TEST(LineTool, SlidesTheSecondHandleAlongTheEpipolarCurve) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  const Eigen::Vector2d a = bench.scene.pixel(PaneSide::kLeft, bench.scene.a);
  hand.drag(PaneSide::kLeft, handleAt(bench, PaneSide::kLeft, 0), a);
  hand.press(PaneSide::kRight, handleAt(bench, PaneSide::kRight, 0));
  // Asked for 40 px beside the curve: held on it, and the numbers say both.
  const Eigen::Vector2d wanted = bench.scene.pixel(PaneSide::kRight, bench.scene.a) + Eigen::Vector2d(0, 40);
  hand.moveTo(wanted);
  const auto live = bench.tools.liveMeasure();
  ASSERT_TRUE(live);
  EXPECT_TRUE(live->on_curve);
  EXPECT_FALSE(live->released);
  EXPECT_NEAR((live->raw - wanted).norm(), 0, 0.5) << "grabbed at the handle itself";
  EXPECT_GT((live->raw - live->constrained).norm(), 30);
  const auto curve = vision::epipolarCurve(bench.scene.left, a, bench.scene.right).value();
  EXPECT_NEAR((curve.nearest(live->constrained)->pixel - live->constrained).norm(), 0, 1e-9);
  ASSERT_TRUE(live->xyz) << live->reason;
  EXPECT_LT(live->miss, 1e-3) << "on the curve the rays meet";
  EXPECT_GE(countRole(bench.tools.overlay(PaneSide::kRight), OverlayRole::kEpipolar), 1);
  EXPECT_GE(countRole(bench.tools.overlay(PaneSide::kRight), OverlayRole::kDepthTick), 1);
}

TEST(LineTool, LetsGoOfTheCurveWhileControlIsHeldAndShowsTheMiss) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.click(PaneSide::kLeft, bench.scene.pixel(PaneSide::kLeft, bench.scene.a));
  const Eigen::Vector2d truth = bench.scene.pixel(PaneSide::kRight, bench.scene.a);
  hand.press(PaneSide::kRight, handleAt(bench, PaneSide::kRight, 0));
  hand.modifiers.control = true;
  hand.moveTo(truth + Eigen::Vector2d(0, 4));
  const auto live = bench.tools.liveMeasure();
  ASSERT_TRUE(live && live->xyz);
  EXPECT_TRUE(live->released);
  EXPECT_FALSE(live->on_curve);
  // 4 px across the curve at 1.5 m with f = 740: the rays pass each other by 4 / 740 * 1.5 m = 8.1 mm.
  EXPECT_NEAR(live->miss, 0.0081, 0.0008);
  EXPECT_NE(bench.tools.hint().find("Off the epipolar curve"), std::string::npos);
  bool shown = false;
  for (const auto& shape : bench.tools.overlay(PaneSide::kRight).shapes) {
    shown |= shape.role == OverlayRole::kMiss && shape.text.rfind("miss 8.", 0) == 0;
  }
  EXPECT_TRUE(shown) << "the miss distance in mm beside the handle";
  // Letting go of the key in mid-drag returns to the curve.
  hand.modifiers.control = false;
  hand.moveTo(truth + Eigen::Vector2d(0, 4), 1);
  EXPECT_TRUE(bench.tools.liveMeasure()->on_curve);
  EXPECT_LT(bench.tools.liveMeasure()->miss, 1e-3);
  hand.modifiers.control = true;
  hand.moveTo(truth + Eigen::Vector2d(0, 4), 1);
  hand.release();
  EXPECT_EQ(only(bench).pick({2}, 0)->state, PickState::kReleased);
  EXPECT_NEAR(bench.document.measurement(only(bench).id).feature->vertices[0].miss_m, 0.0081, 0.0008);
}

TEST(LineTool, CarriesLiveNumbersThatMeetTheTruth) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  hand.drag(PaneSide::kLeft, bench.scene.pixel(PaneSide::kLeft, bench.scene.a), bench.scene.pixel(PaneSide::kLeft, bench.scene.b));
  hand.click(PaneSide::kRight, bench.scene.pixel(PaneSide::kRight, bench.scene.a));
  hand.press(PaneSide::kRight, handleAt(bench, PaneSide::kRight, 1));
  hand.moveTo(bench.scene.pixel(PaneSide::kRight, bench.scene.b));
  const auto live = bench.tools.liveMeasure();
  ASSERT_TRUE(live && live->xyz && live->length && live->depth);
  EXPECT_NEAR((*live->xyz - bench.scene.b).norm(), 0, kOnCurve_m);
  EXPECT_NEAR(*live->length, (bench.scene.a - bench.scene.b).norm(), kOnCurve_m);
  EXPECT_GT(*live->length_plus_minus, 0);
  EXPECT_NEAR(*live->depth, (bench.scene.left.X_WC.inverse() * bench.scene.b).z(), kOnCurve_m);
  EXPECT_GT(live->plus_minus, 0.005);
  EXPECT_NE(live->text().find("length 3"), std::string::npos) << live->text();
  EXPECT_EQ(bench.document.item(only(bench).id)->pick({2}, 1)->state, PickState::kUnplaced)
      << "while dragging only the preview changes";
}

TEST(LineTool, FollowsWithTheSecondPickWhenTheFirstIsMovedAgain) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.click(PaneSide::kLeft, bench.scene.pixel(PaneSide::kLeft, bench.scene.a) + Eigen::Vector2d(0, 5));
  hand.click(PaneSide::kRight, bench.scene.pixel(PaneSide::kRight, bench.scene.a));
  const FeatureId id = only(bench).id;
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect);
  hand.drag(PaneSide::kLeft, handleAt(bench, PaneSide::kLeft, 0), bench.scene.pixel(PaneSide::kLeft, bench.scene.a));
  const SketchPick* right = bench.document.item(id)->pick({2}, 0);
  EXPECT_EQ(right->state, PickState::kConstrained);
  EXPECT_NEAR((right->pixel - bench.scene.pixel(PaneSide::kRight, bench.scene.a)).norm(), 0, 0.5);
  EXPECT_LT(bench.document.measurement(id).feature->vertices[0].miss_m, 1e-3);
  bench.history.undo();
  EXPECT_EQ(bench.document.item(id)->pick({1}, 0)->pixel, bench.scene.pixel(PaneSide::kLeft, bench.scene.a) + Eigen::Vector2d(0, 5))
      << "both picks are one step";
}

TEST(LineTool, CancelsADragBitForBitAndReturnsToSelectOnTheSecondEsc) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  hand.click(PaneSide::kLeft, {200, 200});
  const DocumentState before = bench.document.state();
  const std::size_t steps = bench.history.size();
  hand.press(PaneSide::kLeft, {200, 200});
  hand.moveTo({333.3, 111.1});
  EXPECT_TRUE(bench.tools.busy());
  hand.key(SketchKey::kEscape);
  EXPECT_EQ(bench.document.state(), before);
  EXPECT_EQ(hashOf(bench.document.state()), hashOf(before));
  EXPECT_EQ(bench.tools.tool(), ToolKind::kLine);
  EXPECT_FALSE(bench.tools.busy());
  hand.moveTo({10, 10});
  hand.release();
  EXPECT_EQ(bench.document.state(), before) << "the rest of the gesture does nothing";
  EXPECT_EQ(bench.history.size(), steps);
  hand.key(SketchKey::kEscape);
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect);
  EXPECT_EQ(bench.document.state(), before);
}

TEST(LineTool, NudgesATenthOfAPixelAndAWholeOneWithShift) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  hand.click(PaneSide::kLeft, {200, 200});
  hand.key(SketchKey::kRight);
  EXPECT_NEAR(only(bench).pick({1}, 0)->pixel.x(), 200.1, 1e-12);
  hand.key(SketchKey::kUp);
  EXPECT_NEAR(only(bench).pick({1}, 0)->pixel.y(), 199.9, 1e-12);
  hand.modifiers.shift = true;
  hand.key(SketchKey::kLeft);
  hand.key(SketchKey::kDown);
  EXPECT_NEAR(only(bench).pick({1}, 0)->pixel.x(), 199.1, 1e-12);
  EXPECT_NEAR(only(bench).pick({1}, 0)->pixel.y(), 200.9, 1e-12);
  EXPECT_EQ(bench.history.size(), 2u) << "nudges in a row are one step";
}

TEST(LineTool, NudgesAlongTheCurveInTheSecondPicture) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  hand.click(PaneSide::kLeft, bench.scene.pixel(PaneSide::kLeft, bench.scene.a));
  hand.click(PaneSide::kRight, bench.scene.pixel(PaneSide::kRight, bench.scene.a));
  const Eigen::Vector2d before = only(bench).pick({2}, 0)->pixel;
  hand.modifiers.shift = true;
  hand.key(SketchKey::kRight);
  const Eigen::Vector2d after = only(bench).pick({2}, 0)->pixel;
  EXPECT_NEAR((after - before).norm(), 1, 1e-3);
  EXPECT_GT(after.x(), before.x());
  const auto curve = vision::epipolarCurve(bench.scene.left, only(bench).pick({1}, 0)->pixel, bench.scene.right).value();
  EXPECT_NEAR((curve.nearest(after)->pixel - after).norm(), 0, 1e-9);
  hand.key(SketchKey::kUp);
  EXPECT_NEAR((only(bench).pick({2}, 0)->pixel - after).norm(), 0, 1e-9) << "across the curve nothing moves";
  hand.modifiers.control = true;
  hand.key(SketchKey::kUp);
  EXPECT_NEAR((only(bench).pick({2}, 0)->pixel - (after + Eigen::Vector2d(0, -1))).norm(), 0, 1e-9) << "released";
}

TEST(LineTool, CyclesItsHandlesWithTab) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  std::vector<std::pair<PaneSide, int>> seen;
  for (int i = 0; i < 5; ++i) {
    seen.emplace_back(bench.tools.activeHandle().side, bench.tools.activeHandle().vertex);
    hand.key(SketchKey::kTab);
  }
  const std::vector<std::pair<PaneSide, int>> expected = {{PaneSide::kLeft, 0}, {PaneSide::kLeft, 1},
                                                          {PaneSide::kRight, 0}, {PaneSide::kRight, 1},
                                                          {PaneSide::kLeft, 0}};
  EXPECT_EQ(seen, expected);
}

TEST(LineTool, CanBePlacedWithTheKeysAlone) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  for (int i = 0; i < 8 && bench.tools.tool() == ToolKind::kLine; ++i) hand.key(SketchKey::kReturn);
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect);
  EXPECT_TRUE(only(bench).placedIn({1}) && only(bench).placedIn({2}));
}

TEST(LineTool, KeepsHandlesOnThePicture) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.drag(PaneSide::kLeft, handleAt(bench, PaneSide::kLeft, 0), {-500, 9000});
  EXPECT_EQ(only(bench).pick({1}, 0)->pixel, Eigen::Vector2d(0, 479));
}

TEST(LineTool, StartsAfreshWhenItsItemIsUndone) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  hand.click(PaneSide::kLeft, {200, 200});
  bench.history.undo();
  EXPECT_TRUE(bench.document.items().empty());
  hand.click(PaneSide::kLeft, {220, 210});
  EXPECT_EQ(only(bench).pick({1}, 0)->pixel, Eigen::Vector2d(220, 210));
  bench.history.undo();
  bench.history.redo();
  EXPECT_EQ(only(bench).name, "Line 1");
  hand.click(PaneSide::kLeft, {400, 250});
  EXPECT_TRUE(only(bench).placedIn({1}));
}

TEST(LineTool, ForgetsADragWhenItsPictureLeavesThePane) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.press(PaneSide::kLeft, handleAt(bench, PaneSide::kLeft, 0));
  hand.moveTo({100, 100});
  bench.history.push(showSnapshot(bench.document, PaneSide::kLeft, {2}));
  EXPECT_FALSE(bench.tools.busy());
  hand.release();
  EXPECT_TRUE(bench.document.items().empty());
}

TEST(LineTool, SaysWhatToDoInEveryState) {
  Bench empty(false);
  empty.tools.setTool(ToolKind::kLine);
  EXPECT_EQ(empty.tools.hint(), "Take a pair of snapshots first, then mark it in both.");
  Hand idle(empty.tools);
  EXPECT_FALSE(idle.click(PaneSide::kLeft, {10, 10})) << "without a picture the event is not the tool's";

  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kLine);
  EXPECT_NE(bench.tools.hint().find("end 1 in the left picture"), std::string::npos);
  hand.click(PaneSide::kLeft, {200, 200});
  EXPECT_NE(bench.tools.hint().find("end 2 in the left picture"), std::string::npos);
  hand.click(PaneSide::kLeft, {400, 250});
  EXPECT_NE(bench.tools.hint().find("Slide end 1 in the right picture"), std::string::npos);
  hand.press(PaneSide::kRight, handleAt(bench, PaneSide::kRight, 0));
  hand.moveTo({100, 200});
  EXPECT_NE(bench.tools.hint().find("Slides along the epipolar curve"), std::string::npos);
}

TEST(PointTool, AsksForASecondPictureWhenThereIsOnlyOne) {
  Bench bench(false);
  bench.history.push(addSnapshots(bench.document, {tests::snapshotOf(1, bench.scene.left)}));

  bench.tools.setTool(ToolKind::kPoint);
  Hand hand(bench.tools);
  EXPECT_FALSE(hand.click(PaneSide::kRight, {200, 200})) << "an empty pane is not the tool's";
  hand.click(PaneSide::kLeft, {200, 200});
  EXPECT_EQ(bench.tools.tool(), ToolKind::kPoint);
  EXPECT_NE(bench.tools.hint().find("second picture"), std::string::npos) << bench.tools.hint();
}

// The state table of draw_tool.h, row by row.
struct DrawRow {
  const char* what;
  std::function<void(DrawTool&)> before;
  std::function<ToolReply(DrawTool&)> event;
  DrawTool::State next;
  bool command, finished;
};

vision::PointerEvent at(vision::PointerPhase phase, double u, double v, PaneSide side = PaneSide::kLeft) {
  vision::PointerEvent event;
  event.phase = phase;
  event.pixel = {u, v};
  event.side = side;
  event.left = phase != vision::PointerPhase::kHover;
  return event;
}

TEST(DrawTool, FollowsItsTable) {
  using State = DrawTool::State;
  using vision::PointerPhase;
  const auto press = [](DrawTool& tool) { tool.onPointer(at(PointerPhase::kPress, 100, 100)); };
  const auto press_handle = [](DrawTool& tool) { tool.onPointer(at(PointerPhase::kPress, 0.35 * 639, 0.5 * 479)); };
  const auto press_body = [](DrawTool& tool) { tool.onPointer(at(PointerPhase::kPress, 0.5 * 639, 0.5 * 479)); };
  const auto nothing = [](DrawTool&) {};
  const auto drag = [](DrawTool& tool) { return tool.onPointer(at(PointerPhase::kDrag, 300, 300)); };
  const auto release = [](DrawTool& tool) { return tool.onPointer(at(PointerPhase::kRelease, 300, 300)); };
  const auto key = [](SketchKey k) { return [k](DrawTool& tool) { return tool.onKey(k, {}); }; };
  const auto dragging = [&](DrawTool& tool) {
    press(tool);
    drag(tool);
  };
  const std::vector<DrawRow> rows = {
      {"press", nothing, [](DrawTool& t) { return t.onPointer(at(PointerPhase::kPress, 100, 100)); }, State::kGrabbed, false, false},
      {"click", press, release, State::kPlacing, true, false},
      {"drag on a handle", press_handle, drag, State::kDragging, false, false},
      {"drag on the unplaced body", press_body, drag, State::kDragging, false, false},
      {"stroke", press, drag, State::kDragging, false, false},
      {"drag on", dragging, drag, State::kDragging, false, false},
      {"drag ends", dragging, release, State::kPlacing, true, false},
      {"Esc in a drag", dragging, key(SketchKey::kEscape), State::kPlacing, false, false},
      {"Esc after a press", press, key(SketchKey::kEscape), State::kPlacing, false, false},
      {"Esc", nothing, key(SketchKey::kEscape), State::kPlacing, false, true},
      {"arrow", nothing, key(SketchKey::kLeft), State::kPlacing, true, false},
      {"arrow in a drag", dragging, key(SketchKey::kLeft), State::kDragging, false, false},
      {"Return", nothing, key(SketchKey::kReturn), State::kPlacing, true, false},
      {"Tab", nothing, key(SketchKey::kTab), State::kPlacing, false, false},
      {"Delete, nothing added yet", nothing, key(SketchKey::kDelete), State::kPlacing, false, false},
      {"hover", nothing, [](DrawTool& t) { return t.onPointer(at(PointerPhase::kHover, 9, 9)); }, State::kPlacing, false, false},
  };
  for (const auto& row : rows) {
    Bench bench;
    LineTool tool;
    tool.activate(bench.document);
    ASSERT_EQ(tool.state(), State::kPlacing);
    row.before(tool);
    const ToolReply reply = row.event(tool);
    EXPECT_EQ(tool.state(), row.next) << row.what;
    EXPECT_EQ(reply.command != nullptr, row.command) << row.what;
    EXPECT_EQ(reply.finished, row.finished) << row.what;
  }
}

TEST(DrawTool, WaitsForAPictureAndTakesTheFirstThatComes) {
  Bench bench(false);
  LineTool tool;
  tool.activate(bench.document);
  EXPECT_EQ(tool.state(), DrawTool::State::kNoPicture);
  EXPECT_TRUE(tool.drafts().empty());
  EXPECT_FALSE(tool.onKey(SketchKey::kReturn, {}).consumed);
  EXPECT_TRUE(tool.onKey(SketchKey::kEscape, {}).finished);
  bench.history.push(addSnapshots(bench.document, {tests::snapshotOf(1, bench.scene.left)}));
  tool.documentChanged();
  EXPECT_EQ(tool.state(), DrawTool::State::kPlacing);
  EXPECT_EQ(tool.drafts().size(), 1u);
}

}  // namespace
}  // namespace longarm::session
