// The select tool, and what every tool promises.
#include <random>

#include <gtest/gtest.h>

#include "session/tools/select_tool.h"
#include "tests/session/synthetic_views.h"
#include "vision/stereo/epipolar.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::Hand;
using tests::trueLine;
using vision::SketchKey;

constexpr PaneSide kLeft = PaneSide::kLeft, kRight = PaneSide::kRight;

class SelectGesture : public testing::TestWithParam<double> {
 protected:
  SelectGesture() : hand(bench.tools, GetParam()) {
    bench.history.push(addItem(trueLine(bench, 1)));
    bench.document.select({});
  }
  Eigen::Vector2d pick(PaneSide side, int vertex) const {
    return bench.document.item({1})->pick(bench.snapshot(side), vertex)->pixel;
  }
  Bench bench;
  Hand hand;
};

TEST_P(SelectGesture, PicksWithinEightScreenPixels) {
  const double zoom = GetParam();
  hand.click(kLeft, pick(kLeft, 0) + Eigen::Vector2d(0, -7.9 / zoom));
  EXPECT_TRUE(bench.document.selection().contains({1}));
  hand.click(kLeft, pick(kLeft, 0) + Eigen::Vector2d(-8.1 / zoom, 0));
  EXPECT_FALSE(bench.document.selection().contains({1})) << "a click on nothing selects nothing";
  hand.click(kRight, 0.5 * (pick(kRight, 0) + pick(kRight, 1)) + Eigen::Vector2d(0, 3 / zoom));
  EXPECT_TRUE(bench.document.selection().contains({1})) << "by its body, in the other picture";
}

TEST_P(SelectGesture, SlidesAConstrainedHandleAlongItsCurve) {
  const Eigen::Vector2d before = pick(kRight, 0);
  hand.drag(kRight, before, before + Eigen::Vector2d(20 / GetParam() + 10, 30));
  const Eigen::Vector2d after = pick(kRight, 0);
  EXPECT_NE(after, before);
  const auto curve = vision::epipolarCurve(bench.scene.left, pick(kLeft, 0), bench.scene.right).value();
  EXPECT_NEAR((curve.nearest(after)->pixel - after).norm(), 0, 1e-9);
  EXPECT_EQ(bench.history.size(), 2u);
  bench.history.undo();
  EXPECT_EQ(pick(kRight, 0), before);
}

TEST_P(SelectGesture, MovesTheWholeFeatureByItsBody) {
  const Eigen::Vector2d a = pick(kLeft, 0), b = pick(kLeft, 1), travel(12 / GetParam() + 8, -6 / GetParam() - 9);
  hand.drag(kLeft, 0.5 * (a + b), 0.5 * (a + b) + travel);
  EXPECT_NEAR((pick(kLeft, 0) - (a + travel)).norm(), 0, 1e-9);
  EXPECT_NEAR((pick(kLeft, 1) - (b + travel)).norm(), 0, 1e-9);
  EXPECT_EQ(bench.history.undoLabel(), "Move line 'Line 1'");
  for (int vertex = 0; vertex < 2; ++vertex) {
    const auto curve = vision::epipolarCurve(bench.scene.left, pick(kLeft, vertex), bench.scene.right).value();
    EXPECT_NEAR((curve.nearest(pick(kRight, vertex))->pixel - pick(kRight, vertex)).norm(), 0, 1e-9)
        << "the picks that were slid along the curve follow";
  }
}

