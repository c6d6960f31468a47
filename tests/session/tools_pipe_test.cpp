// Pipes by their outlines, dimensions between vertices, groups, frames and numbers.
#include <random>

#include <gtest/gtest.h>

#include "session/document/dimension.h"
#include "session/document/feature_rows.h"
#include "session/document/overlay_builder.h"
#include "session/tools/measure_tool.h"
#include "session/tools/pick_editor.h"
#include "tests/session/true_shapes.h"
#include "vision/sketch/solids.h"

namespace longarm::session {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using tests::Bench;
using tests::Hand;
using tests::TruePipe;
using vision::OverlayRole;
using vision::SketchKey;

class PipeGesture : public testing::TestWithParam<double> {};

TEST_P(PipeGesture, MeasuresAxisAndRadiusWithTwoStrokesPerPicture) {
  Bench bench;
  TruePipe truth;
  Hand hand(bench.tools, GetParam());
  bench.tools.setTool(ToolKind::kPipe);
  EXPECT_NE(bench.tools.hint().find("outline"), std::string::npos) << bench.tools.hint();
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    const auto ends = truth.outlines(bench.scene.view(side));
    hand.drag(side, ends[0], ends[1]);
    hand.drag(side, ends[2], ends[3]);
    EXPECT_TRUE(bench.tools.matchWishes().empty()) << "outlines have no matching ends";
  }
  ASSERT_EQ(bench.document.items().size(), 1U);
  const SketchItem& item = bench.document.items()[0];
  EXPECT_TRUE(item.pipe);
  EXPECT_EQ(item.name, "Pipe 1");
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect) << "finished";
  const Measurement& measured = bench.document.measurement(item.id);
  ASSERT_TRUE(measured.feature) << measured.reason;
  ASSERT_TRUE(measured.feature->pipe);
  EXPECT_NEAR(measured.feature->pipe->radius, truth.radius, 1e-4);
  const FeatureRow row = featureRow(item, measured);
  ASSERT_TRUE(row.radius && row.radius_plus_minus);
  EXPECT_GT(*row.radius_plus_minus, 0);
  EXPECT_NE(row.length_text.find("r 40.0"), std::string::npos) << row.length_text;
  const vision::Feature& pipe = *measured.feature;
  for (const auto& vertex : pipe.vertices) {
    const Vector3d d = (truth.b - truth.a).normalized();
    EXPECT_LT((vertex.xyz - truth.a).cross(d).norm(), 5e-4) << "on the true axis";
  }
}
INSTANTIATE_TEST_SUITE_P(Zooms, PipeGesture, testing::Values(0.25, 1.0, 4.0));

TEST(Solids, OutlinesOfACylinderAreWhereItsSurfaceTurnsAway) {
  Bench bench;
  TruePipe truth;
  vision::Overlay overlay;
  vision::addCylinder(truth.pose(), truth.radius, (truth.b - truth.a).norm(), bench.scene.left, {}, &overlay);
  const auto ends = truth.outlines(bench.scene.left);
  for (const int first : {0, 2}) {
    bool found = false;
    for (const auto& shape : overlay.shapes) {
      if (shape.points.empty()) continue;
      const auto& p = ends[static_cast<std::size_t>(first)];
      const auto& q = ends[static_cast<std::size_t>(first + 1)];
      found = found || ((shape.points.front() - p).norm() < 0.05 && (shape.points.back() - q).norm() < 0.05);
    }
    EXPECT_TRUE(found) << "outline " << first;
  }
}

TEST(Solids, HullHoldsAllPointsAndTurnsOneWay) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(0, 100);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vector2d> points;
    for (int i = 0; i < 3 + trial % 30; ++i) points.emplace_back(place(random), place(random));
    const auto hull = vision::convexHull(points);
    ASSERT_GE(hull.size(), 3U);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      const Vector2d a = hull[i], ab = hull[(i + 1) % hull.size()] - a;
      for (const auto& p : points) ASSERT_GE(ab.x() * (p - a).y() - ab.y() * (p - a).x(), -1e-9);
    }
  }
}

TEST(Solids, ABoxBehindTheCameraIsNotDrawn) {
  Bench bench;
  Pose behind = Pose::Identity();
  behind.translation() = Vector3d(-2, 0, 1);
  vision::Overlay overlay;
  vision::SolidLook look;
  look.filled = true;
  vision::addBox(behind, {0.3, 0.3, 0.3}, bench.scene.left, look, &overlay);
  EXPECT_TRUE(overlay.shapes.empty());
}

