// Plane and triad tools: whole gestures on two synthetic cameras, measured against the truth.
#include <gtest/gtest.h>

#include "session/document/feature_rows.h"
#include "session/tools/plane_tool.h"
#include "session/tools/triad_tool.h"
#include "tests/session/true_shapes.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::Hand;
using vision::OverlayRole;

using Case = std::tuple<double, PaneSide, ToolKind>;
class ShapeGesture : public testing::TestWithParam<Case> {};

TEST_P(ShapeGesture, MeasuresTheTrueShapeInOneStepPerClick) {
  const auto [zoom, first, kind] = GetParam();
  Bench bench;
  Hand hand(bench.tools, zoom);
  bench.tools.setTool(kind);
  const auto truth = tests::trueCorners(kind);
  std::size_t clicks = 0;
  for (const PaneSide side : {first, otherSide(first)}) {
    for (const auto& corner : truth) {
      EXPECT_FALSE(bench.tools.hint().empty());
      hand.click(side, bench.scene.pixel(side, corner));
      EXPECT_EQ(bench.history.size(), ++clicks) << "one gesture is one command";
    }
  }
  EXPECT_EQ(bench.tools.tool(), ToolKind::kSelect) << "finished";
  ASSERT_EQ(bench.document.items().size(), 1u);
  const auto& item = bench.document.items().front();
  const auto& measured = bench.document.measurement(item.id);
  ASSERT_TRUE(measured.feature) << measured.reason;
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_LT((measured.feature->vertices[i].xyz - truth[i]).norm(), 1e-3) << i;
  const FeatureRow row = featureRow(item, measured);
  if (kind == ToolKind::kPlane) {
    ASSERT_TRUE(measured.feature->plane);
    EXPECT_GT(std::abs(measured.feature->plane->normal.dot(tests::shapeTurn().col(0))), 0.9999);
  } else {
    ASSERT_TRUE(measured.feature->box);
    EXPECT_LT((measured.feature->box->size - Eigen::Vector3d(0.25, 0.2, 0.15)).norm(), 1e-3);
    EXPECT_EQ(row.length_text, "250 \u00d7 200 \u00d7 150 mm");
    EXPECT_GT(row.size_plus_minus->minCoeff(), 0);
    EXPECT_NE(row.size_text.find(" \u00b1 "), std::string::npos) << row.size_text;
  }
  const DocumentState done = bench.document.state();
  while (bench.history.canUndo()) bench.history.undo();
  EXPECT_TRUE(bench.document.items().empty());
  while (bench.history.canRedo()) bench.history.redo();
  EXPECT_EQ(bench.document.state(), done);
}

INSTANTIATE_TEST_SUITE_P(AtAnyZoomEitherPaneFirst, ShapeGesture,
                         testing::Combine(testing::Values(0.25, 1.0, 4.0), testing::Values(PaneSide::kLeft, PaneSide::kRight),
                                          testing::Values(ToolKind::kPlane, ToolKind::kTriad)));

TEST(TriadTool, ACopyLiesInBothPicturesWithItsThreeEdges) {
  Bench bench;
  const DocumentState before = bench.document.state();
  bench.tools.setTool(ToolKind::kTriad);
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    int edges = 0;
    for (const auto& shape : bench.tools.overlay(side).shapes) {
      edges += shape.role == OverlayRole::kUnplaced && shape.kind == vision::OverlayShape::Kind::kPolyline ? 1 : 0;
    }
    EXPECT_EQ(edges, 3);
  }
  EXPECT_EQ(bench.document.state(), before) << "nothing is written before the first gesture";
}

TEST(PlaneTool, CornersInLineMakeNoFeatureAndSayWhatToDo) {
  Bench bench;
  Hand hand(bench.tools);
  bench.tools.setTool(ToolKind::kPlane);
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    for (const double s : {0.0, 0.5, 1.0}) {
      hand.click(side, bench.scene.pixel(side, bench.scene.a + s * (bench.scene.b - bench.scene.a)));
    }
  }
  ASSERT_EQ(bench.document.items().size(), 1u);
  const auto& measured = bench.document.measurement(bench.document.items().front().id);
  EXPECT_FALSE(measured.feature);
  EXPECT_NE(measured.reason.find("right angle"), std::string::npos) << measured.reason;
}

}  // namespace
}  // namespace longarm::session
