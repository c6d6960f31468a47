// A base that was driven: what is stale, and how marks made again bring everything back.
#include <random>

#include <gtest/gtest.h>

#include "session/commands/world_commands.h"
#include "session/document/feature_rows.h"
#include "session/document/overlay_builder.h"
#include "session/document/standing_items.h"
#include "session/commands/reregistration.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

using Eigen::Vector3d;
using tests::snapshotOf;
using tests::StereoScene;

SnapshotPtr takenAt(std::uint64_t id, const vision::View& view, const BaseState& base) {
  auto snapshot = std::make_shared<vision::Snapshot>(*snapshotOf(id, view));
  snapshot->base = base;
  return snapshot;
}

// Pictures 1 and 2 from the start, 3 and 4 from where the base has gone to.
class Driven : public ::testing::Test {
 protected:
  void SetUp() override {
    m_history.push(addSnapshots(m_document, {takenAt(1, m_scene.left, {}), takenAt(2, m_scene.right, {})}));
    m_document.setBase(BaseState{});
  }
  BaseState gone() const {
    BaseState there;
    there.x = 0.30;
    there.y = -0.05;
    there.yaw = 0.07;
    return there;
  }
  // The robot's own odometry is off by a centimetre: what counts is what is marked.
  Pose truth() const { return poseFromRpy({0.31, -0.055, 0}, {0, 0, 0.072}); }
  void drive() {
    m_document.setBase(gone());
    m_history.push(
        addSnapshots(m_document, {takenAt(3, m_scene.left, gone()), takenAt(4, m_scene.right, gone())}));
  }
  // A point of the world of then, marked in the pictures of then or of now.
  void mark(SketchItem& item, int vertex, const Vector3d& p, bool now) const {
    const Vector3d seen = now ? Vector3d(truth().inverse() * p) : p;
    for (const auto side : {PaneSide::kLeft, PaneSide::kRight}) {
      const SnapshotId id{(now ? 3U : 1U) + static_cast<unsigned>(side)};
      item.setPick(id, vertex, {m_scene.pixel(side, seen), PickState::kFree});
    }
  }
  FeatureId add(const std::string& name, const std::vector<Vector3d>& points, bool now = false) {
    SketchItem item;
    item.id = m_document.nextFeatureId();
    item.kind = points.size() == 1 ? vision::FeatureKind::kPoint : vision::FeatureKind::kLine;
    item.name = name;
    for (std::size_t i = 0; i < points.size(); ++i) mark(item, static_cast<int>(i), points[i], now);
    m_history.push(addItem(item));
    return item.id;
  }
  void again(FeatureId id, const std::vector<Vector3d>& points) {
    SketchItem item = *m_document.item(id);
    for (std::size_t i = 0; i < points.size(); ++i) mark(item, static_cast<int>(i), points[i], true);
    m_history.push(replaceItem(m_document, item, "Mark again"));
  }
  Vector3d at(FeatureId id, int vertex = 0) const {
    return m_document.measurement(id).feature->vertices[static_cast<std::size_t>(vertex)].xyz;
  }

  StereoScene m_scene;
  Document m_document;
  EditHistory m_history{m_document};
  const Vector3d m_a{1.5, 0.2, 1.05}, m_b{1.6, -0.15, 0.92}, m_c{1.7, 0.1, 0.85}, m_d{1.45, -0.05, 1.1};
};

// An obstacle of before does not go with the base: planning keeps clear of where odometry has it, by more the further it went.
TEST_F(Driven, AStaleBodyStandsWhereOdometryHasIt) {
  WorldItem body;
  body.id = m_document.nextWorldId();
  body.name = "crate";
  body.X_WO.translation() = Vector3d(1.2, 0.1, 0.4);
  body.margin_m = 0.01;
  body.base = BaseState{};
  WorldItem cloud = body;
  cloud.id = {body.id.value + 1};
  cloud.kind = WorldKind::kPoints;
  cloud.points = {{1.2, 0.1, 0.4}};
  WorldItem unknown = body;
  unknown.id = {body.id.value + 2};
  unknown.base.reset();
  for (const auto& item : {body, cloud, unknown}) m_history.push(addWorldItem(item));
  EXPECT_EQ(standingItems(m_document), m_document.world()) << "nothing is stale";
  m_document.setBase(gone());
  const auto standing = standingItems(m_document);
  ASSERT_EQ(standing.size(), 3u);
  const Vector3d expected = poseFromRpy({0.30, -0.05, 0}, {0, 0, 0.07}).inverse() * Vector3d(1.2, 0.1, 0.4);
  EXPECT_LT((standing[0].X_WO.translation() - expected).norm(), 1e-12);
  EXPECT_LT((standing[1].points.front() - expected).norm(), 1e-12);
  EXPECT_NEAR(standing[0].margin_m, 0.01 + 0.02 * (std::hypot(0.30, 0.05) + 0.07 * expected.norm()), 1e-9);
  EXPECT_EQ(standing[2], unknown) << "nobody knows from where it was measured";
  EXPECT_TRUE(m_document.world().front().X_WO.isApprox(body.X_WO)) << "the document's own stays, for marks made again";
}

