#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/planning/planar_arm.h"
#include "planning/collision/bounds.h"
#include "planning/collision/collision_world.h"
#include "planning/collision/reach.h"
#include "tests/support/test_data.h"

namespace longarm::planning {
namespace {

using tests::modelFrom;
using tests::planarArmUrdf;

WorldObject boxAt(const std::string& name, const Eigen::Vector3d& size, const Eigen::Vector3d& xyz) {
  WorldObject out;
  out.name = name;
  out.shape = Box{size};
  out.X_WO.translation() = xyz;
  return out;
}

// 1 mm thin, 10 cm tall, as the fast arm sweeps past it.
const WorldObject kWall = boxAt("wall", {0.001, 0.1, 0.1}, {0.75, 0.35, 0});

CollisionOptions noPadding() {
  CollisionOptions options;
  options.padding = options.self_padding = 0;
  return options;
}

std::shared_ptr<const TriangleMesh> cubeMesh(double size) {
  auto mesh = std::make_shared<TriangleMesh>();
  const double h = size / 2;
  for (int i = 0; i < 8; ++i) mesh->vertices.push_back({i & 1 ? h : -h, i & 2 ? h : -h, i & 4 ? h : -h});
  mesh->triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// A free-flying body: one link with one shape and three sliding joints.
std::shared_ptr<const RobotModel> flyer(const std::string& geometry) {
  const auto slide = [](const std::string& name, const std::string& a, const std::string& b, const std::string& axis) {
    return "<joint name=\"" + name + "\" type=\"prismatic\"><parent link=\"" + a + "\"/><child link=\"" + b +
           "\"/><axis xyz=\"" + axis + "\"/><limit lower=\"-2\" upper=\"2\" velocity=\"1\" effort=\"1\"/></joint>";
  };
  return modelFrom("<robot name=\"flyer\"><link name=\"base\"/><link name=\"x\"/><link name=\"y\"/><link name=\"body\"><collision><geometry>" +
                   geometry + "</geometry></collision></link>" + slide("jx", "base", "x", "1 0 0") +
                   slide("jy", "x", "y", "0 1 0") + slide("jz", "y", "body", "0 0 1") + "</robot>");
}

TEST(CollisionWorld, NamesThePairThatTouches) {
  const auto model = modelFrom(planarArmUrdf());
  ASSERT_TRUE(model);
  const CollisionWorld world(model, {boxAt("post", {0.05, 0.05, 0.05}, {0.7, 0, 0})}, allowedPairs(model), noPadding());
  Contact contact;
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d(0, 0, 0), &contact));
  EXPECT_EQ(contact.first, "two");
  EXPECT_EQ(contact.second, "post");
  EXPECT_EQ(contact.sentence(), "two touches post");
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d(1.5, 0, 0)));
}

TEST(CollisionWorld, MeasuresClearanceExactly) {
  const auto model = modelFrom(planarArmUrdf());
  const CollisionWorld world(model, {boxAt("post", {0.1, 0.1, 0.1}, {0.6, 0.1, 0})}, allowedPairs(model), noPadding());
  Contact nearest;
  // Straight along x: 5 mm half width against the post's face at y = 0.05.
  EXPECT_NEAR(world.clearance(Eigen::Vector3d::Zero(), &nearest), 0.045, 1e-6);
  EXPECT_EQ(nearest.second, "post");
  EXPECT_NEAR(world.clearance(Eigen::Vector3d(-1.5, 0, 0), nullptr, 0.2), 0.2, 1e-12);
}

TEST(CollisionWorld, KeepsItsPadding) {
  const auto model = modelFrom(planarArmUrdf());
  CollisionOptions options;
  options.padding = 0.02;
  CollisionWorld world(model, {boxAt("post", {0.1, 0.1, 0.1}, {0.6, 0.07, 0})}, allowedPairs(model), options);
  Contact contact;
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d::Zero(), &contact));   // 15 mm away
  EXPECT_NE(contact.sentence().find("15.0 mm from post"), std::string::npos) << contact.sentence();
  EXPECT_FALSE(world.touching(Eigen::Vector3d::Zero()));
  world.setPadding(0.01, 0);
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d::Zero()));
}

TEST(CollisionWorld, LetsNamedLinksTouchAnObject) {
  const auto model = modelFrom(planarArmUrdf());
  CollisionWorld world(model, {boxAt("post", {0.05, 0.05, 0.05}, {1.1, 0, 0})}, allowedPairs(model), noPadding());
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d::Zero()));
  world.allow("post", {"three"});
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d::Zero()));
}