TEST_P(SelectGesture, CancelsADragBitForBit) {
  const DocumentState before = bench.document.state();
  hand.press(kLeft, pick(kLeft, 1));
  hand.moveTo({123.4, 321.1});
  EXPECT_TRUE(bench.tools.busy());
  hand.key(SketchKey::kEscape);
  hand.release();
  EXPECT_EQ(bench.document.state(), before);
  EXPECT_EQ(hashOf(bench.document.state()), hashOf(before));
  EXPECT_EQ(bench.history.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(AtAnyZoom, SelectGesture, testing::Values(0.25, 1.0, 4.0));

TEST(SelectTool, AddsWithShiftAndTogglesWithControl) {
  Bench bench;
  Hand hand(bench.tools);
  SketchItem point;
  point.id = {2};
  point.name = "Point 1";
  point.setPick({1}, 0, {{50, 50}, PickState::kFree});
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(addItem(point));
  hand.click(kLeft, {50, 50});
  hand.modifiers.shift = true;
  hand.click(kLeft, bench.scene.pixel(kLeft, bench.scene.a));
  EXPECT_EQ(bench.document.selection().items.size(), 2u);
  EXPECT_EQ(bench.document.selection().primary, FeatureId{1});
  hand.click(kLeft, {600, 20});
  EXPECT_EQ(bench.document.selection().items.size(), 2u) << "Shift keeps what is selected";
  hand.modifiers = {};
  hand.modifiers.control = true;
  hand.click(kLeft, {50, 50});
  EXPECT_FALSE(bench.document.selection().contains({2}));
}

TEST(SelectTool, PrefersHandlesAndWhatIsSelected) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(addItem(trueLine(bench, 2, "Line 2")));
  bench.document.select(Selection::of({2}));
  hand.click(kLeft, bench.scene.pixel(kLeft, bench.scene.a));
  EXPECT_TRUE(bench.document.selection().contains({2}));
  EXPECT_EQ(bench.tools.activeHandle().vertex, 0);
  bench.document.select(Selection::of({1}));
  hand.click(kLeft, bench.scene.pixel(kLeft, bench.scene.b));
  EXPECT_TRUE(bench.document.selection().contains({1}));
  EXPECT_EQ(bench.tools.activeHandle().vertex, 1);
}

TEST(SelectTool, DoesNotSeeHiddenFeatures) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(hideItem(bench.document, {1}, true));
  bench.document.select({});
  EXPECT_FALSE(hand.press(kLeft, bench.scene.pixel(kLeft, bench.scene.a))) << "not consumed: the canvas may pan";
  hand.release();
  EXPECT_TRUE(bench.document.selection().items.empty());
}

TEST(SelectTool, SelectsALockedFeatureButDoesNotMoveOrDeleteIt) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(lockItem(bench.document, {1}, true));
  const DocumentState before = bench.document.state();
  const Eigen::Vector2d a = bench.scene.pixel(kLeft, bench.scene.a);
  hand.drag(kLeft, a, {100, 100});
  EXPECT_NE(bench.tools.hint().find("'Line 1' is locked"), std::string::npos);
  hand.click(kLeft, a);
  hand.key(SketchKey::kLeft);
  hand.key(SketchKey::kDelete);
  EXPECT_EQ(bench.document.state(), before);
  EXPECT_TRUE(bench.document.selection().contains({1}));
}

TEST(SelectTool, DeletesWhatIsSelectedAsOneStep) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(addItem(trueLine(bench, 2, "Line 2")));
  bench.document.select({{{1}, {2}}, {1}});
  hand.key(SketchKey::kDelete);
  EXPECT_TRUE(bench.document.items().empty());
  EXPECT_EQ(bench.history.undoLabel(), "Delete 2 features");
  bench.history.undo();
  EXPECT_EQ(bench.document.items().size(), 2u);
  EXPECT_EQ(bench.document.selection().items.size(), 2u) << "what comes back is selected as it was";
}

TEST(SelectTool, WalksTheHandlesWithTabAndNudgesThem) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  hand.key(SketchKey::kTab);
  EXPECT_EQ(bench.tools.activeHandle().side, kLeft);
  EXPECT_EQ(bench.tools.activeHandle().vertex, 0);
  const double before = bench.document.item({1})->pick({1}, 0)->pixel.x();
  for (int i = 0; i < 10; ++i) hand.key(SketchKey::kRight);
  EXPECT_NEAR(bench.document.item({1})->pick({1}, 0)->pixel.x(), before + 1, 1e-9);
  EXPECT_EQ(bench.history.size(), 2u);
  hand.modifiers.shift = true;
  hand.key(SketchKey::kTab);
  EXPECT_EQ(bench.tools.activeHandle().side, kRight);
  EXPECT_EQ(bench.tools.activeHandle().vertex, 1);
}