TEST_F(Driven, WhatWasMeasuredBeforeIsMarkedEverywhere) {
  const FeatureId line = add("Line 1", {m_a, m_b});
  WorldItem body;
  body.id = m_document.nextWorldId();
  body.name = "crate";
  body.base = m_document.baseOf(line);
  m_history.push(addWorldItem(body));
  EXPECT_FALSE(m_document.measurement(line).stale);
  BaseState little;
  little.x = 0.009;
  little.yaw = 0.4 * M_PI / 180;
  m_document.setBase(little);
  EXPECT_FALSE(m_document.measurement(line).stale) << "within 10 mm and half a degree";
  std::vector<ChangeKind> told;
  m_document.observe([&told](const Change& change) { told.push_back(change.kind); });
  m_document.setBase(gone());
  EXPECT_EQ(told, (std::vector<ChangeKind>{ChangeKind::kItemChanged, ChangeKind::kWorldChanged}));
  EXPECT_TRUE(m_document.measurement(line).stale);
  EXPECT_TRUE(m_document.stale(*m_document.worldItem(body.id)));
  EXPECT_TRUE(featureRows(m_document).front().stale);
  bool said = false;
  for (const auto& shape : buildOverlay(m_document, {1}, {}).shapes)
    said = said || shape.text.find("stale") != std::string::npos;
  EXPECT_TRUE(said) << "in the panes";
  m_document.setBase(BaseState{});
  EXPECT_FALSE(m_document.measurement(line).stale) << "driven back";
}

TEST_F(Driven, PicturesOfTwoPlacesAreNotMeasuredTogether) {
  const FeatureId id = add("Point 1", {m_a});
  drive();
  EXPECT_TRUE(m_document.measurement(id).stale);
  SketchItem item = *m_document.item(id);
  item.setPick({3}, 0, {m_scene.pixel(PaneSide::kLeft, truth().inverse() * m_a), PickState::kFree});
  m_history.push(replaceItem(m_document, item, "Mark"));
  EXPECT_TRUE(m_document.measurement(id).stale) << "one new picture measures nothing";
  EXPECT_LT((at(id) - m_a).norm(), 1e-6);
  again(id, {m_a});
  EXPECT_FALSE(m_document.measurement(id).stale);
  EXPECT_LT((at(id) - truth().inverse() * m_a).norm(), 1e-6) << "where it is now";
}

TEST_F(Driven, NeedsThreeMarksThatAreNotInALine) {
  const FeatureId a = add("Point 1", {m_a}), b = add("Point 2", {m_b}),
                  c = add("Point 3", {0.5 * (m_a + m_b)});
  EXPECT_EQ(findRegistration(m_document).error().code, ErrorCode::kRefused) << "nothing is stale";
  drive();
  EXPECT_NE(findRegistration(m_document).error().message.find("0 of 3"), std::string::npos);
  again(a, {m_a});
  again(b, {m_b});
  EXPECT_NE(findRegistration(m_document).error().message.find("2 of 3"), std::string::npos);
  again(c, {0.5 * (m_a + m_b)});
  EXPECT_EQ(findRegistration(m_document).error().code, ErrorCode::kDegenerate)
      << findRegistration(m_document).error().message;
}