TEST(CollisionWorld, CarriesAttachedObjects) {
  const auto model = modelFrom(planarArmUrdf());
  WorldObject held = boxAt("pipe", {0.02, 0.3, 0.02}, Eigen::Vector3d::Zero());
  held.attached_link = "tip";
  const CollisionWorld world(model, {held, boxAt("post", {0.05, 0.05, 0.05}, {1.2, 0.12, 0})}, allowedPairs(model),
                             noPadding());
  Contact contact;
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d::Zero(), &contact));   // the pipe, not the arm
  EXPECT_EQ(contact.first, "pipe");
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d(-1, 0, 0)));          // and it may touch its carrier
}

TEST(CollisionWorld, IgnoresObjectsThatAreOnlyDrawn) {
  const auto model = modelFrom(planarArmUrdf());
  WorldObject ghost = boxAt("ghost", {1, 1, 1}, {0.5, 0, 0});
  ghost.collides = false;
  const CollisionWorld world(model, {ghost}, allowedPairs(model), noPadding());
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d::Zero()));
}

TEST(CollisionWorld, ZonesAreForTheArmAndWhatItCarriesAndOpenForNobody) {
  const auto model = modelFrom(planarArmUrdf());
  WorldObject zone = boxAt("drill", {0.05, 0.05, 0.05}, {1.1, 0, 0});
  zone.role = BodyRole::kKeepOut;
  CollisionWorld world(model, {zone}, allowedPairs(model), noPadding());
  world.allow("drill", {"three"});       // as a macro does with what it means to touch
  Contact contact;
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d::Zero(), &contact));
  EXPECT_EQ(contact.sentence(), "three is inside the keep-out zone drill");
  EXPECT_TRUE(world.inZone(Eigen::Vector3d::Zero()));
  EXPECT_FALSE(world.inZone(Eigen::Vector3d(1, 0, 0)));
  WorldObject around = boxAt("at the base", {0.1, 0.1, 0.1}, {0, 0, 0});
  around.role = BodyRole::kKeepOut;
  CollisionOptions last = noPadding();
  last.moving = {2};
  EXPECT_FALSE(CollisionWorld(model, {around}, allowedPairs(model), last).touching(Eigen::Vector3d::Zero()))
      << "only the third joint moves, and it is elsewhere";
}

TEST(CollisionWorld, AWorkspaceIsNotLeftAtAnyInstantOfAMotion) {
  const auto model = modelFrom(planarArmUrdf());
  WorldObject room = boxAt("cell", {2.6, 1.0, 1}, {0.9, 0, 0});
  room.role = BodyRole::kKeepIn;
  const CollisionWorld world(model, {room}, allowedPairs(model), noPadding());
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d::Zero()));
  EXPECT_NEAR(world.clearance(Eigen::Vector3d::Zero()), 0.4, 0.1);
  Contact contact;
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d(1.2, 0, 0), &contact));
  EXPECT_NE(contact.sentence().find("is outside the workspace cell"), std::string::npos) << contact.sentence();
  // Folded back at both ends, stretched in the middle: out through the side and in again.
  const Eigen::Vector3d a(0.9, -1.9, 0), b(0.9, 1.9, 0);
  ASSERT_FALSE(world.inCollision(a));
  EXPECT_TRUE(world.inCollision(Eigen::Vector3d(0.9, 0, 0)));
  EXPECT_FALSE(world.segmentFree(a, b));
}

// Cases in which FCL's signed distance hangs or aborts, and its other solver reports clearance.
TEST(CollisionWorld, SurvivesConcentricAndTouchingShapes) {
  const struct { const char* geometry; Shape shape; double offset; } cases[] = {
      {"<sphere radius=\"0.1\"/>", Sphere{0.1}, 0},
      {"<sphere radius=\"0.1\"/>", Sphere{0.05}, 0},
      {"<box size=\"0.2 0.2 0.2\"/>", Box{{0.2, 0.2, 0.2}}, 0},
      {"<box size=\"0.2 0.2 0.2\"/>", Box{{0.2, 0.2, 0.2}}, 0.1999},
      {"<cylinder radius=\"0.1\" length=\"0.3\"/>", Cylinder{0.1, 0.3}, 0},
      {"<cylinder radius=\"0.1\" length=\"0.3\"/>", Sphere{0.1}, 0},
      {"<box size=\"0.2 0.2 0.2\"/>", cubeMesh(0.2), 0},
      {"<box size=\"0.1 0.1 0.1\"/>", cubeMesh(0.4), 0},      // wholly inside a mesh
  };
  for (const auto& c : cases) {
    WorldObject object;
    object.name = "object";
    object.shape = c.shape;
    object.X_WO.translation().x() = c.offset;
    const auto model = flyer(c.geometry);
    ASSERT_TRUE(model);
    const CollisionWorld world(model, {object}, allowedPairs(model), noPadding());
    EXPECT_TRUE(world.inCollision(Eigen::Vector3d::Zero())) << c.geometry;
    EXPECT_FALSE(world.inCollision(Eigen::Vector3d(0, 0, 1))) << c.geometry;
    EXPECT_FALSE(world.segmentFree(Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(0.01, 0, -1))) << c.geometry;
  }
}