TEST(Dimension, IsTheTrueDistanceAndAngle) {
  Bench bench;
  bench.history.push(addItem(tests::trueLine(bench, 1)));
  SketchItem point;
  point.id = {2};
  point.name = "Point 1";
  const Vector3d c(1.45, 0.0, 1.2);
  point.setPick({1}, 0, {bench.scene.pixel(PaneSide::kLeft, c), PickState::kFree});
  point.setPick({2}, 0, {bench.scene.pixel(PaneSide::kRight, c), PickState::kConstrained});
  bench.history.push(addItem(point));
  const auto distance = distanceBetween(bench.document, {{1}, 0}, {{2}, 0});
  ASSERT_TRUE(distance.ok()) << distance.error().message;
  EXPECT_NEAR(distance->value, (bench.scene.a - c).norm(), 1e-5);
  EXPECT_GT(distance->sigma, 1e-4);
  const auto angle = angleAt(bench.document, {{1}, 0}, {{2}, 0}, {{1}, 1});
  ASSERT_TRUE(angle.ok());
  EXPECT_NEAR(angle->value, std::acos((bench.scene.a - c).normalized().dot((bench.scene.b - c).normalized())), 1e-5);
  EXPECT_NE(angle->text().find("\u00b0"), std::string::npos);
  EXPECT_FALSE(distanceBetween(bench.document, {{1}, 0}, {{9}, 0})) << "no such feature";
  EXPECT_FALSE(angleAt(bench.document, {{1}, 0}, {{1}, 0}, {{1}, 1})) << "no way to go";
}

TEST(Dimension, StatesSigmasThatRepeatedPicksConfirm) {
  Bench bench;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, bench.scene.left.sigma_px);
  const Vector3d ends[] = {bench.scene.a, bench.scene.b, {1.45, 0.0, 1.2}};
  double squares[2] = {0, 0}, stated[2] = {0, 0};
  const int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    SketchItem plane;
    plane.id = bench.document.nextFeatureId();
    plane.kind = vision::FeatureKind::kPlane;
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
        const Vector2d pixel = bench.scene.pixel(side, ends[vertex]) + Vector2d(noise(random), noise(random));
        plane.setPick(bench.snapshot(side), vertex, {pixel, PickState::kFree});
      }
    }
    bench.document.insertItem(0, plane);
    const auto distance = distanceBetween(bench.document, {plane.id, 0}, {plane.id, 1});
    const auto angle = angleAt(bench.document, {plane.id, 0}, {plane.id, 2}, {plane.id, 1});
    ASSERT_TRUE(distance.ok() && angle.ok());
    const Vector3d u = (ends[0] - ends[2]).normalized(), v = (ends[1] - ends[2]).normalized();
    squares[0] += std::pow(distance->value - (ends[0] - ends[1]).norm(), 2) / trials;
    squares[1] += std::pow(angle->value - std::acos(u.dot(v)), 2) / trials;
    stated[0] += distance->sigma / trials;
    stated[1] += angle->sigma / trials;
    bench.document.removeItem(plane.id);
  }
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(std::sqrt(squares[i]) / stated[i], 1, 0.12) << (i == 0 ? "distance" : "angle");
}

TEST(MeasureTool, ShowsDistanceThenAngleAndWritesNothing) {
  Bench bench;
  bench.history.push(addItem(tests::trueLine(bench, 1)));
  bench.history.push(addItem(tests::trueLine(bench, 2, "Line 2")));
  const DocumentState before = bench.document.state();
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kMeasure);
  hand.click(PaneSide::kLeft, bench.scene.pixel(PaneSide::kLeft, bench.scene.a));
  hand.click(PaneSide::kRight, bench.scene.pixel(PaneSide::kRight, bench.scene.b));
  EXPECT_EQ(bench.tools.hint().rfind("Distance ", 0), 0U) << bench.tools.hint();
  const std::string expected = distanceBetween(bench.document, {{1}, 0}, {{1}, 1})->text();
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    bool shown = false;
    for (const auto& shape : bench.tools.overlay(side).shapes) shown = shown || (shape.role == OverlayRole::kDimension && shape.text == expected);
    EXPECT_TRUE(shown);
  }
  EXPECT_TRUE(hand.key(SketchKey::kEscape));
  EXPECT_EQ(bench.tools.tool(), ToolKind::kMeasure) << "the first Esc only forgets";
  hand.key(SketchKey::kEscape);
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect);
  EXPECT_EQ(bench.document.state(), before);
}

