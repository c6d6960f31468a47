// Known bodies in the gripper's hand or at its ends, where a motion starts.
#include <gtest/gtest.h>

#include "planning/macros/grip.h"
#include "planning/macros/tool_shape.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::contextOf;
using tests::featureOf;
using tests::macroOf;
using vision::FeatureKind;

const Workcell& cell() { return tests::builtIn(); }

constexpr double kRadius = 0.02;

const Vector3d kFirst(0.7, -0.15, 0.45), kSecond(0.7, 0.15, 0.45);

vision::Feature pipeFeature() { return featureOf(FeatureKind::kLine, {kFirst, kSecond}); }

WorldObject pipeBody() {
  WorldObject pipe;
  pipe.name = "pipe";
  pipe.shape = Cylinder{kRadius, 0.3};
  pipe.X_WO = poseAt(0.5 * (kFirst + kSecond), rotationWithZ(kSecond - kFirst));
  return pipe;
}

WorldObject rackUnderPipe() { return tests::boxObject("rack", {0.06, 0.06, 0.02}, {0.7, 0.12, 0.45 - kRadius - 0.01}); }

Eigen::VectorXd withFingersAt(Eigen::VectorXd q, double position) {
  const auto joint = cell().model->jointIndex(cell().gripper->joint);
  q[cell().model->joints()[static_cast<std::size_t>(*joint)].q_index] = position;
  return q;
}

// Where the arm stands after Grab Pipe on the known pipe; the fingers still open.
Eigen::VectorXd atThePipe() {
  PlanContext context = contextOf(cell());
  context.start = tests::gripperOpened(cell(), context.start);
  context.objects = {pipeBody(), rackUnderPipe()};
  context.budget_s = 60;
  const vision::Feature feature = pipeFeature();
  const Plan plan = macroOf("grab_pipe").plan(context, &feature);
  EXPECT_TRUE(plan.ok()) << plan.reason;
  return plan.ok() ? tests::planAt(cell(), plan, plan.trajectory.duration()) : context.start;
}

TEST(GripAt, HoldsWhatStandsBetweenFingersThatCloseOnIt) {
  const Eigen::VectorXd open = atThePipe();
  const std::vector<WorldObject> scene{pipeBody(), rackUnderPipe()};
  EXPECT_TRUE(gripAt(cell(), scene, open).held.empty()) << "open fingers hold nothing";
  EXPECT_TRUE(gripAt(cell(), scene, withFingersAt(open, 0.035)).held.empty()) << "15 mm of air on either side";
  const Grip grip = gripAt(cell(), scene, withFingersAt(open, kRadius));
  ASSERT_EQ(grip.held, std::vector<std::string>{"pipe"});
  ASSERT_EQ(grip.supports.size(), 1u);
  EXPECT_EQ(grip.supports[0].second, "rack");
  EXPECT_TRUE(grip.touched.empty());
}

TEST(GripAt, DoesNotTakeASurfaceUnderTheFingertipsForHeld) {
  const vision::Feature point = featureOf(FeatureKind::kPoint, {{0.7, 0, 0.3}});
  PlanContext context = contextOf(cell());
  context.arguments = {{"height", 0.2}, {"max_tilt", 0}};
  context.budget_s = 60;
  const Plan above = macroOf("move_above").plan(context, &point);
  ASSERT_TRUE(above.ok()) << above.reason;
  const Eigen::VectorXd q = withFingersAt(tests::planAt(cell(), above, above.trajectory.duration()), 0.02);
  const double overhang = toolOverhang(cell(), q);
  const WorldObject table = tests::boxObject("table", {0.4, 0.4, 0.02}, {0.7, 0, 0.5 - overhang - 0.01 + 1e-4});
  const Grip grip = gripAt(cell(), {table}, q);
  EXPECT_TRUE(grip.held.empty());
  EXPECT_EQ(grip.touched, std::vector<std::string>{"table"});
}

