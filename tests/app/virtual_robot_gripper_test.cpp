#include <gtest/gtest.h>

#include "app/virtual_robot/shape_rays.h"
#include "tests/app/virtual_robot_rig.h"

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector3d;

Pose toolAtStart() { return bodyOf(emptyScenario())->X_WT(); }

/// A pipe across the fingers, its middle `offset` (in the tool frame) from the tool.
planning::ScenarioObject pipeAt(const Vector3d& offset, double radius = 0.02, double turn = 0) {
  planning::ScenarioObject pipe;
  pipe.body.name = "pipe";
  pipe.body.shape = planning::Cylinder{radius, 0.3};
  Pose X_TO = Pose::Identity();
  X_TO.linear() = (Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY())).matrix();
  X_TO.translation() = offset;
  pipe.body.X_WO = toolAtStart() * X_TO;
  pipe.graspable = true;
  return pipe;
}

planning::Scenario sceneWith(const planning::ScenarioObject& pipe) {
  auto scenario = emptyScenario();
  scenario.objects = {pipe};
  scenario.goals = {{"grasp", "pipe", 0}, {"lift", "pipe", 0.05}};
  return scenario;
}

const Pose& poseOfPipe(const RobotBody& body) { return body.world().objects().front().body.X_WO; }

TEST(FingerZone, IsReadOffTheFingersOfTheBuiltInRobot) {
  const auto zone = FingerZone::of(builtIn());
  ASSERT_TRUE(zone.ok()) << zone.error().message;
  EXPECT_NEAR(zone->pad(0.05), 0.05, 1e-12);
  EXPECT_LT((zone->X_TZ().linear().col(1) - Vector3d::UnitY()).norm(), 1e-9);
  const auto pipe = planning::Shape(planning::Cylinder{0.02, 0.3});
  Pose across = Pose::Identity();
  across.linear() = Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitY()).matrix();
  const auto pinch = zone->pinch(pipe, across);
  ASSERT_TRUE(pinch.has_value());
  EXPECT_NEAR(pinch->width(), 0.04, 5e-5);
  EXPECT_NEAR(pinch->low, -0.02, 5e-5);
  across.translation().z() = 0.2;
  EXPECT_FALSE(zone->pinch(pipe, across).has_value());
}

TEST(VirtualGripper, ClosesOnAPipeStopsAtItsWidthAndCarriesIt) {
  const auto body = bodyOf(sceneWith(pipeAt({0, 0, 0})));
  ASSERT_TRUE(body->moveGripper(0).ok());
  EXPECT_FALSE(body->holding());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  EXPECT_EQ(body->world().heldName(), "pipe");
  EXPECT_NEAR(*body->measured().position("gripper_joint"), 0.02, 1e-4);
  EXPECT_TRUE(body->goals()[0].reached);
  EXPECT_FALSE(body->goals()[1].reached);
  const Pose X_TO = body->X_WT().inverse() * poseOfPipe(*body);
  moveArm(*body, (Eigen::VectorXd(6) << 0.1, -0.15, 0, 0, 0, 0).finished(), 1);
  EXPECT_TRUE((body->X_WT().inverse() * poseOfPipe(*body)).isApprox(X_TO, 1e-9)) << "it moved in the hand";
  EXPECT_TRUE(body->goals()[1].reached) << "raised by " << poseOfPipe(*body).translation().z();
}

TEST(VirtualGripper, CentresAPipeThatLiesToOneSide) {
  const auto body = bodyOf(sceneWith(pipeAt({0, 0.015, 0})));
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  EXPECT_NEAR((body->X_WT().inverse() * poseOfPipe(*body)).translation().y(), 0, 1e-4);
}

TEST(VirtualGripper, ClosesOnNothingWhenThePipeIsOutsideTheFingers) {
  for (const Vector3d& off : {Vector3d(0, 0.06, 0), Vector3d(0, 0, 0.04), Vector3d(0.2, 0, 0)}) {
    const auto body = bodyOf(sceneWith(pipeAt(off)));
    ASSERT_TRUE(body->moveGripper(0).ok());
    run(*body, 1);
    EXPECT_FALSE(body->holding()) << off.x() << " " << off.y() << " " << off.z();
    EXPECT_NEAR(*body->measured().position("gripper_joint"), 0, 1e-9);
  }
}

TEST(VirtualGripper, CannotTakeWhatIsThickerThanItOpens) {
  const auto body = bodyOf(sceneWith(pipeAt({0, 0, 0}, 0.055)));
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  EXPECT_FALSE(body->holding());
}

