// What is drawn over a picture.
#include <gtest/gtest.h>

#include "session/commands/world_commands.h"
#include "session/document/overlay_builder.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using tests::Bench;
using tests::trueLine;
using vision::Overlay;
using vision::OverlayRole;
using vision::OverlayShape;

std::vector<OverlayShape> shapesOf(const Overlay& overlay, OverlayRole role) {
  std::vector<OverlayShape> found;
  for (const auto& shape : overlay.shapes) {
    if (shape.role == role) found.push_back(shape);
  }
  return found;
}

TEST(OverlayBuilder, DrawsASelectedLineWithHandlesLabelAndEllipses) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const Overlay overlay = buildOverlay(bench.document, SnapshotId{1});
  EXPECT_EQ(shapesOf(overlay, OverlayRole::kSelected).size(), 1u);
  EXPECT_EQ(shapesOf(overlay, OverlayRole::kHandle).size(), 2u);
  EXPECT_EQ(shapesOf(overlay, OverlayRole::kEllipse).size(), 2u);
  const auto labels = shapesOf(overlay, OverlayRole::kLabel);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_EQ(labels[0].text.rfind("Line 1  386.5 \u00b1 ", 0), 0u) << labels[0].text;
}

TEST(OverlayBuilder, DrawsOtherLinesPlainAndHiddenOnesNot) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.document.select({});
  const Overlay plain = buildOverlay(bench.document, SnapshotId{1});
  EXPECT_TRUE(shapesOf(plain, OverlayRole::kHandle).empty());
  EXPECT_EQ(shapesOf(plain, OverlayRole::kSketch).size(), 3u) << "an edge and two ends";
  bench.history.push(hideItem(bench.document, {1}, true));
  EXPECT_TRUE(buildOverlay(bench.document, SnapshotId{1}).shapes.empty());
}

TEST(OverlayBuilder, DrawsLockedLinesWithoutHandles) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(lockItem(bench.document, {1}, true));
  EXPECT_TRUE(shapesOf(buildOverlay(bench.document, SnapshotId{1}), OverlayRole::kHandle).empty());
}

TEST(OverlayBuilder, BendsTheEdgeAsTheLensDoes) {
  Bench bench;
  const vision::View& view = bench.scene.left;
  // A long edge far from the centre, where k1 = -0.25 bends most.
  const Eigen::Vector3d a{1.2, 0.55, 1.3}, b{1.2, -0.3, 1.3};
  const auto points = pictureOfEdge(view.camera, view.project(a).value(), view.project(b).value());
  double sag = 0, error = 0;
  const Eigen::Vector2d chord = (points.back() - points.front()).normalized();
  for (const auto& point : points) {
    const Eigen::Vector2d d = point - points.front();
    sag = std::max(sag, std::abs(chord.x() * d.y() - chord.y() * d.x()));
  }
  for (int i = 0; i <= 100; ++i) {
    const Eigen::Vector2d truth = view.project(a + (b - a) * (i / 100.0)).value();
    double nearest = 1e9;
    for (std::size_t k = 1; k < points.size(); ++k) {
      const Eigen::Vector2d ab = points[k] - points[k - 1];
      const double s = std::clamp((truth - points[k - 1]).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (points[k - 1] + s * ab - truth).norm());
    }
    error = std::max(error, nearest);
  }
  EXPECT_GT(sag, 2.0) << "a straight segment would be visibly wrong";
  EXPECT_LT(error, 0.1);
}

TEST(OverlayBuilder, DrawsADraftInPlaceOfItsItem) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  SketchItem draft = *bench.document.item({1});
  draft.setPick({1}, 0, {{50, 60}, PickState::kFree});
  OverlayOptions options;
  options.drafts = {&draft};
  options.active_item = {1};
  options.active_vertex = 0;
  options.active_snapshot = {1};
  const Overlay overlay = buildOverlay(bench.document, SnapshotId{1}, options);
  const auto active = shapesOf(overlay, OverlayRole::kActiveHandle);
  ASSERT_EQ(active.size(), 1u);
  EXPECT_EQ(active[0].points[0], Eigen::Vector2d(50, 60));
  EXPECT_EQ(shapesOf(overlay, OverlayRole::kSelected).size(), 1u) << "not drawn twice";
}