TEST(CollisionWorld, RoundNumbersNeverHangOrReadAsClear) {
  std::mt19937_64 engine(4);
  const auto model = flyer("<box size=\"0.2 0.1 0.3\"/>");
  const CollisionWorld world(model, {boxAt("box", {0.1, 0.1, 0.1}, Eigen::Vector3d::Zero())}, allowedPairs(model),
                             noPadding());
  for (int i = 0; i < 20000; ++i) {
    Eigen::Vector3d q;
    for (int k = 0; k < 3; ++k) q[k] = 0.05 * static_cast<double>(static_cast<int>(engine() % 17) - 8);
    const Eigen::Vector3d gap = q.cwiseAbs() - Eigen::Vector3d(0.15, 0.1, 0.2);
    if (std::abs(gap.maxCoeff()) < 1e-9) continue;   // face on face: either answer
    EXPECT_EQ(world.inCollision(q), gap.maxCoeff() < 0) << q.transpose();
  }
}

TEST(Bounds, NeverExceedTheTrueDistance) {
  std::mt19937_64 engine(2);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto shape = [&]() -> Shape {
    switch (engine() % 3) {
      case 0: return Box{Eigen::Vector3d(unit(engine), unit(engine), unit(engine)) * 0.5 + Eigen::Vector3d::Constant(0.02)};
      case 1: return Cylinder{0.02 + 0.2 * unit(engine), 0.02 + 0.5 * unit(engine)};
      default: return Sphere{0.02 + 0.2 * unit(engine)};
    }
  };
  const auto model = flyer("<sphere radius=\"0.1\"/>");
  for (int i = 0; i < 3000; ++i) {
    WorldObject object;
    object.name = "o";
    object.shape = shape();
    object.X_WO.translation() = Eigen::Vector3d(unit(engine), unit(engine), unit(engine)) - Eigen::Vector3d::Constant(0.5);
    object.X_WO.linear() = expSO3(Eigen::Vector3d(unit(engine), unit(engine), unit(engine)) * 4);
    const CollisionWorld world(model, {object}, {}, noPadding());
    const double truth = world.clearance(Eigen::Vector3d::Zero(), nullptr, 10);
    const double bound = distanceBound(place(boundsOf(Sphere{0.1}), Pose::Identity()),
                                       place(boundsOf(object.shape), object.X_WO));
    EXPECT_LE(bound, truth + 1e-5) << i;   // libccd's own tolerance
  }
}

TEST(MotionBound, IsNeverPassedByAnyPoint) {
  const auto model = modelFrom(planarArmUrdf());
  const ShapeBounds bounds = boundsOf(Box{{0.3, 0.01, 0.01}});
  Pose X_LS = Pose::Identity();
  X_LS.translation().x() = 0.15;
  const int link = *model->linkIndex("three");
  const MotionBound bound = motionBound(*model, link, -1, bounds, X_LS);
  ASSERT_EQ(bound.size(), 3u);
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> joint(-2.5, 2.5);
  double tightest = 10;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d a(joint(engine), joint(engine), joint(engine));
    const Eigen::Vector3d b = a + 0.01 * Eigen::Vector3d(joint(engine), joint(engine), joint(engine));
    double way = 0;
    for (const auto& [index, reach] : bound) way += reach * std::abs(b[index] - a[index]);
    const Eigen::Vector3d corner(0.3, 0.005, 0.005);
    const double moved = (model->forward(b, link) * corner - model->forward(a, link) * corner).norm();
    EXPECT_LE(moved, way + 1e-12);
    if (moved > 1e-3) tightest = std::min(tightest, way / moved);
  }
  EXPECT_LT(tightest, 1.2);   // and is not much too careful
}

