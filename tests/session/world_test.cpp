// The sketched world: from features to bodies, files, pictures and plans; every edit undone bit for bit.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/text.h"
#include "planning/macros/grab_pipe.h"
#include "planning/world/mesh_file.h"
#include "session/commands/world_commands.h"
#include "session/document/document_file.h"
#include "session/document/overlay_builder.h"
#include "session/document/world_export.h"
#include "tests/session/synthetic_views.h"

namespace longarm::session {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using tests::Bench;

vision::Feature boxFeature() {
  vision::Feature feature;
  feature.name = "Triad 1";
  feature.kind = vision::FeatureKind::kTriad;
  feature.vertices.resize(4);
  for (auto& vertex : feature.vertices) vertex.covariance = 4e-6 * Eigen::Matrix3d::Identity();
  feature.box.emplace();
  feature.box->size = {0.3, 0.2, 0.15};
  feature.box->X_WB.translation() = Vector3d(1.4, 0.05, 1.0);
  feature.box->X_WB.linear() = expSO3({0.1, -0.2, 0.5});
  return feature;
}

vision::Feature pipeFeature() {
  vision::Feature feature;
  feature.name = "Pipe 1";
  feature.kind = vision::FeatureKind::kLine;
  feature.vertices.resize(2);
  feature.vertices[0].xyz = {1.2, -0.2, 0.9};
  feature.vertices[1].xyz = {1.2, 0.3, 1.1};
  feature.pipe.emplace();
  feature.pipe->radius = 0.03;
  feature.pipe->radius_sigma = 0.001;
  return feature;
}

vision::Feature planeFeature() {
  vision::Feature feature;
  feature.name = "Plane 1";
  feature.kind = vision::FeatureKind::kPlane;
  feature.vertices.resize(3);
  feature.plane.emplace();
  feature.plane->corners = {Vector3d(1, 0, 1.2), Vector3d(1, 0, 1), Vector3d(1, 0.3, 1), Vector3d(1, 0.3, 1.2)};
  feature.plane->center = {1, 0.15, 1.1};
  feature.plane->normal = {-1, 0, 0};
  return feature;
}

vision::Feature pointFeature(const Vector3d& at) {
  vision::Feature feature;
  feature.name = "Point 1";
  feature.vertices.resize(1);
  feature.vertices[0].xyz = at;
  return feature;
}

std::vector<WorldItem> oneOfEach() {
  std::vector<WorldItem> items{worldItemFrom(boxFeature()).value(), worldItemFrom(planeFeature()).value(), worldItemFrom(pipeFeature()).value(),
                               worldPointsFrom({pointFeature({1, 0.1, 1}), pointFeature({1.1, -0.1, 1.05})})};
  for (std::size_t i = 0; i < items.size(); ++i) items[i].id = {i + 1};
  return items;
}

TEST(WorldItem, TakesABoxAsItWasMeasuredAndItsUncertaintyAsMargin) {
  const WorldItem item = worldItemFrom(boxFeature()).value();
  EXPECT_EQ(item.kind, WorldKind::kBox);
  EXPECT_EQ(item.size, Vector3d(0.3, 0.2, 0.15));
  EXPECT_NEAR(item.margin_m, 1.96 * 0.002, 1e-6);
  const auto bodies = bodiesOf(item, true);
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_NEAR(std::get<planning::Box>(bodies[0].shape).size.x(), 0.3 + 2 * item.margin_m, 1e-12);
}

TEST(WorldItem, PutsASlabBehindTheMarkedFace) {
  const WorldItem item = worldItemFrom(planeFeature()).value();
  EXPECT_NEAR(item.size.x(), 0.2, 1e-12);
  EXPECT_NEAR(item.size.y(), 0.3, 1e-12);
  const Vector3d front = item.X_WO * Vector3d(0, 0, item.size.z() / 2);
  EXPECT_NEAR(front.x(), 1.0, 1e-12) << "its front is the face";
  EXPECT_GT(item.X_WO.translation().x(), 1.0) << "and it lies away from the cameras";
}

TEST(WorldItem, TakesAPipesAxisAndRadius) {
  const WorldItem item = worldItemFrom(pipeFeature()).value();
  const auto cylinder = std::get<planning::Cylinder>(bodiesOf(item, false)[0].shape);
  EXPECT_DOUBLE_EQ(cylinder.radius, 0.03);
  EXPECT_NEAR(cylinder.length, pipeFeature().length(), 1e-12);
  EXPECT_NEAR((item.X_WO * Vector3d(0, 0, cylinder.length / 2) - pipeFeature().vertices[1].xyz).norm(), 0, 1e-12);
  EXPECT_NEAR(item.margin_m, 1.96e-3, 1e-6) << "the radius' uncertainty is part of it";
}

TEST(MeasuredPipe, IsGrabbedByTheRadiusOfItsOutlinesNotByTheAssumedOne) {
  const auto workcell = planning::loadBuiltInWorkcell();
  ASSERT_TRUE(workcell.ok()) << workcell.error().message;
  planning::PlanContext context;
  context.workcell = &*workcell;
  context.start = workcell->model->neutral();
  context.budget_s = 5;
  vision::Feature pipe = pipeFeature();
  pipe.pipe->radius = 0.15;
  const planning::Plan refused = planning::GrabPipe().plan(context, &pipe);
  EXPECT_FALSE(refused.ok());
  EXPECT_NE(refused.reason.find(" thick"), std::string::npos) << refused.reason;
  pipe.pipe.reset();
  EXPECT_EQ(planning::GrabPipe().plan(context, &pipe).reason.find(" thick"), std::string::npos);
}

TEST(WorldItem, RefusesWhatHasNoBodyAndSaysWhatToMark) {
  vision::Feature line = pipeFeature();
  line.pipe.reset();
  EXPECT_NE(worldItemFrom(line).error().message.find("pipe tool"), std::string::npos);
  vision::Feature skewed = boxFeature();
  skewed.box->is_box = false;
  EXPECT_FALSE(worldItemFrom(skewed));
  WorldItem item = worldItemFrom(boxFeature()).value();
  item.size.x() = 0;
  EXPECT_NE(checkWorldItem(item).error().message.find("0.001"), std::string::npos) << "names the limit";
  item = worldItemFrom(boxFeature()).value();
  item.margin_m = -0.01;
  EXPECT_FALSE(checkWorldItem(item));
}

TEST(WorldItem, IsAnObstacleOnlyInItsFrameAndNotForTheFeatureItCameFrom) {
  auto items = oneOfEach();
  items[0].source = {7};
  items[1].role = WorldRole::kDrawn;
  EXPECT_EQ(obstaclesOf(items, "base_link", {}).size(), 4U) << "box, pipe, two points";
  EXPECT_EQ(obstaclesOf(items, "base_link", {7}).size(), 3U);
  EXPECT_TRUE(obstaclesOf(items, "elsewhere", {}).empty());
}

TEST(WorldItem, ZonesHoldForTheFeatureTheyCameFromAndAWorkspaceLosesItsMargin) {
  auto items = oneOfEach();
  items[0].source = {7};
  items[0].role = WorldRole::kKeepOut;
  EXPECT_EQ(obstaclesOf(items, "base_link", {7}).size(), obstaclesOf(items, "base_link", {}).size());
  EXPECT_EQ(obstaclesOf(items, "base_link", {7})[0].role, planning::BodyRole::kKeepOut);
  WorldItem room = workspaceAround({0, 0, 0.4}, 1.2, "base_link");
  room.margin_m = 0.05;
  ASSERT_TRUE(checkWorldItem(room));
  EXPECT_NEAR(std::get<planning::Box>(obstaclesOf({room}, "base_link", {})[0].shape).size.x(), 2.3, 1e-12);
  room.kind = WorldKind::kPipe;
  EXPECT_NE(checkWorldItem(room).error().message.find("cannot be a workspace"), std::string::npos);
}

TEST(WorldItem, IsProjectedOverTheTrueBoxInEveryView) {
  Bench bench;
  WorldItem item = worldItemFrom(boxFeature()).value();
  item.id = bench.document.nextWorldId();
  bench.history.push(addWorldItem(item));
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    const auto overlay = buildOverlay(bench.document, bench.snapshot(side));
    std::vector<Eigen::Vector2d> corners;
    for (int i = 0; i < 8; ++i) {
      const Vector3d at((i & 1) != 0 ? 0.15 : -0.15, (i & 2) != 0 ? 0.1 : -0.1, (i & 4) != 0 ? 0.075 : -0.075);
      corners.push_back(bench.scene.pixel(side, item.X_WO * at));
    }
    int edges = 0, areas = 0;
    for (const auto& shape : overlay.shapes) {
      if (shape.role != vision::OverlayRole::kWorld) continue;
      areas += shape.kind == vision::OverlayShape::Kind::kArea ? 1 : 0;
      if (shape.kind != vision::OverlayShape::Kind::kPolyline) continue;
      ++edges;
      for (const auto& end : {shape.points.front(), shape.points.back()}) {
        double nearest = 1e9;
        for (const auto& corner : corners) nearest = std::min(nearest, (corner - end).norm());
        EXPECT_LT(nearest, 0.01);
      }
    }
    EXPECT_EQ(edges, 12);
    EXPECT_EQ(areas, 1);
  }
}