TEST(OverlayBuilder, ProjectsFeaturesIntoPicturesThatHoldNoPick) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  const vision::View third = tests::viewAt("wrist", {0.2, 0, 1.1}, 0);
  bench.history.push(addSnapshots(bench.document, {tests::snapshotOf(3, third)}));
  const Overlay overlay = buildOverlay(bench.document, SnapshotId{3});
  bool through_a = false;
  for (const auto& shape : overlay.shapes) {
    for (const auto& point : shape.points) {
      through_a |= (point - third.project(bench.scene.a).value()).norm() < 0.05;
    }
  }
  EXPECT_TRUE(through_a);
  // The same in a live picture of that camera.
  EXPECT_FALSE(buildOverlay(bench.document, third).shapes.empty());
}

TEST(OverlayBuilder, GivesAFeatureItsOwnColour) {
  Bench bench;
  bench.history.push(addItem(trueLine(bench, 1)));
  bench.history.push(colourItem(bench.document, {1}, 0x12ab34));
  for (const auto& shape : buildOverlay(bench.document, SnapshotId{1}).shapes) {
    EXPECT_EQ(shape.colour_rgb, shape.role == OverlayRole::kEllipse ? -1 : 0x12ab34);
  }
}

TEST(OverlayBuilder, DrawsThePathOnlyWhereItIsSeen) {
  Bench bench;
  const std::vector<Eigen::Vector3d> path = {{-1, 0, 1}, {1.5, 0.1, 1}, {1.6, -0.1, 1.1}};
  OverlayOptions options;
  options.path_points = &path;
  const auto pieces = shapesOf(buildOverlay(bench.document, SnapshotId{1}, options), OverlayRole::kPath);
  ASSERT_FALSE(pieces.empty());
  for (const auto& piece : pieces) {
    for (const auto& point : piece.points) EXPECT_TRUE(bench.scene.left.camera.containsPixel(point, 21));
  }
  options.path = false;
  EXPECT_TRUE(shapesOf(buildOverlay(bench.document, SnapshotId{1}, options), OverlayRole::kPath).empty());
}

std::vector<Eigen::Vector3d> levelPath() {
  std::vector<Eigen::Vector3d> path;
  for (int i = 0; i <= 40; ++i) path.push_back({1.6, 0.2 - 0.01 * i, 1});
  return path;
}

// The path is drawn by how near the motion comes to something, piece by piece without a gap.
TEST(OverlayBuilder, DrawsThePathByItsClearance) {
  Bench bench;
  const auto path = levelPath();
  OverlayOptions options;
  options.path_points = &path;
  PlanRecord record;
  record.macro = "test";
  record.plan.status = planning::PlanStatus::kOk;
  const Eigen::VectorXd one = Eigen::VectorXd::Zero(1);
  record.plan.trajectory = {{"j"}, {{0, one, one, one}, {4, one, one, one}}};
  record.plan.clearance = {{0, 0.09}, {1, 0.09}, {1.5, 0.03}, {2.5, 0.03}, {3, 0.01}, {4, 0.01}};
  bench.document.setPlan(record);
  const auto overlay = buildOverlay(bench.document, SnapshotId{1}, options);
  const auto free = shapesOf(overlay, OverlayRole::kPath), near = shapesOf(overlay, OverlayRole::kPathNear), tight = shapesOf(overlay, OverlayRole::kPathTight);
  ASSERT_EQ(free.size(), 1u);
  ASSERT_EQ(near.size(), 1u);
  ASSERT_EQ(tight.size(), 1u);
  EXPECT_EQ(free[0].points.back(), near[0].points.front());
  EXPECT_EQ(near[0].points.back(), tight[0].points.front());
  EXPECT_LT((tight[0].points.back() - *bench.scene.left.project(path.back())).norm(), 1e-9);
  EXPECT_LT((near[0].points.back() - *bench.scene.left.project(path[25])).norm(), 6) << "where the samples say so";
}

