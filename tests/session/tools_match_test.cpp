// Help with the second pick: suggested matches, snapping, the band, and what misses say of the calibration.
#include <gtest/gtest.h>

#include "session/tools/calibration_watch.h"
#include "session/tools/match_help.h"
#include "tests/session/painted_views.h"
#include "vision/stereo/epipolar_band.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::Hand;
using tests::PaintedPair;
using tests::PaintedWall;
using vision::OverlayRole;
using vision::OverlayShape;
using vision::SketchKey;

/// Answers the wishes as the controller's jobs do.
void answerWishes(ToolHost& tools, const Document& document) {
  std::vector<MatchHelp> help;
  for (const auto& wish : tools.matchWishes()) {
    const auto from = document.snapshot(wish.from), to = document.snapshot(wish.to);
    auto matches = vision::suggestMatches(from->view, *tools.pictures()->of(from), wish.pixel, to->view, *tools.pictures()->of(to));
    ASSERT_TRUE(matches.ok()) << matches.error().message;
    help.push_back({wish, std::move(*matches)});
  }
  tools.setMatchHelp(std::move(help));
}

std::vector<Eigen::Vector2d> marksOf(const ToolHost& tools, PaneSide side, OverlayRole role) {
  std::vector<Eigen::Vector2d> marks;
  for (const auto& shape : tools.overlay(side).shapes) {
    if (shape.kind == OverlayShape::Kind::kMarker && shape.role == role) marks.push_back(shape.points[0]);
  }
  return marks;
}

struct PaintedBench : Bench {
  explicit PaintedBench(const PaintedWall& wall) : Bench(false), pair(wall) {
    history.push(addSnapshots(document, pair.snapshots()));
    history.clear();
  }
  PaintedPair pair;
};

/// Zoom of the canvas.
class MatchGesture : public testing::TestWithParam<double> {};

TEST_P(MatchGesture, IsOfferedAsGhostsAndTakenByTabOneUndoStepEach) {
  PaintedBench bench(PaintedWall::textured(3));
  Hand hand(bench.tools, GetParam());
  bench.tools.setTool(ToolKind::kLine);
  EXPECT_TRUE(bench.tools.matchWishes().empty()) << "nothing is picked yet";
  const double xs[] = {-0.1, 0.12};
  hand.drag(PaneSide::kLeft, bench.pair.pixel(PaneSide::kLeft, xs[0], 0.02), bench.pair.pixel(PaneSide::kLeft, xs[1], -0.05));
  const DocumentState drawn = bench.document.state();
  ASSERT_EQ(bench.tools.matchWishes().size(), 2U);
  answerWishes(bench.tools, bench.document);
  EXPECT_EQ(bench.document.state(), drawn) << "nothing moves unasked";
  EXPECT_EQ(marksOf(bench.tools, PaneSide::kRight, OverlayRole::kMatch).size(), 2U);
  EXPECT_TRUE(marksOf(bench.tools, PaneSide::kLeft, OverlayRole::kMatch).empty());
  EXPECT_NE(bench.tools.hint().find("Tab"), std::string::npos) << bench.tools.hint();

  EXPECT_TRUE(hand.key(SketchKey::kTab));
  EXPECT_EQ(bench.history.size(), 2U);
  EXPECT_EQ(marksOf(bench.tools, PaneSide::kRight, OverlayRole::kMatch).size(), 1U) << "the other end is still offered";
  EXPECT_TRUE(hand.key(SketchKey::kTab));
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect) << "finished";
  const SketchItem& item = bench.document.items().front();
  for (int vertex = 0; vertex < 2; ++vertex) {
    const SketchPick* pick = item.pick({2}, vertex);
    EXPECT_EQ(pick->state, PickState::kMatched);
    EXPECT_GE(pick->sigma_px, 0.05);
    EXPECT_LT(pick->sigma_px, 0.5);
    EXPECT_LT((pick->pixel - bench.pair.pixel(PaneSide::kRight, xs[vertex], vertex == 0 ? 0.02 : -0.05)).norm(), 0.5);
  }
  EXPECT_TRUE(bench.document.measurement(item.id).feature) << bench.document.measurement(item.id).reason;
  bench.history.undo();
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), drawn);
}
INSTANTIATE_TEST_SUITE_P(Zooms, MatchGesture, testing::Values(0.25, 1.0, 4.0));

