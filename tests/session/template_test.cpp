// Templates on the sketched world: where they stand, how they are kept, drawn and exported, and that undo is exact.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/text.h"
#include "session/commands/world_commands.h"
#include "session/document/document_file.h"
#include "session/document/face_frame.h"
#include "session/document/template_item.h"
#include "session/document/world_export.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using tests::Bench;

vision::Feature feature(vision::FeatureKind kind, const std::vector<Vector3d>& points) {
  vision::Feature out;
  out.name = "mark";
  out.kind = kind;
  for (const auto& p : points) {
    vision::FeatureVertex vertex;
    vertex.xyz = p;
    vertex.covariance = 1e-6 * Eigen::Matrix3d::Identity();
    out.vertices.push_back(vertex);
  }
  return out;
}

// The front of the scenario's cabinet door, its corners in whatever order an operator marks them.
vision::Feature doorFace(bool other_order = false) {
  const Vector3d a(0.93, 0.225, 0.88), b(0.93, 0.225, 0.22), c(0.93, -0.225, 0.22), d(0.93, -0.225, 0.88);
  auto out = other_order ? feature(vision::FeatureKind::kPlane, {c, d, a}) : feature(vision::FeatureKind::kPlane, {a, b, c});
  out.plane.emplace();
  out.plane->corners = other_order ? std::array<Vector3d, 4>{c, d, a, b} : std::array<Vector3d, 4>{a, b, c, d};
  out.plane->center = {0.93, 0, 0.55};
  out.plane->normal = {-1, 0, 0};
  return out;
}

const planning::ObjectTemplate& named(const std::string& name) {
  static const auto all = planning::loadTemplates({});
  for (const auto& each : all) {
    if (each.name() == name) return each;
  }
  ADD_FAILURE() << name;
  return all.front();
}

Eigen::Matrix3d seenFromTheRobot() {
  Eigen::Matrix3d R;
  R << -Vector3d::UnitY(), Vector3d::UnitZ(), -Vector3d::UnitX();
  return R;
}

TEST(FaceFrame, IsRightUpAndTowardsTheRobotWhateverIsMarked) {
  for (const bool other : {false, true}) {
    const auto plane = faceFrameOf(doorFace(other));
    ASSERT_TRUE(plane.ok());
    EXPECT_LT((plane->X_WT.linear() - seenFromTheRobot()).norm(), 1e-9);
    EXPECT_NEAR(*plane->extent[0], 0.45, 1e-9);
    EXPECT_NEAR(*plane->extent[1], 0.66, 1e-9);
    EXPECT_FALSE(plane->extent[2].has_value());
  }
  const auto point = faceFrameOf(feature(vision::FeatureKind::kPoint, {{0.9, 0, 0.5}}));
  EXPECT_LT((point->X_WT.linear() - seenFromTheRobot()).norm(), 1e-9);
  for (const double sign : {1.0, -1.0}) {
    const auto across = faceFrameOf(feature(vision::FeatureKind::kLine, {{0.8, 0.1 * sign, 0.5}, {0.8, -0.1 * sign, 0.5}}));
    EXPECT_LT((across->X_WT.linear() - seenFromTheRobot()).norm(), 1e-9);
    EXPECT_NEAR(*across->extent[0], 0.2, 1e-12);
    const auto upright = faceFrameOf(feature(vision::FeatureKind::kLine, {{0.8, 0, 0.5 + 0.1 * sign}, {0.8, 0, 0.5 - 0.1 * sign}}));
    EXPECT_LT((upright->X_WT.linear() - seenFromTheRobot()).norm(), 1e-9);
    EXPECT_NEAR(*upright->extent[1], 0.2, 1e-12);
  }
  auto box = feature(vision::FeatureKind::kTriad, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  box.box.emplace();
  box.box->size = {0.1, 0.2, 0.3};                 // z of the box points away from the robot, x up
  box.box->X_WB.linear() << Vector3d::UnitZ(), Vector3d::UnitY(), -Vector3d::UnitX();
  box.box->X_WB.translation() = Vector3d(0.9, 0, 0.4);
  const auto front = faceFrameOf(box);
  ASSERT_TRUE(front.ok()) << front.error().message;
  EXPECT_LT((front->X_WT.linear() - seenFromTheRobot()).norm(), 1e-9);
  EXPECT_LT((front->X_WT.translation() - Vector3d(0.75, 0, 0.4)).norm(), 1e-9) << "the face that looks at the robot";
  EXPECT_NEAR(*front->extent[0], 0.2, 1e-12);
  EXPECT_NEAR(*front->extent[1], 0.1, 1e-12);
  EXPECT_NEAR(*front->extent[2], 0.3, 1e-12);
  box.box->is_box = false;
  EXPECT_FALSE(faceFrameOf(box).ok());
}

TEST(TemplateItem, TakesPlaceAndSizesFromTheSketch) {
  const auto door = templateItemFrom(named("door"), doorFace());
  ASSERT_TRUE(door.ok()) << door.error().message;
  EXPECT_NEAR(door->parameters.at("width"), 0.45, 1e-9);
  EXPECT_NEAR(door->parameters.at("height"), 0.66, 1e-9);
  EXPECT_EQ(door->parameters.at("opening"), 0.6) << "what is not marked has its default";
  EXPECT_TRUE(checkWorldItem(*door).ok());
  const auto bodies = bodiesOf(*door, false);
  ASSERT_EQ(bodies.size(), 2u);
  EXPECT_LT((bodies[0].X_WO.translation() - Vector3d(0.94, 0, 0.55)).norm(), 1e-9);
  EXPECT_LT((bodies[1].X_WO.translation() - Vector3d(0.86, -0.16, 0.55)).norm(), 1e-9);
  const auto handle = featureOf(named("door"), *door, "handle");
  ASSERT_TRUE(handle.ok());
  EXPECT_LT(((handle->vertices[0].xyz + handle->vertices[1].xyz) / 2 - Vector3d(0.86, -0.16, 0.55)).norm(), 1e-9);
  EXPECT_GT(handle->vertices[0].covariance.trace(), 0) << "it is known no better than the mark";
  const auto refused = templateItemFrom(named("valve"), feature(vision::FeatureKind::kLine, {{1, 0, 0}, {1, 0, 1}}));
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("line"), std::string::npos);
}