// A box before the middle of the path: what lies behind it is drawn as hidden, in snapshots and live, and it leaves no gap.
TEST(OverlayBuilder, DrawsWhatABodyHidesOfThePathAsHidden) {
  Bench bench;
  const auto path = levelPath();
  OverlayOptions options;
  options.path_points = &path;
  EXPECT_TRUE(shapesOf(buildOverlay(bench.document, SnapshotId{1}, options), OverlayRole::kPathOccluded).empty());
  WorldItem box;
  box.id = bench.document.nextWorldId();
  box.name = "crate";
  box.parent = bench.scene.left.parent;
  const Eigen::Vector3d eye = bench.scene.left.X_WC.translation();
  box.X_WO.translation() = eye + 0.7 * (path[20] - eye);
  box.size = {0.06, 0.06, 0.3};
  bench.history.push(addWorldItem(box));
  for (const auto& overlay : {buildOverlay(bench.document, SnapshotId{1}, options), buildOverlay(bench.document, bench.scene.left, options)}) {
    const auto seen = shapesOf(overlay, OverlayRole::kPath), hidden = shapesOf(overlay, OverlayRole::kPathOccluded);
    ASSERT_EQ(seen.size(), 2u);
    ASSERT_EQ(hidden.size(), 1u);
    EXPECT_EQ(seen[0].points.back(), hidden[0].points.front());
    EXPECT_EQ(hidden[0].points.back(), seen[1].points.front());
    const Eigen::Vector2d middle = *bench.scene.left.project(path[20]);
    EXPECT_LT((0.5 * (hidden[0].points.front() + hidden[0].points.back()) - middle).norm(), 15);
  }
  box.X_WO.translation() = eye + 1.3 * (path[20] - eye);
  bench.history.push(replaceWorldItem(bench.document, box));
  EXPECT_TRUE(shapesOf(buildOverlay(bench.document, SnapshotId{1}, options), OverlayRole::kPathOccluded).empty()) << "it stands behind";
}

TEST(OverlayBuilder, MarksWhereAPlanFailedWithItsCodeAndStage) {
  Bench bench;
  PlanRecord record;
  record.plan.status = planning::PlanStatus::kUnreachable;
  record.plan.failed_stage = "approach";
  record.plan.failed_pose = Pose(Eigen::Translation3d(1.5, 0.1, 1));
  bench.document.setPlan(record);
  for (const auto& overlay : {buildOverlay(bench.document, SnapshotId{1}), buildOverlay(bench.document, bench.scene.left)}) {
    const auto marks = shapesOf(overlay, OverlayRole::kWarning);
    ASSERT_EQ(marks.size(), 3u) << "a cross and a label";
    const Eigen::Vector2d middle = 0.5 * (marks[0].points[0] + marks[0].points[1]);
    EXPECT_LT((middle - *bench.scene.left.project({1.5, 0.1, 1})).norm(), 1e-9);
    EXPECT_EQ(marks[2].text, "unreachable, approach");
  }
  record.plan.failed_pose = Pose(Eigen::Translation3d(-1, 0, 1));
  bench.document.setPlan(record);
  EXPECT_TRUE(shapesOf(buildOverlay(bench.document, SnapshotId{1}), OverlayRole::kWarning).empty()) << "behind the camera";
}

TEST(OverlayBuilder, WarnsByTheLabelOfAPoorMeasurement) {
  Bench bench;
  // 40 m away the two rays part by 0.36 degrees.
  const Eigen::Vector3d far{40, 0.5, 2};
  SketchItem item;
  item.id = {1};
  item.name = "Point 1";
  item.setPick({1}, 0, {bench.scene.pixel(PaneSide::kLeft, far), PickState::kFree});
  item.setPick({2}, 0, {bench.scene.pixel(PaneSide::kRight, far), PickState::kConstrained});
  bench.history.push(addItem(item));
  ASSERT_TRUE(bench.document.measurement({1}).feature) << bench.document.measurement({1}).reason;
  EXPECT_EQ(shapesOf(buildOverlay(bench.document, SnapshotId{1}), OverlayRole::kWarning).size(), 1u);
}

TEST(OverlayBuilder, IsEmptyForAPictureThatIsNotThere) {
  Bench bench;
  EXPECT_TRUE(buildOverlay(bench.document, SnapshotId{77}).shapes.empty());
}

}  // namespace
}  // namespace longarm::session