TEST(MatchHelp, ShowsRivalsOfARepeatedPatternAndTabTakesNone) {
  PaintedBench bench(PaintedWall::repeated(0.04));
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.click(PaneSide::kLeft, bench.pair.pixel(PaneSide::kLeft, 0.013, 0.008));
  answerWishes(bench.tools, bench.document);
  EXPECT_TRUE(marksOf(bench.tools, PaneSide::kRight, OverlayRole::kMatch).empty());
  EXPECT_GE(marksOf(bench.tools, PaneSide::kRight, OverlayRole::kRival).size(), 2U);
  EXPECT_NE(bench.tools.hint().find("alike"), std::string::npos) << bench.tools.hint();
  const DocumentState before = bench.document.state();
  EXPECT_TRUE(hand.key(SketchKey::kTab));
  EXPECT_EQ(bench.document.state(), before);
}

TEST(MatchHelp, IsForgottenWhenThePickMovesAndAMatchSlidesOnWithIt) {
  PaintedBench bench(PaintedWall::textured(4));
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  const Eigen::Vector2d at = bench.pair.pixel(PaneSide::kLeft, 0.02, 0.03);
  hand.click(PaneSide::kLeft, at);
  answerWishes(bench.tools, bench.document);
  ASSERT_TRUE(bench.tools.matchHelp().size() == 1 && bench.tools.matchHelp()[0].offered());
  hand.drag(PaneSide::kLeft, at, at + Eigen::Vector2d(15, 4));
  EXPECT_TRUE(bench.tools.matchHelp().empty()) << "it was the match of another place";
  answerWishes(bench.tools, bench.document);
  hand.key(SketchKey::kTab);
  ASSERT_EQ(bench.document.items().front().pick({2}, 0)->state, PickState::kMatched);
  hand.drag(PaneSide::kLeft, at + Eigen::Vector2d(15, 4), at + Eigen::Vector2d(30, 4));
  const SketchPick* slid = bench.document.items().front().pick({2}, 0);
  EXPECT_EQ(slid->state, PickState::kConstrained);
  EXPECT_EQ(slid->sigma_px, 0) << "what is no match has no match's certainty";
  ASSERT_EQ(bench.tools.matchWishes().size(), 1U) << "the select tool asks again after a move";
  answerWishes(bench.tools, bench.document);
  hand.key(SketchKey::kTab);
  EXPECT_EQ(bench.document.items().front().pick({2}, 0)->state, PickState::kMatched);
}

/// Both pictures are checkerboards with known corners.
struct CheckerBench : Bench {
  CheckerBench() : Bench(false) {
    auto left = std::make_shared<vision::Snapshot>(*tests::snapshotOf(1, scene.left));
    auto right = std::make_shared<vision::Snapshot>(*tests::snapshotOf(2, scene.right));
    left->image = tests::checkerPicture(corner);
    right->image = tests::checkerPicture(corner);
    history.push(addSnapshots(document, {left, right}));
    history.clear();
  }
  Eigen::Vector2d corner{300.3, 220.6};
};

class SnapGesture : public testing::TestWithParam<double> {};

TEST_P(SnapGesture, DrawsAHandleToTheCornerWhileShiftIsHeld) {
  CheckerBench bench;
  Hand hand(bench.tools, GetParam());
  bench.tools.setTool(ToolKind::kPoint);
  hand.modifiers.shift = true;
  hand.press(PaneSide::kLeft, bench.corner + Eigen::Vector2d(90, 70));
  hand.moveTo(bench.corner + Eigen::Vector2d(1.5, -1.2));
  bool told = false;
  for (const auto& shape : bench.tools.overlay(PaneSide::kLeft).shapes) told = told || shape.text == "corner";
  EXPECT_TRUE(told);
  hand.release();
  ASSERT_EQ(bench.document.items().size(), 1U);
  EXPECT_LT((bench.document.items()[0].pick({1}, 0)->pixel - bench.corner).norm(), 0.15);

  hand.modifiers.shift = false;
  const Eigen::Vector2d beside = bench.corner + Eigen::Vector2d(49.5, -1.2);   // Next to another corner.
  hand.drag(PaneSide::kLeft, bench.document.items()[0].pick({1}, 0)->pixel, beside);
  EXPECT_LT((bench.document.items()[0].pick({1}, 0)->pixel - beside).norm(), 1e-9) << "without Shift nothing snaps";
}
INSTANTIATE_TEST_SUITE_P(Zooms, SnapGesture, testing::Values(0.25, 1.0, 4.0));