TEST(AllowedPairs, HoldNeighboursAndRigidPiecesWithoutAnSrdf) {
  const auto model = modelFrom(planarArmUrdf());
  const AllowedPairs pairs = allowedPairs(model);
  const auto index = [&](const char* name) { return *model->linkIndex(name); };
  EXPECT_TRUE(pairs.count({index("one"), index("two")}));
  EXPECT_TRUE(pairs.count({index("two"), index("three")}));
  EXPECT_TRUE(pairs.count({index("three"), index("tip")}));
  EXPECT_FALSE(pairs.count({index("one"), index("three")}));   // seldom touch, stay checked
  EXPECT_EQ(pairs, allowedPairs(model));
}

TEST(AllowedPairs, LetAPairTouchThatCannotBeKeptApart) {
  std::string urdf = planarArmUrdf();
  // A collar on the base that link two always stands in.
  urdf.replace(urdf.find("<link name=\"base\"/>"), 19,
               "<link name=\"base\"><collision><geometry><sphere radius=\"0.6\"/></geometry></collision></link>");
  const auto model = modelFrom(urdf);
  ASSERT_TRUE(model);
  const AllowedPairs pairs = allowedPairs(model);
  EXPECT_TRUE(pairs.count({*model->linkIndex("base"), *model->linkIndex("two")}));
}

// A fast planar arm and a thin wall: what fixed steps of 5 degrees miss in 7 % of the cases.
int countSegments(int wanted, unsigned seed, int& colliding, int& missed, int& false_alarms, double& states) {
  const auto model = modelFrom(planarArmUrdf());
  const CollisionWorld world(model, {kWall}, allowedPairs(model), noPadding());
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> start(-1.5, 1.5), move(-0.6, 0.6);
  int total = 0;
  long used = 0;
  while (total < wanted) {
    Eigen::Vector3d a, b;
    for (int k = 0; k < 3; ++k) a[k] = start(engine);
    for (int k = 0; k < 3; ++k) b[k] = a[k] + move(engine);
    if (world.inCollision(a) || world.inCollision(b)) continue;
    ++total;
    const int steps = static_cast<int>(std::ceil((b - a).cwiseAbs().maxCoeff() / (0.05 * M_PI / 180)));
    bool hit = false;
    for (int i = 0; i <= steps && !hit; ++i) hit = world.inCollision(a + (b - a) * i / steps);
    const long before = world.counters().states;
    const bool free = world.segmentFree(a, b);
    used += world.counters().states - before;
    colliding += hit;
    missed += hit && free;
    false_alarms += !hit && !free;
  }
  states = static_cast<double>(used) / wanted;
  return total;
}

TEST(SegmentFree, MissesNoCollisionWithAThinWall) {
  int colliding = 0, missed = 0, false_alarms = 0;
  double states = 0;
  countSegments(600, 1, colliding, missed, false_alarms, states);
  EXPECT_GT(colliding, 20);
  EXPECT_EQ(missed, 0);
  EXPECT_LE(false_alarms, 2);   // within 0.1 mm of the wall
  EXPECT_LT(states, 12);
}

TEST(SegmentFreeCampaign, MissesNoneOfThreeThousandSegments) {
  int colliding = 0, missed = 0, false_alarms = 0;
  double states = 0;
  countSegments(3000, 7, colliding, missed, false_alarms, states);
  RecordProperty("colliding", colliding);
  std::printf("3000 segments: %d colliding, %d missed, %d false alarms, %.1f states each\n", colliding, missed, false_alarms, states);
  EXPECT_EQ(missed, 0);
  EXPECT_LE(false_alarms, 6);
}

TEST(SegmentFree, LeavesOutPairsThatTheMotionDoesNotChange) {
  const auto model = modelFrom(planarArmUrdf());
  CollisionOptions options = noPadding();
  options.moving = {2};
  // Link one stands in the post, but only the last joint moves.
  const CollisionWorld world(model, {boxAt("post", {0.05, 0.05, 0.05}, {0.3, 0, 0})}, allowedPairs(model), options);
  EXPECT_TRUE(world.segmentFree(Eigen::Vector3d(0, 0, -0.5), Eigen::Vector3d(0, 0, 0.5)));
  EXPECT_FALSE(world.inCollision(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(world.touching(Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace longarm::planning