TEST(VirtualGripper, LetsGoWhenItOpensAndThePipeFallsToTheGround) {
  const auto body = bodyOf(sceneWith(pipeAt({0, 0, 0})));
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  const Vector3d before = poseOfPipe(*body).translation();
  ASSERT_TRUE(body->moveGripper(0.05).ok());
  run(*body, 2);
  EXPECT_FALSE(body->holding());
  EXPECT_EQ(body->world().heldName(), "");
  const Vector3d after = poseOfPipe(*body).translation();
  EXPECT_NEAR(after.x(), before.x(), 1e-12);
  EXPECT_NEAR(after.y(), before.y(), 1e-12);
  double lowest = 1;
  for (const auto& p : surfacePoints(planning::Cylinder{0.02, 0.3}, 0.005)) {
    lowest = std::min(lowest, (poseOfPipe(*body) * p).z());
  }
  EXPECT_NEAR(lowest, 0, 1e-4) << "it rests on the ground";
}

TEST(VirtualGripper, ASlippingGraspLosesThePipe) {
  const auto body = bodyOf(sceneWith(pipeAt({0, 0, 0})));
  ASSERT_TRUE(body->moveGripper(0).ok());
  run(*body, 1);
  ASSERT_TRUE(body->holding());
  ASSERT_TRUE(body->faults().start("slipping_grasp", body->time_s(), 0, "").ok());
  run(*body, 0.3);
  EXPECT_TRUE(body->holding()) << "it takes a moment";
  run(*body, 9);                         // half its length at 20 mm/s
  EXPECT_FALSE(body->holding());
  EXPECT_FALSE(body->goals()[0].reached);
}

planning::WorldObject bodyFrom(const char* name, planning::Shape shape, const Vector3d& at) {
  planning::WorldObject out;
  out.name = name;
  out.shape = std::move(shape);
  out.X_WO.translation() = at;
  return out;
}

TEST(Falling, EndsOnWhatIsUnderneath) {
  const auto ball = bodyFrom("ball", planning::Sphere{0.1}, {0, 0, 1});
  EXPECT_NEAR(fallDistance(ball, {}, 0), 0.9, 1e-3);
  const auto table = bodyFrom("table", planning::Box{{1, 1, 0.1}}, {0.3, 0, 0.45});
  EXPECT_NEAR(fallDistance(ball, {table}, 0), 0.4, 1e-3);
  const auto post = bodyFrom("post", planning::Cylinder{0.005, 0.4}, {0, 0, 0.2});
  EXPECT_NEAR(fallDistance(ball, {post}, 0), 0.5, 1e-3) << "thinner than the rays' spacing";
  const auto aside = bodyFrom("aside", planning::Box{{1, 1, 0.1}}, {0.7, 0, 0.45});
  EXPECT_NEAR(fallDistance(ball, {aside}, 0), 0.9, 1e-3);
  const auto under = bodyFrom("under", planning::Box{{1, 1, 0.1}}, {0, 0, 0.8501});
  EXPECT_NEAR(fallDistance(ball, {under}, 0), 0, 1e-9) << "it rests already";
}

TEST(Falling, RaysMeetEveryShape) {
  Pose X = Pose::Identity();
  X.translation() = Vector3d(0, 0, 2);
  EXPECT_NEAR(*rayDistance(planning::Box{{1, 1, 1}}, X, {0, 0, 0}, {0, 0, 1}), 1.5, 1e-12);
  EXPECT_NEAR(*rayDistance(planning::Sphere{0.5}, X, {0, 0, 0}, {0, 0, 1}), 1.5, 1e-12);
  EXPECT_NEAR(*rayDistance(planning::Cylinder{0.2, 1}, X, {0, 0, 0}, {0, 0, 1}), 1.5, 1e-12);
  EXPECT_NEAR(*rayDistance(planning::Cylinder{0.2, 1}, X, {1, 0, 2}, {-1, 0, 0}), 0.8, 1e-12);
  EXPECT_FALSE(rayDistance(planning::Cylinder{0.2, 1}, X, {0.3, 0, 0}, {0, 0, 1}).has_value());
  EXPECT_FALSE(rayDistance(planning::Box{{1, 1, 1}}, X, {0, 0, 0}, {0, 0, -1}).has_value());
  auto mesh = std::make_shared<planning::TriangleMesh>();
  mesh->vertices = {{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
  mesh->triangles = {{0, 1, 2}};
  EXPECT_NEAR(*rayDistance(planning::Shape(std::shared_ptr<const planning::TriangleMesh>(mesh)), X, {0, 0, 0}, {0, 0, 1}),
              2, 1e-12);
}

}  // namespace
}  // namespace longarm::virtual_robot
