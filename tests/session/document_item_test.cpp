// One sketched primitive as a value.
#include <cmath>

#include <gtest/gtest.h>

#include "session/document/sketch_item.h"

namespace longarm::session {
namespace {

SketchItem line() {
  SketchItem item;
  item.id = {7};
  item.kind = vision::FeatureKind::kLine;
  item.name = "Line 1";
  item.setPick({1}, 0, {{10, 20}, PickState::kFree});
  return item;
}

TEST(SketchItem, AnswersNoPickWhereThereIsNone) {
  const SketchItem item = line();
  ASSERT_NE(item.pick({1}, 0), nullptr);
  EXPECT_EQ(item.pick({1}, 0)->pixel, Eigen::Vector2d(10, 20));
  EXPECT_EQ(item.pick({1}, 1), nullptr);
  EXPECT_EQ(item.pick({1}, 2), nullptr);
  EXPECT_EQ(item.pick({1}, -1), nullptr);
  EXPECT_EQ(item.pick({2}, 0), nullptr);
}

TEST(SketchItem, CountsOnlyPlacedPicks) {
  SketchItem item = line();
  item.setPick({2}, 0, {{11, 21}, PickState::kUnplaced});
  EXPECT_EQ(item.placedCount(0), 1);
  EXPECT_FALSE(item.placedIn({1}));
  item.setPick({1}, 1, {{30, 40}, PickState::kConstrained});
  EXPECT_TRUE(item.placedIn({1}));
  item.setPick({2}, 0, {{11, 21}, PickState::kReleased});
  EXPECT_EQ(item.placedCount(0), 2);
}

TEST(SketchItem, DiffersByTheLastBitOfAPixel) {
  const SketchItem a = line();
  SketchItem b = a;
  EXPECT_EQ(a, b);
  EXPECT_EQ(hashOf(a), hashOf(b));
  b.setPick({1}, 0, {{std::nextafter(10.0, 11.0), 20}, PickState::kFree});
  EXPECT_NE(a, b);
  EXPECT_NE(hashOf(a), hashOf(b));
  SketchItem zero = a, minus_zero = a;
  zero.setPick({1}, 0, {{0.0, 20}, PickState::kFree});
  minus_zero.setPick({1}, 0, {{-0.0, 20}, PickState::kFree});
  EXPECT_NE(zero, minus_zero) << "bit for bit means the sign of zero too";
}

TEST(SketchItem, DiffersByEveryField) {
  const SketchItem a = line();
  const auto differs = [&](auto change) {
    SketchItem b = a;
    change(b);
    return b != a && hashOf(b) != hashOf(a);
  };
  EXPECT_TRUE(differs([](SketchItem& b) { b.name = "x"; }));
  EXPECT_TRUE(differs([](SketchItem& b) { b.hidden = true; }));
  EXPECT_TRUE(differs([](SketchItem& b) { b.locked = true; }));
  EXPECT_TRUE(differs([](SketchItem& b) { b.colour = 0; }));
  EXPECT_TRUE(differs([](SketchItem& b) { b.id = {8}; }));
  EXPECT_TRUE(differs([](SketchItem& b) { b.setPick({1}, 0, {{10, 20}, PickState::kReleased}); }));
}

}  // namespace
}  // namespace longarm::session