SketchItem shifted(const SketchItem& from, std::uint64_t id, const Vector2d& by) {
  SketchItem item = from;
  item.id = {id};
  item.name = "Line " + std::to_string(id);
  for (auto& [snapshot, list] : item.picks) {
    for (auto& pick : list) pick->pixel += by;
  }
  return item;
}

class BandGesture : public testing::TestWithParam<double> {};

TEST_P(BandGesture, SelectsWhatHasAHandleInTheFrame) {
  Bench bench;
  const SketchItem line = tests::trueLine(bench, 1);
  bench.history.push(addItem(line));
  bench.history.push(addItem(shifted(line, 2, {0, 100})));
  bench.history.push(addItem(shifted(line, 3, {0, -140})));
  bench.document.select({});
  Hand hand(bench.tools, GetParam());
  const Vector2d a = line.pick({1}, 0)->pixel;
  hand.press(PaneSide::kLeft, a + Vector2d(-70, -60));
  hand.moveTo(a + Vector2d(40, 130));
  int frames = 0;
  for (const auto& shape : bench.tools.overlay(PaneSide::kLeft).shapes) frames += shape.role == OverlayRole::kUnplaced ? 1 : 0;
  EXPECT_EQ(frames, 1);
  hand.release();
  EXPECT_EQ(bench.document.selection().items, (std::set<FeatureId>{{1}, {2}}));
  hand.drag(PaneSide::kLeft, a + Vector2d(-70, -60), a + Vector2d(-50, -30));
  EXPECT_TRUE(bench.document.selection().items.empty()) << "an empty frame selects nothing";
}
INSTANTIATE_TEST_SUITE_P(Zooms, BandGesture, testing::Values(0.25, 1.0, 4.0));

TEST(Groups, AreSelectedAndMovedAsOneUndoStep) {
  Bench bench;
  const SketchItem line = tests::trueLine(bench, 1);
  bench.history.push(addItem(line));
  bench.history.push(addItem(shifted(line, 2, {0, 60})));
  bench.history.push(groupItems(bench.document, {{1}, {2}}, true));
  bench.document.select({});
  Hand hand(bench.tools);
  const Vector2d middle = (line.pick({1}, 0)->pixel + line.pick({1}, 1)->pixel) / 2;
  hand.click(PaneSide::kLeft, middle);
  EXPECT_EQ(bench.document.selection().items.size(), 2U);
  const DocumentState before = bench.document.state();
  hand.drag(PaneSide::kLeft, middle, middle + Vector2d(20, -10));
  for (const std::uint64_t id : {1, 2}) {
    const SketchItem* old = &before.items[id - 1];
    EXPECT_LT((bench.document.item({id})->pick({1}, 0)->pixel - old->pick({1}, 0)->pixel - Vector2d(20, -10)).norm(), 1e-9);
  }
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), before);
  hand.modifiers.alt = true;
  hand.click(PaneSide::kLeft, middle);
  EXPECT_EQ(bench.document.selection().items.size(), 1U) << "Alt takes it out of its group";
}

TEST(Numbers, MoveAVertexToAPlaceOfTheWorldAndAPickToAPixel) {
  Bench bench;
  const SketchItem line = tests::trueLine(bench, 1);
  bench.history.push(addItem(line));
  const Vector3d wanted(1.52, 0.1, 1.0);
  const auto moved = withVertexAt(bench.document, line, 0, wanted);
  ASSERT_TRUE(moved.ok()) << moved.error().message;
  const auto feature = bench.document.measure(*moved).feature;
  ASSERT_TRUE(feature);
  EXPECT_LT((feature->vertices[0].xyz - wanted).norm(), 1e-6);
  EXPECT_FALSE(withVertexAt(bench.document, line, 0, {-3, 0, 1})) << "behind the cameras";
  const auto picked = withPickAt(bench.document, line, {2}, 1, {300.25, 200.5});
  ASSERT_TRUE(picked.ok());
  EXPECT_EQ(picked->pick({2}, 1)->pixel, Vector2d(300.25, 200.5));
  EXPECT_EQ(picked->pick({2}, 1)->state, PickState::kReleased);
  EXPECT_FALSE(withPickAt(bench.document, line, {2}, 1, {1300, 200})) << "off the picture";
}

}  // namespace
}  // namespace longarm::session
