// Sketches that determine nothing, drawn on the real canvas: told on the spot with what to do, and never a feature.
#include <gtest/gtest.h>

#include "tests/ui/canvas_rig.h"

namespace longarm::ui {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using session::ToolKind;
using tests::CanvasRig;
using vision::PaneSide;

constexpr PaneSide kLeft = PaneSide::kLeft, kRight = PaneSide::kRight;
constexpr PaneSide kBoth[] = {kLeft, kRight};

class CanvasRefusal : public ::testing::TestWithParam<double> {
 protected:
  CanvasRefusal() : rig(GetParam()) {}
  void SetUp() override { rig.openPair(); }
  void clickAll(ToolKind tool, const std::vector<Vector3d>& places) {
    rig.targeting().setTool(tool);
    for (const PaneSide side : kBoth) {
      for (const auto& place : places) rig.click(side, rig.seen(side, place));
    }
  }
  /// No feature; the line below the pictures says why and what to do, and the label in the picture that it is not measured.
  void expectRefused(const QString& why, const QString& what_to_do) {
    ASSERT_EQ(rig.document().items().size(), 1U);
    EXPECT_FALSE(rig.measured().feature);
    EXPECT_EQ(rig.targeting().tool(), ToolKind::kSelect) << "the gesture itself went through";
    const QString said = rig.targeting().hint();
    EXPECT_TRUE(said.contains(why)) << said.toStdString();
    EXPECT_TRUE(said.contains(what_to_do)) << said.toStdString();
    const auto live = rig.targeting().liveMeasure();
    ASSERT_TRUE(live);
    EXPECT_TRUE(live->refused);
    EXPECT_EQ(live->text().rfind("Not measured: ", 0), 0U) << live->text();
    bool labelled = false;
    for (const auto& shape : rig.targeting().overlay(kLeft).shapes) {
      labelled = labelled || (shape.role == vision::OverlayRole::kWarning && shape.text.find("not measured") != std::string::npos);
    }
    EXPECT_TRUE(labelled);
  }

  CanvasRig rig;
};
INSTANTIATE_TEST_SUITE_P(Zooms, CanvasRefusal, ::testing::ValuesIn(tests::kZooms));

TEST_P(CanvasRefusal, CornersOfAPlaneInLine) {
  const Vector3d a = rig.scene.a, b = rig.scene.b;
  clickAll(ToolKind::kPlane, {a, (a + b) / 2, b});
  expectRefused(QStringLiteral("plane"), QStringLiteral("right angle"));
}

TEST_P(CanvasRefusal, EdgesOfATriadInOnePlane) {
  const Vector3d o(1.4, 0, 1);
  clickAll(ToolKind::kTriad, {o, o + Vector3d(0, 0.2, 0), o + Vector3d(0, 0, 0.2), o + Vector3d(0, 0.16, -0.14)});
  expectRefused(QStringLiteral("in one plane"), QStringLiteral("mark three edges that meet at right angles"));
}

TEST_P(CanvasRefusal, AnEdgeThatPointsAtTheCamera) {
  const Vector3d o(1.4, 0, 1);
  clickAll(ToolKind::kTriad, {o, o + Vector3d(0.5, 0, 0), o + Vector3d(0, 0.2, 0), o + Vector3d(0, 0, 0.2)});
  expectRefused(QStringLiteral("points at the camera"), QStringLiteral("from the side"));
}

TEST_P(CanvasRefusal, APipeAlongTheBaseline) {
  const tests::TruePipe along{{1.5, 0.15, 1.05}, {1.5, -0.15, 1.05}};
  rig.targeting().setTool(ToolKind::kPipe);
  for (const PaneSide side : kBoth) {
    const auto ends = along.outlines(rig.scene.view(side));
    rig.drag(side, ends[0], ends[1]);
    rig.drag(side, ends[2], ends[3]);
  }
  expectRefused(QStringLiteral("baseline"), QStringLiteral("move the camera across"));
}

TEST_P(CanvasRefusal, RaysThatMeetBehindTheCameras) {
  // Further apart than the cameras turned inwards see anything: the place would be behind them.
  const Vector2d left = rig.seen(kLeft, rig.scene.a), right = rig.seen(kRight, rig.scene.a);
  rig.targeting().setTool(ToolKind::kPoint);
  rig.click(kLeft, left);
  rig.click(kRight, right + Vector2d(230, 0), Qt::ControlModifier);
  expectRefused(QStringLiteral("behind"), QStringLiteral("mark"));
}

TEST_P(CanvasRefusal, LinesWhoseEndsAreOneSpot) {
  clickAll(ToolKind::kLine, {rig.scene.a, rig.scene.a});
  ASSERT_EQ(rig.document().items().size(), 1U);
  EXPECT_FALSE(rig.measured().feature) << "a line of no length";
}

TEST_P(CanvasRefusal, ClicksAndStrokesOffThePicture) {
  for (const ToolKind tool : {ToolKind::kPoint, ToolKind::kLine, ToolKind::kPipe, ToolKind::kPlane, ToolKind::kTriad}) {
    rig.targeting().setTool(tool);
    const Vector2d off(tests::kWidth + 3 + 3 / GetParam(), 100);
    rig.click(kLeft, off);
    EXPECT_TRUE(rig.targeting().hint().contains(QStringLiteral("off the picture"))) << rig.targeting().hint().toStdString();
    EXPECT_TRUE(rig.targeting().hint().contains(QStringLiteral("turn the camera")));
    rig.drag(kLeft, off, {300, 200});
    EXPECT_TRUE(rig.document().items().empty());
    EXPECT_EQ(rig.targeting().tool(), tool) << "ready for the next press";
  }
  rig.targeting().setTool(ToolKind::kPoint);
  rig.click(kLeft, {100, 100});
  EXPECT_EQ(rig.document().items().size(), 1U);
  EXPECT_FALSE(rig.targeting().hint().contains(QStringLiteral("off the picture")));
}

TEST_P(CanvasRefusal, ADragThatLeavesThePictureStaysOnItAndSaysSo) {
  rig.targeting().setTool(ToolKind::kPoint);
  auto* canvas = rig.canvas(kLeft);
  rig.hand.press(canvas, rig.on(kLeft, {600, 100}));
  const QPointF off = rig.on(kLeft, Vector2d(tests::kWidth + 3 + 3 / GetParam(), 100));
  rig.hand.dragTo(canvas, off);
  EXPECT_TRUE(rig.targeting().hint().contains(QStringLiteral("picture ends here"))) << rig.targeting().hint().toStdString();
  rig.hand.release(canvas, off);
  EXPECT_LT((rig.pick(kLeft) - Vector2d(tests::kWidth - 1, 100)).norm(), 1e-6);
}

}  // namespace
}  // namespace longarm::ui