TEST_F(Driven, MovesEverythingStaleInOneStepAndBackAgain) {
  const FeatureId a = add("Point 1", {m_a}), b = add("Point 2", {m_b}), d = add("Point 3", {m_d});
  const FeatureId line = add("Line 1", {m_c, m_a});
  WorldItem body;
  body.id = m_document.nextWorldId();
  body.name = "crate";
  body.X_WO.translation() = m_c;
  body.base = m_document.baseOf(line);
  m_history.push(addWorldItem(body));
  drive();
  for (const auto& [id, p] : {std::pair(a, m_a), std::pair(b, m_b), std::pair(d, m_d)}) again(id, {p});
  const auto found = findRegistration(m_document);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->marks, 3);
  EXPECT_EQ(found->features, 1) << "the line; what was marked again is not stale";
  EXPECT_LT(found->residual_rms, 1e-5);
  EXPECT_LT((found->X_now_then.translation() - truth().inverse().translation()).norm(), 1e-4);
  const DocumentState before = m_document.state();
  m_history.push(applyRegistration(m_document, *found));
  EXPECT_FALSE(m_document.measurement(line).stale);
  EXPECT_LT((at(line) - truth().inverse() * m_c).norm(), 1e-4);
  EXPECT_LT((m_document.worldItem(body.id)->X_WO.translation() - truth().inverse() * m_c).norm(), 1e-4);
  EXPECT_FALSE(m_document.stale(*m_document.worldItem(body.id)));
  EXPECT_GT(m_document.measurement(line).feature->vertices[0].covariance.trace(), 0);
  m_history.undo();
  EXPECT_EQ(m_document.state(), before);
  EXPECT_TRUE(m_document.measurement(line).stale);
  EXPECT_LT((at(line) - m_c).norm(), 1e-6);
}

TEST_F(Driven, NewFeaturesUnderTheSameNamesAreMarksToo) {
  const FeatureId line = add("Line 1", {m_a, m_b});
  add("Point 1", {m_d});
  drive();
  add("Line 1", {m_a, m_b}, true);
  add("Point 1", {m_d}, true);
  const auto found = findRegistration(m_document);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->marks, 3);
  m_history.push(applyRegistration(m_document, *found));
  EXPECT_LT((at(line, 1) - truth().inverse() * m_b).norm(), 1e-4);
}

TEST_F(Driven, AMarkOnAnotherSpotIsNoticed) {
  const FeatureId a = add("Point 1", {m_a}), b = add("Point 2", {m_b}), c = add("Point 3", {m_c});
  drive();
  again(a, {m_a});
  again(b, {m_b + Vector3d(0, 0.25, 0)});
  again(c, {m_c});
  EXPECT_EQ(findRegistration(m_document).error().code, ErrorCode::kNoSolution)
      << findRegistration(m_document).error().message;
}

// The stated covariance must be that of the answers: 200 noisy fits of four marks.
TEST(Registration, ItsCovarianceIsTheSpreadOfItsAnswers) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.002);
  const Pose truth = poseFromRpy({0.3, -0.1, 0.01}, {0.01, -0.02, 0.2});
  const std::vector<Vector3d> points{{1, 0, 1}, {1.3, 0.4, 0.8}, {1.1, -0.5, 1.2}, {1.6, 0.1, 0.5}};
  const Eigen::Matrix3d each = 4e-6 * Eigen::Matrix3d::Identity();
  double normalised = 0;
  const int runs = 200;
  for (int run = 0; run < runs; ++run) {
    std::vector<MarkedTwice> marks;
    const auto shaken = [&](const Vector3d& p) {
      return Vector3d(p + Vector3d(noise(random), noise(random), noise(random)));
    };
    for (const auto& p : points) marks.push_back({"p", shaken(p), shaken(truth * p), each, each});
    const auto found = fitMarks(marks);
    ASSERT_TRUE(found.ok()) << found.error().message;
    Eigen::Matrix<double, 6, 1> off;
    off << logSO3(found->X_now_then.linear() * truth.linear().transpose()),
        found->X_now_then.translation() - truth.translation();
    normalised += off.dot(found->covariance.ldlt().solve(off)) / runs;
    EXPECT_LT(found->residual_rms, 0.01);
  }
  EXPECT_GT(normalised, 3) << "six degrees of freedom; the covariance only ever grows with a bad fit";
  EXPECT_LT(normalised, 7);
}

}  // namespace
}  // namespace longarm::session