TEST(WorldCommands, UndoBitForBit) {
  Bench bench;
  std::vector<DocumentState> states{bench.document.state()};
  for (const auto& item : oneOfEach()) {
    bench.history.push(addWorldItem(item));
    states.push_back(bench.document.state());
  }
  WorldItem grown = bench.document.world()[1];
  grown.size.y() *= 1.25;
  bench.history.push(replaceWorldItem(bench.document, grown));
  states.push_back(bench.document.state());
  EXPECT_EQ(replaceWorldItem(bench.document, grown), nullptr) << "nothing would change";
  bench.history.push(removeWorldItems(bench.document, {{1}, {3}}));
  states.push_back(bench.document.state());
  EXPECT_EQ(bench.document.world().size(), 2U);
  for (std::size_t i = states.size() - 1; i > 0; --i) {
    EXPECT_EQ(bench.document.state(), states[i]);
    EXPECT_EQ(hashOf(bench.document.state()), hashOf(states[i]));
    bench.history.undo();
  }
  EXPECT_EQ(bench.document.state(), states[0]);
}

TEST(WorldCommands, KeepPinnedPictures) {
  Bench bench;
  bench.history.push(pinSnapshot(bench.document, {1}, true));
  EXPECT_EQ(removeSnapshot(bench.document, {1}), nullptr);
  EXPECT_EQ(pinSnapshot(bench.document, {1}, true), nullptr);
  bench.history.undo();
  EXPECT_NE(removeSnapshot(bench.document, {1}), nullptr);
}