TEST(SelectTool, KeepsTheHandleOfTheToolBefore) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.click(kLeft, bench.scene.pixel(kLeft, bench.scene.a));
  hand.click(kRight, bench.scene.pixel(kRight, bench.scene.a));
  ASSERT_EQ(bench.tools.tool(), ToolKind::kSelect);
  const Eigen::Vector2d before = bench.document.items()[0].pick({2}, 0)->pixel;
  hand.modifiers.shift = true;
  hand.key(SketchKey::kLeft);
  EXPECT_NEAR((bench.document.items()[0].pick({2}, 0)->pixel - before).norm(), 1, 1e-3);
}

TEST(SelectTool, LetsGoOfAHandleThatIsDeletedUnderIt) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  hand.press(kLeft, bench.scene.pixel(kLeft, bench.scene.a));
  hand.moveTo({100, 100});
  bench.history.push(removeItems(bench.document, {{1}}));
  EXPECT_FALSE(bench.tools.busy());
  EXPECT_FALSE(bench.tools.activeHandle().valid());
  hand.moveTo({120, 100});
  hand.release();
  EXPECT_TRUE(bench.document.items().empty());
  EXPECT_FALSE(bench.tools.liveMeasure());
}

TEST(SelectTool, SelectsNothingOnEscAndLeavesTheSecondEscAlone) {
  Bench bench;
  Hand hand(bench.tools);
  bench.history.push(addItem(trueLine(bench, 1)));
  EXPECT_TRUE(hand.key(SketchKey::kEscape));
  EXPECT_TRUE(bench.document.selection().items.empty());
  EXPECT_FALSE(hand.key(SketchKey::kEscape));
}

// The state table of select_tool.h, row by row.
TEST(SelectTool, FollowsItsTable) {
  using State = SelectTool::State;
  using vision::PointerPhase;
  struct Row {
    const char* what;
    int presses_on;                                    // -1 nowhere yet, 0 nothing, 1 handle
    bool dragging;
    std::function<ToolReply(SelectTool&)> event;
    State next;
    bool command, selection, consumed;
  };
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const Eigen::Vector2d handle = bench.scene.pixel(kLeft, bench.scene.a);
  const auto send = [&](SelectTool& tool, PointerPhase phase, const Eigen::Vector2d& pixel) {
    vision::PointerEvent event;
    event.phase = phase;
    event.pixel = pixel;
    event.left = phase != PointerPhase::kHover;
    return tool.onPointer(event);
  };
  const auto pointer = [&](PointerPhase phase, Eigen::Vector2d pixel) {
    return [=](SelectTool& tool) { return send(tool, phase, pixel); };
  };
  const auto key = [](SketchKey k) { return [k](SelectTool& tool) { return tool.onKey(k, {}); }; };
  const Eigen::Vector2d away = handle + Eigen::Vector2d(30, 30), nowhere(3, 3);
  const std::vector<Row> rows = {
      {"hover", -1, false, pointer(PointerPhase::kHover, handle), State::kIdle, false, false, false},
      {"press on a handle", -1, false, pointer(PointerPhase::kPress, handle), State::kGrabbed, false, false, true},
      {"press on nothing", -1, false, pointer(PointerPhase::kPress, nowhere), State::kIdle, false, false, false},
      {"click on nothing", 0, false, pointer(PointerPhase::kRelease, nowhere), State::kIdle, false, true, false},
      {"click on a handle", 1, false, pointer(PointerPhase::kRelease, handle), State::kIdle, false, true, true},
      {"drag begins", 1, false, pointer(PointerPhase::kDrag, away), State::kDragging, false, false, true},
      {"drag", 1, true, pointer(PointerPhase::kDrag, away), State::kDragging, false, false, true},
      {"drag ends", 1, true, pointer(PointerPhase::kRelease, away), State::kIdle, true, false, true},
      {"Esc in a drag", 1, true, key(SketchKey::kEscape), State::kIdle, false, false, true},
      {"Delete in a drag", 1, true, key(SketchKey::kDelete), State::kDragging, false, false, true},
      {"Esc", -1, false, key(SketchKey::kEscape), State::kIdle, false, true, true},
      {"Tab", -1, false, key(SketchKey::kTab), State::kIdle, false, false, true},
      {"arrow without a handle", -1, false, key(SketchKey::kLeft), State::kIdle, false, false, false},
      {"Delete", -1, false, key(SketchKey::kDelete), State::kIdle, true, false, true},
      {"Return", -1, false, key(SketchKey::kReturn), State::kIdle, false, false, false},
  };
  for (const auto& row : rows) {
    SelectTool tool;
    tool.activate(bench.document);
    if (row.presses_on >= 0) send(tool, PointerPhase::kPress, row.presses_on == 1 ? handle : nowhere);
    if (row.dragging) send(tool, PointerPhase::kDrag, away);
    const ToolReply reply = row.event(tool);
    EXPECT_EQ(tool.state(), row.next) << row.what;
    EXPECT_EQ(reply.command != nullptr, row.command) << row.what;
    EXPECT_EQ(reply.selection.has_value(), row.selection) << row.what;
    EXPECT_EQ(reply.consumed, row.consumed) << row.what;
  }
}

