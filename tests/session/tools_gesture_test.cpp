// Clicks and drags told apart.
#include <gtest/gtest.h>

#include "session/tools/gesture_filter.h"

namespace longarm::session {
namespace {

using vision::PaneSide;
using vision::PointerEvent;
using vision::PointerPhase;
using State = GestureFilter::State;

PointerEvent event(PointerPhase phase, double u, double zoom = 1, bool left = true) {
  PointerEvent e;
  e.phase = phase;
  e.pixel = {u, 0};
  e.pixels_per_image_px = zoom;
  e.left = left;
  return e;
}

// The table above the class, row by row: how to get into the state, the event, what it gives, the next state.
TEST(GestureFilter, FollowsItsTable) {
  struct Row {
    std::vector<PointerEvent> before;
    PointerEvent event;
    std::optional<GestureKind> gives;
    State next;
  };
  const PointerEvent hover = event(PointerPhase::kHover, 0), press = event(PointerPhase::kPress, 10);
  const PointerEvent near = event(PointerPhase::kDrag, 14), far = event(PointerPhase::kDrag, 14.5);
  const PointerEvent release = event(PointerPhase::kRelease, 14.5), twice = event(PointerPhase::kDoubleClick, 10);
  const std::vector<Row> rows = {
      {{}, hover, GestureKind::kHover, State::kUp},
      {{}, press, GestureKind::kPress, State::kPressed},
      {{}, twice, GestureKind::kDoubleClick, State::kIgnored},
      {{}, far, {}, State::kUp},
      {{}, release, {}, State::kUp},
      {{press}, near, {}, State::kPressed},
      {{press}, far, GestureKind::kDragBegin, State::kDragged},
      {{press}, release, GestureKind::kClick, State::kUp},
      {{press}, hover, {}, State::kPressed},
      {{press, far}, near, GestureKind::kDragMove, State::kDragged},
      {{press, far}, release, GestureKind::kDragEnd, State::kUp},
      {{twice}, far, {}, State::kIgnored},
      {{twice}, release, {}, State::kUp},
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    GestureFilter filter;
    for (const auto& e : rows[i].before) filter.feed(e);
    const auto gesture = filter.feed(rows[i].event);
    EXPECT_EQ(gesture.has_value(), rows[i].gives.has_value()) << "row " << i;
    if (gesture && rows[i].gives) {
      EXPECT_EQ(gesture->kind, *rows[i].gives) << "row " << i;
    }
    EXPECT_EQ(filter.state(), rows[i].next) << "row " << i;
  }
}

TEST(GestureFilter, GivesNothingMoreOfACancelledGesture) {
  GestureFilter filter;
  filter.feed(event(PointerPhase::kPress, 0));
  filter.feed(event(PointerPhase::kDrag, 50));
  filter.cancel();
  EXPECT_FALSE(filter.feed(event(PointerPhase::kDrag, 60)));
  EXPECT_FALSE(filter.feed(event(PointerPhase::kRelease, 60)));
  EXPECT_EQ(filter.feed(event(PointerPhase::kPress, 0))->kind, GestureKind::kPress);
}

TEST(GestureFilter, MeasuresTheStartDistanceOnTheScreen) {
  for (const double zoom : {0.25, 1.0, 4.0}) {
    GestureFilter filter;
    filter.feed(event(PointerPhase::kPress, 0, zoom));
    EXPECT_FALSE(filter.feed(event(PointerPhase::kDrag, 3.9 / zoom, zoom)));
    const auto gesture = filter.feed(event(PointerPhase::kDrag, 4.1 / zoom, zoom));
    ASSERT_TRUE(gesture) << zoom;
    EXPECT_EQ(gesture->kind, GestureKind::kDragBegin);
    EXPECT_DOUBLE_EQ(gesture->tolerance_px, 8 / zoom);
    EXPECT_DOUBLE_EQ(gesture->travel().x(), 4.1 / zoom);
  }
}

TEST(GestureFilter, LeavesOtherButtonsToTheCanvas) {
  GestureFilter filter;
  EXPECT_FALSE(filter.feed(event(PointerPhase::kPress, 0, 1, false)));
  EXPECT_FALSE(filter.feed(event(PointerPhase::kDrag, 90, 1, false)));
  EXPECT_FALSE(filter.feed(event(PointerPhase::kRelease, 90, 1, false)));
}

TEST(GestureFilter, KeepsThePaneOfThePress) {
  GestureFilter filter;
  PointerEvent press = event(PointerPhase::kPress, 0);
  press.side = PaneSide::kRight;
  filter.feed(press);
  const auto gesture = filter.feed(event(PointerPhase::kDrag, 50));
  EXPECT_EQ(gesture->side, PaneSide::kRight);
}

}  // namespace
}  // namespace longarm::session