TEST(Snapping, BringsAConstrainedHandleToWhereAnEdgeCrossesItsCurve) {
  CheckerBench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  hand.click(PaneSide::kLeft, {380.0, 220.6 + 12});
  hand.modifiers.shift = true;
  const double edge_u = bench.corner.x() + 24;           // The curve runs nearly along the rows: upright edges cross it.
  hand.click(PaneSide::kRight, {edge_u + 2.2, 232});
  const SketchPick* pick = bench.document.items().front().pick({2}, 0);
  ASSERT_NE(pick, nullptr);
  EXPECT_EQ(pick->state, PickState::kConstrained);
  EXPECT_NEAR(pick->pixel.x(), edge_u, 0.3);
  const auto curve = vision::epipolarCurve(bench.scene.left, {380.0, 232.6}, bench.scene.right);
  EXPECT_LT((curve->nearest(pick->pixel)->pixel - pick->pixel).norm(), 0.01) << "and it stays on the curve";
}

TEST(EpipolarBand, IsDrawnTwoSigmaToEitherSideOfTheCurve) {
  Bench bench(false);
  bench.scene.right.pose_covariance = 1e-6 * Matrix6d::Identity();
  bench.history.push(addSnapshots(bench.document, {tests::snapshotOf(1, bench.scene.left), tests::snapshotOf(2, bench.scene.right)}));
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPoint);
  const Eigen::Vector2d at = bench.scene.pixel(PaneSide::kLeft, bench.scene.a);
  hand.click(PaneSide::kLeft, at);
  const auto curve = vision::epipolarCurve(bench.scene.left, at, bench.scene.right).value();
  const auto sigma = vision::epipolarBand(bench.scene.left, at, bench.scene.right, curve).value();
  const OverlayShape* band = nullptr;
  const vision::Overlay overlay = bench.tools.overlay(PaneSide::kRight);
  for (const auto& shape : overlay.shapes) {
    if (shape.kind == OverlayShape::Kind::kArea && shape.role == OverlayRole::kBand) band = &shape;
  }
  ASSERT_NE(band, nullptr);
  ASSERT_EQ(band->points.size(), 2 * curve.points.size());
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const double width = (band->points[i] - band->points[band->points.size() - 1 - i]).norm();
    EXPECT_NEAR(width, 4 * sigma[i], 1e-6);
  }
}

TEST(CalibrationWatch, IsSilentOverPicksThatAreHeldToTheirCurves) {
  Bench bench;
  bench.history.push(addItem(tests::trueLine(bench, 1)));
  const auto concern = calibrationConcern(bench.document);
  EXPECT_TRUE(concern.pairs.empty()) << "a pick on the curve by force says nothing";
  EXPECT_TRUE(calibrationWarning(bench.document, concern).empty());
}

TEST(CalibrationWatch, NamesAPickBeyondTheBandAndCountsTheMissesOfItsCameras) {
  Bench bench;
  for (std::uint64_t id = 1; id <= 3; ++id) {
    SketchItem item = tests::trueLine(bench, id, "Line " + std::to_string(id));
    for (int vertex = 0; vertex < 2; ++vertex) {
      SketchPick pick = *item.pick({2}, vertex);
      pick.pixel.y() += id == 2 && vertex == 1 ? 7.0 : 0.4;
      pick.state = PickState::kReleased;
      item.setPick({2}, vertex, pick);
    }
    bench.history.push(addItem(item));
  }
  const auto concern = calibrationConcern(bench.document);
  ASSERT_EQ(concern.pairs.size(), 1U);
  EXPECT_EQ(concern.pairs[0].statistic.count(), 6);
  ASSERT_EQ(concern.off.size(), 1U);
  EXPECT_EQ(concern.off[0].item, FeatureId{2});
  EXPECT_EQ(concern.off[0].vertex, 1);
  EXPECT_NEAR(concern.off[0].off_px, 7.0, 0.3);
  const std::string text = calibrationWarning(bench.document, concern);
  EXPECT_NE(text.find("'Line 2'"), std::string::npos) << text;
  EXPECT_NE(text.find("6 picks"), std::string::npos) << text;
}

TEST(CalibrationWatch, SaysThatACameraTiltedWhenEveryPickMissesTheSameWay) {
  Bench bench;
  for (std::uint64_t id = 1; id <= 3; ++id) {
    SketchItem item = tests::trueLine(bench, id, "Line " + std::to_string(id));
    for (int vertex = 0; vertex < 2; ++vertex) {
      SketchPick pick = *item.pick({2}, vertex);
      pick.pixel.y() += 5;
      pick.state = PickState::kMatched;
      pick.sigma_px = 2;                   // Unsure matches: none is beyond the band by itself.
      item.setPick({2}, vertex, pick);
    }
    bench.history.push(addItem(item));
  }
  const auto concern = calibrationConcern(bench.document);
  EXPECT_TRUE(concern.off.empty());
  EXPECT_NE(calibrationWarning(bench.document, concern).find("head_left and head_right"), std::string::npos)
      << calibrationWarning(bench.document, concern);
}

}  // namespace
}  // namespace longarm::session