TEST(TemplateItem, WhatMovesGoesWithTheToolAndTheRestIsKeptClearOf) {
  auto valve = *templateItemFrom(named("valve"), feature(vision::FeatureKind::kPoint, {{0.86, 0, 0.6}}));
  valve.id = {1};
  const auto all = obstaclesOf({valve}, "base_link", {});
  const auto fixed = obstaclesOf({valve}, "base_link", {}, {1});
  EXPECT_EQ(all.size(), 14u);
  ASSERT_EQ(fixed.size(), 1u);
  EXPECT_EQ(fixed.front().name, "valve.axle");
  EXPECT_TRUE(obstaclesOf({valve}, "world", {}).empty());
}

TEST(TemplateItem, EditsAreUndoneBitForBit) {
  Bench bench;
  auto door = *templateItemFrom(named("door"), doorFace());
  door.id = bench.document.nextWorldId();
  const auto before = bench.document.state();
  bench.history.push(addWorldItem(door));
  const auto dropped = bench.document.state();
  const auto wider = withParameters(named("door"), door, {{"width", 0.5}, {"opened", 0.4}});
  ASSERT_TRUE(wider.ok());
  EXPECT_NE(*wider, door);
  EXPECT_NE(hashOf(*wider), hashOf(door));
  bench.history.seal();
  bench.history.push(replaceWorldItem(bench.document, *wider));
  EXPECT_NE(bench.document.state(), dropped);
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), dropped);
  bench.history.undo();
  EXPECT_EQ(bench.document.state(), before);
  bench.history.redo();
  bench.history.redo();
  EXPECT_EQ(*bench.document.worldItem(door.id), *wider);
}

class TemplateFile : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(m_folder); }
  void TearDown() override { fs::remove_all(m_folder); }
  const fs::path m_folder = fs::temp_directory_path() / ("longarm_template_" + std::to_string(::getpid()));
};

TEST_F(TemplateFile, IsKeptInTheSketchAndWritten) {
  DocumentState state;
  auto door = *templateItemFrom(named("door"), doorFace());
  door.id = {3};
  state.world = {door};
  ASSERT_TRUE(saveSketch(m_folder.string(), state).ok());
  const auto loaded = loadSketch(m_folder.string());
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  ASSERT_EQ(loaded->world.size(), 1u);
  const auto& again = loaded->world.front();
  EXPECT_EQ(again.template_name, "door");
  EXPECT_EQ(again.parameters, door.parameters);
  ASSERT_EQ(again.parts.size(), door.parts.size());
  for (std::size_t i = 0; i < door.parts.size(); ++i) {
    EXPECT_EQ(again.parts[i].moves, door.parts[i].moves);
    EXPECT_LT((again.parts[i].X_TP.matrix() - door.parts[i].X_TP.matrix()).norm(), 1e-12);
  }
  const auto told = nlohmann::json::parse(worldAsJson({door}));
  EXPECT_EQ(told["objects"][0]["template"], "door");
  EXPECT_EQ(told["objects"][0]["parts"].size(), 2u);
  EXPECT_NE(worldAsObj({door}).find("o door.handle"), std::string::npos);
  // Damaged: told, not taken.
  const auto file = (m_folder / "sketch.json").string();
  auto json = nlohmann::json::parse(*readTextFile(file, 1 << 20));
  for (const char* key : {"template", "parts"}) {
    auto broken = json;
    broken["world"][0].erase(key);
    ASSERT_TRUE(writeFileAtomically(file, broken.dump()).ok());
    EXPECT_FALSE(loadSketch(m_folder.string()).ok()) << key;
  }
  json["world"][0]["parts"][0]["box"] = {0.1, -1, 0.1};
  ASSERT_TRUE(writeFileAtomically(file, json.dump()).ok());
  EXPECT_FALSE(loadSketch(m_folder.string()).ok());
}

TEST(TemplateItem, IsProjectedOverTheRealThing) {
  Bench bench;
  auto crate = *templateItemFrom(named("crate"), feature(vision::FeatureKind::kPoint, {bench.scene.a}));
  crate.parent = bench.scene.left.parent;
  vision::Overlay overlay;
  addWorldItem(crate, bench.scene.left, &overlay);
  ASSERT_FALSE(overlay.shapes.empty());
  Eigen::AlignedBox2d drawn, expected;
  for (const auto& shape : overlay.shapes) {
    for (const auto& p : shape.points) drawn.extend(p);
  }
  const auto& box = std::get<planning::Box>(crate.parts[0].shape);
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner((i & 1 ? 0.5 : -0.5) * box.size.x(), (i & 2 ? 0.5 : -0.5) * box.size.y(), (i & 4 ? 0.5 : -0.5) * box.size.z());
    expected.extend(*bench.scene.left.project(crate.X_WO * crate.parts[0].X_TP * corner));
  }
  EXPECT_NEAR((drawn.min() - expected.min()).norm(), 0, 1.5);
  EXPECT_NEAR((drawn.max() - expected.max()).norm(), 0, 1.5);
}

}  // namespace
}  // namespace longarm::session