// What every tool promises, whatever a hand does: Esc in a drag changes nothing, a gesture is at most one step, the
// document never changes while a drag goes on, undo brings everything back.
class ToolContract : public testing::TestWithParam<ToolKind> {};

TEST_P(ToolContract, HoldsUnderAnyHand) {
  std::mt19937 random(7);
  const auto below = [&](double n) { return std::uniform_real_distribution<double>(0, n)(random); };
  for (int round = 0; round < 60; ++round) {
    Bench bench;
    if (round % 3 != 0) bench.history.push(addItem(trueLine(bench, 1)));
    const DocumentState start = bench.document.state();
    const std::size_t first_step = bench.history.position();
    Hand hand(bench.tools, std::pow(2.0, below(6) - 3));
    for (int gesture = 0; gesture < 12; ++gesture) {
      bench.tools.setTool(GetParam());
      const DocumentState before = bench.document.state();
      const std::size_t steps = bench.history.position();
      hand.modifiers.control = below(1) < 0.3;
      hand.modifiers.shift = below(1) < 0.2;
      const PaneSide side = below(1) < 0.5 ? kLeft : kRight;
      const bool aimed = below(1) < 0.5;
      const Eigen::Vector2d target = bench.scene.pixel(side, below(1) < 0.5 ? bench.scene.a : bench.scene.b);
      hand.press(side, aimed ? target : Eigen::Vector2d(below(700) - 30, below(540) - 30));
      if (below(1) < 0.8) hand.moveTo({below(700) - 30, below(540) - 30});
      EXPECT_EQ(bench.document.state(), before) << "written before the gesture ended";
      const bool escape = below(1) < 0.3;
      if (escape) hand.key(SketchKey::kEscape);
      hand.release();
      if (escape) {
        EXPECT_EQ(bench.document.state(), before);
      }
      EXPECT_LE(bench.history.position(), steps + 1);
      EXPECT_FALSE(bench.tools.busy());
      EXPECT_FALSE(bench.tools.hint().empty());
      hand.key(static_cast<SketchKey>(static_cast<int>(below(8))));
    }
    while (bench.history.position() > first_step) bench.history.undo();
    EXPECT_EQ(bench.document.state(), start);
  }
}

TEST_P(ToolContract, PreviewIsAPureFunctionOfItsState) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.tools.setTool(GetParam());
  Hand hand(bench.tools);
  hand.press(kLeft, bench.scene.pixel(kLeft, bench.scene.a));
  hand.moveTo({300, 200});
  const DocumentState before = bench.document.state();
  const vision::Overlay one = bench.tools.overlay(kRight), two = bench.tools.overlay(kRight);
  ASSERT_EQ(one.shapes.size(), two.shapes.size());
  for (std::size_t i = 0; i < one.shapes.size(); ++i) EXPECT_EQ(one.shapes[i].points, two.shapes[i].points);
  EXPECT_EQ(bench.document.state(), before);
}

INSTANTIATE_TEST_SUITE_P(EveryTool, ToolContract,
                         testing::Values(ToolKind::kSelect, ToolKind::kPoint, ToolKind::kLine, ToolKind::kPipe, ToolKind::kPlane,
                                         ToolKind::kTriad, ToolKind::kMeasure));

}  // namespace
}  // namespace longarm::session