TEST(Grip, WhatIsHeldMovesWithTheToolInEveryPlan) {
  const Eigen::VectorXd held = withFingersAt(atThePipe(), kRadius);
  PlanContext context = contextOf(cell());
  context.start = held;
  context.objects = {pipeBody(), rackUnderPipe()};
  context.budget_s = 60;
  const Grip grip = gripAt(cell(), context.objects, held);
  const auto carried = withHeldAttached(cell(), context.objects, grip, held);
  ASSERT_EQ(carried[0].attached_link, cell().arm.tip_link);
  const vision::Feature line = featureOf(FeatureKind::kLine, {{0, 0, 0}, {0, 0, 1}});
  for (const std::string name : {"ready", "move_parallel"}) {
    const Plan plan = macroOf(name).plan(context, name == "ready" ? nullptr : &line);
    ASSERT_TRUE(plan.ok()) << name << ": " << plan.reason;
    ASSERT_FALSE(plan.notes.empty());
    EXPECT_NE(plan.notes[0].find("\"pipe\""), std::string::npos) << plan.notes[0];
    CheckOptions options;
    options.objects = carried;
    const auto report = checkTrajectory(cell(), plan.trajectory, held, options);
    ASSERT_TRUE(report.ok()) << report.error().message;
    for (const auto& v : report->violations) ADD_FAILURE() << name << ": " << v.sentence;
  }
}

TEST(Grip, ThatTouchesABodyBacksStraightOffItFirst) {
  const WorldObject table = tests::boxObject("table", {0.4, 0.6, 0.05}, {0.8, 0, 0.275});
  const vision::Feature point = featureOf(FeatureKind::kPoint, {{0.75, 0, 0.30}});
  PlanContext context = contextOf(cell());
  context.objects = {table};
  context.arguments = {{"from", 1}, {"gap", -0.001}};
  context.budget_s = 60;
  const Plan touch = macroOf("touch").plan(context, &point);
  ASSERT_TRUE(touch.ok()) << touch.reason;
  context.start = tests::planAt(cell(), touch, touch.trajectory.duration());
  context.arguments.clear();
  ASSERT_EQ(gripAt(cell(), context.objects, context.start).touched.size(), 1u);
  const Plan home = macroOf("home").plan(context, nullptr);
  ASSERT_TRUE(home.ok()) << home.reason;
  ASSERT_EQ(home.stages.size(), 2u);
  EXPECT_EQ(home.stages[0].name, "back off");
  EXPECT_GT(home.min_clearance, 0.001) << "of the rest of the way";
  CheckOptions options;
  options.objects = {table};
  options.allowed = {{"table", cell().gripper->links, 0, home.stages[0].end_s}};
  const auto report = checkTrajectory(cell(), home.trajectory, context.start, options);
  ASSERT_TRUE(report.ok()) << report.error().message;
  for (const auto& v : report->violations) ADD_FAILURE() << v.sentence;
}

TEST(Grip, ThatIsStuckSaysSo) {
  const WorldObject table = tests::boxObject("table", {0.4, 0.6, 0.05}, {0.8, 0, 0.275});
  const vision::Feature point = featureOf(FeatureKind::kPoint, {{0.75, 0, 0.30}});
  PlanContext context = contextOf(cell());
  context.objects = {table};
  context.arguments = {{"from", 1}, {"gap", -0.02}};
  context.budget_s = 60;
  const Plan touch = macroOf("touch").plan(context, &point);
  ASSERT_TRUE(touch.ok()) << touch.reason;
  context.start = tests::planAt(cell(), touch, touch.trajectory.duration());
  context.arguments.clear();
  const Pose X = tests::toolAt(cell(), touch, touch.trajectory.duration());
  // A slab above the table that the fingers have gone through: they touch it wherever they go.
  context.objects.push_back(tests::boxObject("slab", {0.5, 0.5, 0.30}, X.translation() + Vector3d(0, 0, 0.10)));
  const Plan home = macroOf("home").plan(context, nullptr);
  EXPECT_EQ(home.status, PlanStatus::kStartInCollision);
  EXPECT_FALSE(home.reason.empty());
}

}  // namespace
}  // namespace longarm::planning
