// The document: what it holds, what it measures, what it tells.
#include <gtest/gtest.h>

#include "session/document/document.h"
#include "session/document/feature_rows.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::trueLine;

constexpr double kMetre = 1e-6;  // Noise-free picks: only the optimiser's own end remains.

TEST(Document, MeasuresALineMarkedInTwoPictures) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const Measurement& measured = bench.document.measurement({1});
  ASSERT_TRUE(measured.feature) << measured.reason;
  EXPECT_NEAR((measured.feature->vertices[0].xyz - bench.scene.a).norm(), 0, kMetre);
  EXPECT_NEAR((measured.feature->vertices[1].xyz - bench.scene.b).norm(), 0, kMetre);
  EXPECT_EQ(bench.document.selectedFeature(), &*measured.feature);
}

TEST(Document, SaysWhichEndIsMarkedInTooFewPictures) {
  Bench bench;
  SketchItem item = trueLine(bench, 1);
  item.picks[{2}][1].reset();
  bench.history.push(addItem(item));
  const Measurement& measured = bench.document.measurement({1});
  EXPECT_FALSE(measured.feature);
  EXPECT_EQ(measured.reason, "'Line 1' is not measured: end 2 is marked in one picture only. Mark it in two pictures.");
  EXPECT_EQ(bench.document.selectedFeature(), nullptr);
}

TEST(Document, DoesNotMeasureACopyThatNobodyPlaced) {
  Bench bench;
  SketchItem item = trueLine(bench, 1);
  for (int vertex = 0; vertex < 2; ++vertex) item.setPick({2}, vertex, {{300, 200}, PickState::kUnplaced});
  bench.history.push(addItem(item));
  EXPECT_FALSE(bench.document.measurement({1}).feature);
  EXPECT_NE(bench.document.measurement({1}).reason.find("in one picture only"), std::string::npos);
}

TEST(Document, RefusesAPickOffThePictureAndSaysWhere) {
  Bench bench;
  SketchItem item = trueLine(bench, 1);
  item.setPick({2}, 0, {{-3.0, 200}, PickState::kFree});
  bench.history.push(addItem(item));
  EXPECT_FALSE(bench.document.measurement({1}).feature);
  EXPECT_EQ(bench.document.measurement({1}).reason,
            "'Line 1' is not measured: end 1 is marked at (-3.0, 200.0), outside picture head_right (640 x 480 px). "
            "Drag it onto the picture.");
}

TEST(Document, ExplainsPicksThatPointBehindTheCameras) {
  Bench bench;
  SketchItem item;
  item.id = {1};
  item.name = "Point 1";
  // Rays that part: left looks right of right.
  item.setPick({1}, 0, {{100, 240}, PickState::kFree});
  item.setPick({2}, 0, {{540, 240}, PickState::kReleased});
  bench.history.push(addItem(item));
  EXPECT_FALSE(bench.document.measurement({1}).feature);
  EXPECT_FALSE(bench.document.measurement({1}).reason.empty());
}

TEST(Document, GivesTheFirstFreeNameOfAKind) {
  Bench bench;
  EXPECT_EQ(bench.document.freeName(vision::FeatureKind::kLine), "Line 1");
  bench.history.push(addItem(trueLine(bench, 1, "Line 1")));
  bench.history.push(addItem(trueLine(bench, 2, "Line 3")));
  EXPECT_EQ(bench.document.freeName(vision::FeatureKind::kLine), "Line 2");
  EXPECT_EQ(bench.document.freeName(vision::FeatureKind::kPoint), "Point 1");
}

TEST(Document, NeverGivesAnIdTwice) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, bench.document.nextFeatureId().value)));
  const FeatureId next = bench.document.nextFeatureId();
  bench.history.undo();
  EXPECT_EQ(bench.document.nextFeatureId(), next) << "an undone item may come back by redo";
}

TEST(Document, DropsFromTheSelectionWhatIsRemoved) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(addItem(trueLine(bench, 2, "Line 2")));
  bench.document.select({{{1}, {2}}, {2}});
  bench.history.push(removeItems(bench.document, {{2}}));
  EXPECT_EQ(bench.document.selection().items, (std::set<FeatureId>{{1}}));
  EXPECT_EQ(bench.document.selection().primary, FeatureId{1});
  bench.document.select(Selection::of({99}));
  EXPECT_TRUE(bench.document.selection().items.empty());
}

TEST(Document, TellsWhatChangedOnceEach) {
  Bench bench;
  std::vector<ChangeKind> kinds;
  const int handle = bench.document.observe([&](const Change& change) { kinds.push_back(change.kind); });
  bench.history.push(addItem(trueLine(bench, 1)));
  EXPECT_EQ(kinds, (std::vector<ChangeKind>{ChangeKind::kItemAdded, ChangeKind::kSelectionChanged}));
  kinds.clear();
  bench.history.push(renameItem(bench.document, {1}, "pipe"));
  EXPECT_EQ(kinds, std::vector<ChangeKind>{ChangeKind::kItemChanged});
  kinds.clear();
  bench.document.unobserve(handle);
  bench.history.undo();
  EXPECT_TRUE(kinds.empty());
}

TEST(Document, LetsAnObserverTakeItselfOffTheList) {
  Bench bench;
  int calls = 0, handle = 0;
  handle = bench.document.observe([&](const Change&) {
    ++calls;
    bench.document.unobserve(handle);
  });
  bench.history.push(addItem(trueLine(bench, 1)));
  EXPECT_EQ(calls, 1);
}

TEST(Document, KeepsPlanAndWorkcellThroughUndo) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.document.setPlan({{}, {}, "grab_pipe", {1}});
  bench.history.undo();
  ASSERT_TRUE(bench.document.plan());
  EXPECT_EQ(bench.document.plan()->macro, "grab_pipe");
  EXPECT_TRUE(bench.document.plan()->id.valid());
  bench.document.clearPlan();
  EXPECT_FALSE(bench.document.plan());
}

TEST(FeatureRows, GiveNumbersWithTheirAccuracy) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const FeatureRow row = featureRows(bench.document).at(0);
  EXPECT_TRUE(row.measured && row.selected && row.primary);
  EXPECT_NEAR((row.xyz - 0.5 * (bench.scene.a + bench.scene.b)).norm(), 0, kMetre);
  ASSERT_TRUE(row.length && row.length_plus_minus);
  EXPECT_NEAR(*row.length, (bench.scene.a - bench.scene.b).norm(), kMetre);
  const auto& feature = *bench.document.measurement({1}).feature;
  EXPECT_NEAR(*row.length_plus_minus, 1.96 * feature.lengthSigma(), 1e-4 * feature.lengthSigma());
  // Z^2 sigma sqrt2 / (f b) at 1.6 m with 0.5 px is 9.6 mm; 95 % of it 19 mm.
  EXPECT_GT(row.plus_minus, 0.014);
  EXPECT_LT(row.plus_minus, 0.024);
  EXPECT_EQ(row.length_text, millimetreText(*row.length, *row.length_plus_minus));
  EXPECT_EQ(millimetreText(0.4021, 0.0013), "402.1 \u00b1 1.3 mm");
}

TEST(FeatureRows, SayWhyThereAreNoNumbers) {
  Bench bench;
  SketchItem item = trueLine(bench, 1);
  item.picks.erase({2});
  bench.history.push(addItem(item));
  const FeatureRow row = featureRows(bench.document).at(0);
  EXPECT_FALSE(row.measured);
  EXPECT_FALSE(row.reason.empty());
  EXPECT_TRUE(row.length_text.empty());
}

}  // namespace
}  // namespace longarm::session