class WorldFile : public testing::Test {
 protected:
  WorldFile() {
    folder = fs::temp_directory_path() / ("longarm_world_" + std::to_string(::getpid()) + "_" +
                                          testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  ~WorldFile() override {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
  }
  std::string path(const char* name) const { return (folder / name).string(); }
  fs::path folder;
};

/// Volume enclosed by the triangles, positive when they are counter-clockwise from outside.
double volumeOf(const planning::TriangleMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](int i) { return mesh.vertices[static_cast<std::size_t>(t[static_cast<std::size_t>(i)])]; };
    volume += at(0).dot(at(1).cross(at(2))) / 6;
  }
  return volume;
}

// The volumes of box, slab, 32-sided pipe and spheres.
double expectedVolume(const std::vector<WorldItem>& items) {
  const double polygon = 32 * std::sin(2 * M_PI / 32) / 2;      // of a 32-gon in the unit circle
  return items[0].size.prod() + items[1].size.prod() + polygon * 0.03 * 0.03 * items[2].size.z() +
         2 * 4.0 / 3 * M_PI * std::pow(kPointDiameter_m / 2, 3) * 0.975;
}

TEST_F(WorldFile, IsWrittenAsClosedTrianglesThatOtherProgramsRead) {
  const auto items = oneOfEach();
  for (const char* name : {"world.obj", "world.glb"}) {
    ASSERT_TRUE(exportWorld(path(name), items)) << name;
    const auto mesh = planning::loadMesh(path(name));
    ASSERT_TRUE(mesh.ok()) << mesh.error().message;
    EXPECT_NEAR(volumeOf(**mesh), expectedVolume(items), 0.002 * expectedVolume(items)) << name;
    Vector3d low = (*mesh)->vertices[0], high = low;
    for (const auto& v : (*mesh)->vertices) {
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    EXPECT_GT(high.maxCoeff(), 1.3) << "in metres of the robot's frame";
  }
  ASSERT_TRUE(exportWorld(path("world.json"), items));
  const auto json = nlohmann::json::parse(readTextFile(path("world.json")).value());
  EXPECT_EQ(json["frame"], "base_link");
  EXPECT_EQ(json["objects"].size(), 4U);
  EXPECT_EQ(json["objects"][3]["points"].size(), 2U);
}

TEST_F(WorldFile, RefusesOtherEndingsAnEmptyWorldAndMixedFrames) {
  auto items = oneOfEach();
  EXPECT_NE(exportWorld(path("world.step"), items).error().message.find(".glb"), std::string::npos);
  EXPECT_FALSE(exportWorld(path("world.obj"), {}));
  items[2].parent = "head";
  EXPECT_FALSE(exportWorld(path("world.obj"), items));
  EXPECT_FALSE(fs::exists(path("world.obj")));
}

TEST_F(WorldFile, IsKeptInTheSketchWithPinsGroupsAndNotes) {
  Bench bench;
  for (const auto& item : oneOfEach()) bench.history.push(addWorldItem(item));
  bench.history.push(pinSnapshot(bench.document, {2}, true));
  bench.history.push(addItem(tests::trueLine(bench, 1)));
  bench.history.push(addItem(tests::trueLine(bench, 2, "Line 2")));
  bench.history.push(groupItems(bench.document, {{1}, {2}}, true));
  bench.history.push(noteItem(bench.document, {1}, "hot, do not touch"));
  ASSERT_TRUE(saveSketch(path("sketch"), bench.document.state()));
  const auto loaded = loadSketch(path("sketch"));
  ASSERT_TRUE(loaded.ok()) << loaded.error().message;
  ASSERT_EQ(loaded->world.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const WorldItem &a = loaded->world[i], &b = bench.document.world()[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.size, b.size);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.role, b.role);
    EXPECT_LT((a.X_WO.matrix() - b.X_WO.matrix()).norm(), 1e-12);
  }
  EXPECT_EQ(loaded->pinned, bench.document.state().pinned);
  EXPECT_EQ(loaded->items[0].note, "hot, do not touch");
  EXPECT_EQ(loaded->items[0].group, loaded->items[1].group);
  EXPECT_NE(loaded->items[0].group, 0U);
}

}  // namespace
}  // namespace longarm::session
