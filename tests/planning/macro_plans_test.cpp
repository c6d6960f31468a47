// Every macro once in a scene made by hand: where the tool goes, in which stages, and why not when it cannot.
#include <cmath>

#include <gtest/gtest.h>

#include "planning/collision/collision_world.h"
#include "planning/macros/planning_run.h"
#include "planning/macros/tool_shape.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::contextOf;
using tests::featureOf;
using tests::macroOf;
using tests::sweepOf;
using tests::toolAt;
using vision::FeatureKind;

constexpr double kOnGoal = 1e-5;         // the solver stops at 1e-6 m, the path is solved to 1e-7

const Workcell& cell() { return tests::builtIn(); }

Plan planned(const std::string& macro, const vision::Feature& feature, const std::map<std::string, double>& arguments = {},
             const std::string& start = "home", const std::vector<WorldObject>& objects = {}) {
  PlanContext context = contextOf(cell(), start);
  context.arguments = arguments;
  context.objects = objects;
  context.budget_s = 60;                 // a loaded machine must not change the answer
  return macroOf(macro).plan(context, &feature);
}

void expectClean(const Plan& plan, const std::vector<WorldObject>& objects = {}, const std::vector<std::string>& touched = {}) {
  const CheckReport report = sweepOf(cell(), plan, objects, touched);
  for (const auto& v : report.violations) ADD_FAILURE() << plan.macro << ": " << v.kind << ": " << v.sentence;
  EXPECT_LE(plan.max_velocity_ratio, 0.5 + 1e-6);
  EXPECT_LE(plan.max_acceleration_ratio, 0.25 + 1e-6);
}

Pose endOf(const Plan& plan) { return toolAt(cell(), plan, plan.trajectory.duration()); }

// Largest distance of the tool from the line through its poses at both ends of a stage, and its largest turn.
std::pair<double, double> straightness(const Plan& plan, const PlanStage& stage) {
  const Pose a = toolAt(cell(), plan, stage.start_s), b = toolAt(cell(), plan, stage.end_s);
  const Vector3d d = (b.translation() - a.translation()).normalized();
  double off = 0, turn = 0;
  for (int i = 0; i <= 500; ++i) {
    const Pose X = toolAt(cell(), plan, stage.start_s + (stage.end_s - stage.start_s) * i / 500);
    const Vector3d r = X.translation() - a.translation();
    off = std::max(off, (r - r.dot(d) * d).norm());
    turn = std::max(turn, angleBetween(X.linear(), a.linear()));
  }
  return {off, turn};
}

vision::Feature upright(double sigma = 0.001) {      // a rectangle that faces the robot
  return featureOf(FeatureKind::kPlane, {{0.85, -0.15, 0.40}, {0.85, 0.15, 0.40}, {0.85, 0.15, 0.62}}, sigma);
}
vision::Feature crate() { return featureOf(FeatureKind::kTriad, {{0.7, -0.04, 0.40}, {0.7, 0.04, 0.40}, {0.8, -0.04, 0.40}, {0.7, -0.04, 0.52}}); }
WorldObject crateBody() { return tests::boxObject("mark", {0.1, 0.08, 0.12}, {0.75, 0, 0.46}); }

TEST(LookAt, PointsTheWristCameraAtThePointWithALevelPicture) {
  const Vector3d p(0.8, 0.2, 0.45);
  const Plan plan = planned("look_at", featureOf(FeatureKind::kPoint, {p}), {{"stand_off", 0.35}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const Pose X = cell().model->forward(tests::planAt(cell(), plan, plan.trajectory.duration()), *cell().model->linkIndex("wrist_optical"));
  const Vector3d seen = X.inverse() * p;
  EXPECT_NEAR(seen.z(), 0.35, 1e-4);
  EXPECT_LT(seen.head<2>().norm(), 1e-4);
  expectClean(plan);
}

TEST(LookAt, TurnsAPanTiltAndLeavesTheArm) {
  const Vector3d p(1.5, -0.6, 0.2);
  const Plan plan = planned("look_at", featureOf(FeatureKind::kPoint, {p}), {{"pan_tilt", 1}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  ASSERT_EQ(plan.pan_tilt.size(), 2u);
  Eigen::VectorXd q = plan.start_configuration;
  for (const auto& [name, value] : plan.pan_tilt) q[cell().model->joints()[static_cast<std::size_t>(*cell().model->jointIndex(name))].q_index] = value;
  const Vector3d seen = cell().model->forward(q, *cell().model->linkIndex("head_left_optical")).inverse() * p;
  EXPECT_LT(seen.head<2>().norm() / seen.z(), 1e-4);
  EXPECT_EQ(plan.trajectory.points.front().positions, plan.trajectory.points.back().positions);
}

TEST(Touch, EndsAtThePointAfterAStraightApproach) {
  const Vector3d p(0.75, 0.1, 0.45);
  const Plan plan = planned("touch", featureOf(FeatureKind::kPoint, {p}), {{"stand_off", 0.12}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT((endOf(plan).translation() - p).norm(), kOnGoal);
  const PlanStage* approach = tests::stageOf(plan, "approach");
  ASSERT_NE(approach, nullptr);
  EXPECT_TRUE(approach->straight);
  const auto [off, turn] = straightness(plan, *approach);
  EXPECT_LT(off, 1e-3);
  EXPECT_LT(turn, 0.01);
  EXPECT_NEAR((toolAt(cell(), plan, approach->start_s).translation() - p).norm(), 0.12, 1e-4);
  expectClean(plan);
}

TEST(Touch, StopsWithTheGrippersEndsOnABodyThatIsKnown) {
  const WorldObject table = tests::boxObject("table", {0.4, 0.6, 0.05}, {0.8, 0, 0.275});
  const Vector3d p(0.75, 0, 0.30);
  const Plan plan = planned("touch", featureOf(FeatureKind::kPoint, {p}), {{"from", 1}}, "home", {table});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const double overhang = toolOverhang(cell(), plan.start_configuration);
  ASSERT_GT(overhang, 0.01);
  EXPECT_NEAR((endOf(plan).translation() - p).norm(), overhang, 1e-4);
  EXPECT_FALSE(plan.notes.empty());
  expectClean(plan, {table}, {"table"});
  Eigen::VectorXd q = tests::planAt(cell(), plan, plan.trajectory.duration() - 0.5);       // still short of it
  const CollisionWorld world(cell().model, {table}, allowedPairs(cell().model));
  EXPECT_FALSE(world.touching(q)) << "it must not enter the table before its end";
}

TEST(MoveAbove, HoldsTheToolOverThePointAgainstGravity) {
  const Vector3d p(0.7, -0.2, 0.35);
  const Plan plan = planned("move_above", featureOf(FeatureKind::kPoint, {p}), {{"height", 0.2}, {"max_tilt", 0}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT((endOf(plan).translation() - (p + Vector3d(0, 0, 0.2))).norm(), kOnGoal);
  EXPECT_LT((endOf(plan).linear().col(2) + Vector3d::UnitZ()).norm(), 1e-4);
  expectClean(plan);
}

TEST(PlaceHere, LowersWhatIsHeldOntoThePointUprightAndMissesWhatStandsThere) {
  WorldObject held = tests::boxObject("held", {0.04, 0.04, 0.04}, Vector3d(0, 0, 0.15 + 0.04));
  held.attached_link = "arm_6_link";     // which carries the fingers too: they may touch what they hold
  const WorldObject table = tests::boxObject("table", {0.4, 0.8, 0.05}, {0.8, 0, 0.275});
  const Vector3d p(0.75, 0.1, 0.30);
  // A start with the tool pointing down, so that what is held hangs under the gripper.
  const Plan above = planned("move_above", featureOf(FeatureKind::kPoint, {p}), {{"height", 0.3}, {"max_tilt", 0}});
  ASSERT_TRUE(above.ok()) << above.reason;
  PlanContext context = contextOf(cell());
  context.start = tests::planAt(cell(), above, above.trajectory.duration());
  context.objects = {held, table};
  context.budget_s = 60;
  const vision::Feature feature = featureOf(FeatureKind::kPoint, {p});
  const Plan plan = macroOf("place_here").plan(context, &feature);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_NEAR(endOf(plan).translation().z() - p.z(), 0.06 + 0.006, 1e-4) << "the held box reaches 60 mm below the tool point";
  EXPECT_LT((endOf(plan).linear().col(2) + Vector3d::UnitZ()).norm(), 1e-3);
  expectClean(plan, {held, table});
}

TEST(Zones, AreRefusedToTouchAndSeenByTheIndependentSweep) {
  const Vector3d p(0.7, 0, 0.5);
  const auto point = featureOf(FeatureKind::kPoint, {p});
  const Plan free = planned("touch", point);
  ASSERT_TRUE(free.ok()) << free.reason;
  WorldObject zone = tests::boxObject("drill", {0.2, 0.2, 0.2}, p);
  zone.role = BodyRole::kKeepOut;
  const Plan refused = planned("touch", point, {}, "home", {zone});
  EXPECT_FALSE(refused.ok()) << "the marked point is in it, which opens it to nobody";
  EXPECT_NE(refused.reason.find("drill"), std::string::npos) << refused.reason;
  EXPECT_FALSE(sweepOf(cell(), free, {zone}, {"drill"}).ok);
  WorldObject room = tests::boxObject("room", {4, 4, 4}, {0, 0, 0});
  room.role = BodyRole::kKeepIn;
  expectClean(planned("touch", point, {}, "home", {room}), {room});
  room.X_WO.translation().x() = -1.5;    // its front wall stands before the point
  EXPECT_FALSE(sweepOf(cell(), free, {room}).ok);
  EXPECT_NE(planned("touch", point, {}, "home", {room}).reason.find("room"), std::string::npos);
}

TEST(AttachedObjects, AreKeptOutOfObstaclesOnTheWay) {
  const Vector3d p(0.75, 0, 0.45);
  WorldObject rod = tests::boxObject("rod", {0.02, 0.5, 0.02}, Vector3d(0, 0, 0.15 + 0.05));
  rod.attached_link = "arm_6_link";
  // Two walls that the gripper passes between at any roll; the rod across it only when it stands on end.
  std::vector<WorldObject> scene{tests::boxObject("left", {0.5, 0.02, 1.0}, {0.85, 0.2, 0.5}), tests::boxObject("right", {0.5, 0.02, 1.0}, {0.85, -0.2, 0.5})};
  scene.push_back(rod);
  const Plan plan = planned("touch", featureOf(FeatureKind::kPoint, {p}), {}, "ready", scene);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT(std::abs(endOf(plan).linear().col(1).y()) * 0.25, 0.2) << "the rod stands between the walls";
  expectClean(plan, scene);
}

TEST(ApproachFromSide, EndsOnTheLineLevelAndSquareToIt) {
  const Vector3d a(0.75, -0.15, 0.5), b(0.75, 0.15, 0.5);
  const Plan plan = planned("approach_from_side", featureOf(FeatureKind::kLine, {a, b}));
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT((endOf(plan).translation() - 0.5 * (a + b)).norm(), kOnGoal);
  const Vector3d z = endOf(plan).linear().col(2);
  EXPECT_LT(std::abs(z.y()), 1e-4) << "square to the line";
  EXPECT_GT(z.x(), 0.49) << "from the robot's side, at most 60 degrees off level";
  WorldObject pipe;
  pipe.name = "mark";
  pipe.shape = Cylinder{0.02, 0.3};
  pipe.X_WO = poseAt(0.5 * (a + b), rotationWithZ(b - a));
  expectClean(plan, {pipe}, {"mark"});
}

TEST(MoveParallel, GoesTheDistanceAlongTheLineWithoutTurning) {
  const Vector3d a(0.9, -0.3, 0.5), b(0.9, 0.3, 0.6);
  for (const double distance : {0.12, -0.1}) {
    const Plan plan = planned("move_parallel", featureOf(FeatureKind::kLine, {a, b}), {{"distance", distance}}, "ready");
    ASSERT_TRUE(plan.ok()) << plan.reason;
    const Pose from = toolAt(cell(), plan, 0), to = endOf(plan);
    EXPECT_LT((to.translation() - from.translation() - distance * (b - a).normalized()).norm(), kOnGoal);
    ASSERT_EQ(plan.stages.size(), 1u) << "it starts where the tool is";
    const auto [off, turn] = straightness(plan, plan.stages[0]);
    EXPECT_LT(off, 1e-3);
    EXPECT_LT(turn, 0.01);
    expectClean(plan);
  }
}

TEST(AimAlongAxis, PointsAlongTheLineFromEitherEnd) {
  const Vector3d a(0.85, 0.15, 0.6), b(1.1, 0.25, 0.65);
  const vision::Feature feature = featureOf(FeatureKind::kLine, {a, b});
  const Plan plan = planned("aim_along_axis", feature, {{"stand_off", 0.15}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const Vector3d d = (b - a).normalized();
  EXPECT_LT((endOf(plan).translation() - (a - 0.15 * d)).norm(), kOnGoal);
  EXPECT_LT((endOf(plan).linear().col(2) - d).norm(), 1e-4);
  expectClean(plan);
  const Plan other = planned("aim_along_axis", featureOf(FeatureKind::kLine, {b, a}), {{"stand_off", 0.15}});
  ASSERT_TRUE(other.ok()) << other.reason << ": the nearer end is now the second";
  EXPECT_LT((endOf(other).translation() - (a - 0.15 * d)).norm(), kOnGoal);
}

TEST(PlaceDisruptor, StandsSquareInFrontOfThePackageAboveItsLowerEdge) {
  const Vector3d a(0.85, -0.15, 0.35), b(0.85, 0.15, 0.35);
  const Plan plan = planned("place_disruptor", featureOf(FeatureKind::kLine, {a, b}), {{"stand_off", 0.1}, {"height", 0.1}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_LT((endOf(plan).translation() - Vector3d(0.75, 0, 0.45)).norm(), kOnGoal);
  EXPECT_LT((endOf(plan).linear().col(2) - Vector3d::UnitX()).norm(), 1e-4);
  expectClean(plan);
  const Plan steep = planned("place_disruptor", featureOf(FeatureKind::kLine, {a, {0.85, -0.1, 0.6}}));
  EXPECT_EQ(steep.status, PlanStatus::kBadFeature);
  EXPECT_NE(steep.reason.find("slopes"), std::string::npos) << steep.reason;
}

TEST(InsertAlong, GoesInAlongTheLineAndExtractComesBackOut) {
  const Vector3d a(0.8, 0.1, 0.55), b(0.95, 0.15, 0.55), d = (b - a).normalized();
  const vision::Feature feature = featureOf(FeatureKind::kLine, {a, b});
  const Plan in = planned("insert_along", feature, {{"depth", 0.06}});
  ASSERT_TRUE(in.ok()) << in.reason;
  EXPECT_LT((endOf(in).translation() - (a + 0.06 * d)).norm(), kOnGoal);
  const PlanStage* insert = tests::stageOf(in, "insert");
  ASSERT_NE(insert, nullptr);
  EXPECT_LT(straightness(in, *insert).first, 1e-3);
  expectClean(in);
  PlanContext context = contextOf(cell());
  context.start = tests::planAt(cell(), in, in.trajectory.duration());
  context.arguments = {{"distance", 0.15}};
  const Plan out = macroOf("extract_along").plan(context, &feature);
  ASSERT_TRUE(out.ok()) << out.reason;
  EXPECT_LT((endOf(out).translation() - (a - 0.09 * d)).norm(), 2 * kOnGoal);
  EXPECT_LT(straightness(out, out.stages[0]).first, 1e-3);
  expectClean(out);
}

TEST(FollowPerimeter, GoesRoundInsideTheEdgeAtAnEvenHeight) {
  const vision::Feature feature = upright();
  const Plan plan = planned("follow_perimeter", feature, {{"inset", 0.02}, {"blend", 0.02}, {"stand_off", 0.06}, {"laps", 2}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const PlanStage& scan = plan.stages.back();
  double low_y = 1, high_y = -1, low_z = 1, high_z = 0, off = 0;
  for (double t = scan.start_s; t <= scan.end_s; t += 0.01) {
    const Vector3d p = toolAt(cell(), plan, t).translation();
    off = std::max(off, std::abs(p.x() - 0.79));
    low_y = std::min(low_y, p.y()), high_y = std::max(high_y, p.y());
    low_z = std::min(low_z, p.z()), high_z = std::max(high_z, p.z());
  }
  EXPECT_LT(off, 1e-3);
  EXPECT_NEAR(low_y, -0.13, 1e-3);
  EXPECT_NEAR(high_y, 0.13, 1e-3);
  EXPECT_NEAR(low_z, 0.42, 1e-3);
  EXPECT_NEAR(high_z, 0.60, 1e-3);
  EXPECT_NEAR(plan.figures.at("length"), 2 * (2 * (0.26 + 0.18) - 8 * 0.02 + 2 * M_PI * 0.02), 1e-9);
  EXPECT_LT((toolAt(cell(), plan, scan.start_s).translation() - endOf(plan).translation()).norm(), 1e-4);
  expectClean(plan);
}

TEST(Press, ReachesTheDepthBeyondTheSurfaceAndComesBack) {
  const Plan plan = planned("press", upright(), {{"depth", 0.004}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const PlanStage* press = tests::stageOf(plan, "press");
  ASSERT_NE(press, nullptr);
  const double overhang = toolOverhang(cell(), plan.start_configuration);
  EXPECT_NEAR(toolAt(cell(), plan, press->end_s).translation().x(), 0.85 - overhang + 0.004, 1e-4);
  EXPECT_LT((endOf(plan).translation() - toolAt(cell(), plan, tests::stageOf(plan, "approach")->start_s).translation()).norm(), 1e-4);
  expectClean(plan);
}

TEST(Wipe, GoesOverTheSurfaceWithTheToolsEndPressedOntoItAndNeverBeyondItsEdges) {
  const Plan plan = planned("wipe", upright(), {{"depth", 0.003}, {"inset", 0.02}, {"width", 0.04}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const PlanStage* wipe = tests::stageOf(plan, "wipe");
  ASSERT_NE(wipe, nullptr);
  const double pressed = 0.85 - toolOverhang(cell(), plan.start_configuration) + 0.003;
  double off = 0, low_y = 1, high_y = -1, low_z = 1, high_z = 0;
  for (double t = wipe->start_s; t <= wipe->end_s; t += 0.01) {
    const Vector3d p = toolAt(cell(), plan, t).translation();
    off = std::max(off, std::abs(p.x() - pressed));
    low_y = std::min(low_y, p.y()), high_y = std::max(high_y, p.y());
    low_z = std::min(low_z, p.z()), high_z = std::max(high_z, p.z());
  }
  EXPECT_LT(off, 1e-3) << "pressed all the way";
  EXPECT_GE(low_y, -0.13 - 1e-3);
  EXPECT_LE(high_y, 0.13 + 1e-3);
  EXPECT_GE(low_z, 0.42 - 1e-3);
  EXPECT_LE(high_z, 0.60 + 1e-3);
  EXPECT_GT(plan.figures.at("coverage"), 0.75) << "of what lies within the inset; the turns leave corners";
  EXPECT_LT(toolAt(cell(), plan, plan.trajectory.duration()).translation().x(), pressed - 0.07) << "and off it again";
  expectClean(plan);
  const Plan narrow = planned("wipe", upright(), {{"inset", 0.105}});
  EXPECT_EQ(narrow.status, PlanStatus::kLimits);
  EXPECT_NE(narrow.reason.find("20 mm"), std::string::npos) << narrow.reason;
}

TEST(GraspByFaces, PutsTheFingersOnFacesThatFit) {
  const Plan plan = planned("grasp_by_faces", crate());
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const Pose X = endOf(plan);
  EXPECT_GT(std::abs(X.linear().col(1).y()), 0.999) << "only its 80 mm fit between the fingers: they close along y";
  EXPECT_NEAR(X.translation().y(), 0, 1e-4);
  expectClean(plan, {crateBody()}, {"mark"});
  const Plan wide = planned("grasp_by_faces", featureOf(FeatureKind::kTriad, {{0.7, -0.1, 0.4}, {0.7, 0.1, 0.4}, {0.9, -0.1, 0.4}, {0.7, -0.1, 0.6}}));
  EXPECT_EQ(wide.status, PlanStatus::kLimits);
  EXPECT_NE(wide.reason.find("200.0 mm"), std::string::npos) << wide.reason;
}

TEST(PushFace, PushesTheFaceThatLooksAtTheArmByTheDistance) {
  const Plan plan = planned("push_face", crate(), {{"distance", 0.04}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const PlanStage* push = tests::stageOf(plan, "push");
  ASSERT_NE(push, nullptr);
  const Pose from = toolAt(cell(), plan, push->start_s), to = toolAt(cell(), plan, push->end_s);
  EXPECT_LT((to.translation() - from.translation() - 0.04 * from.linear().col(2)).norm(), 1e-4);
  EXPECT_LT(straightness(plan, *push).first, 1e-3);
  expectClean(plan, {crateBody()}, {"mark"});
}

TEST(ScanFaces, CoversEveryFaceTheCamerasSee) {
  const Plan plan = planned("scan_faces", crate());
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_GE(plan.figures.at("faces_visible"), 2);
  EXPECT_EQ(plan.figures.at("faces"), plan.figures.at("faces_visible"));
  EXPECT_GE(plan.figures.at("coverage"), 0.99);
  expectClean(plan, {crateBody()});
}

TEST(Macros, GiveTheSamePlanForTheSameSeed) {
  for (const auto& [macro, feature] : std::vector<std::pair<std::string, vision::Feature>>{
           {"touch", featureOf(FeatureKind::kPoint, {{0.7, 0.2, 0.5}})}, {"press", upright()}, {"push_face", crate()}}) {
    const Plan a = planned(macro, feature), b = planned(macro, feature);
    ASSERT_TRUE(a.ok()) << a.reason;
    ASSERT_EQ(a.trajectory.points.size(), b.trajectory.points.size());
    for (std::size_t i = 0; i < a.trajectory.points.size(); ++i) {
      EXPECT_EQ(a.trajectory.points[i].positions, b.trajectory.points[i].positions) << macro << ", bit for bit";
      EXPECT_EQ(a.trajectory.points[i].t, b.trajectory.points[i].t);
    }
  }
}

TEST(MacroFailures, SayWhatStageAndWhatWouldHelp) {
  const Plan far = planned("touch", featureOf(FeatureKind::kPoint, {{2.5, 0, 0.5}}));
  EXPECT_EQ(far.status, PlanStatus::kUnreachable);
  EXPECT_NE(far.reason.find("drive"), std::string::npos) << far.reason;
  ASSERT_TRUE(far.failed_pose.has_value());
  EXPECT_TRUE(far.trajectory.empty());
  const Plan long_way = planned("move_parallel", featureOf(FeatureKind::kLine, {{0, 0, 0}, {1, 0, 0}}), {{"distance", 1.5}}, "ready");
  EXPECT_EQ(long_way.status, PlanStatus::kUnreachable);
  EXPECT_NE(long_way.reason.find("\"act\" stops after"), std::string::npos) << long_way.reason;
  EXPECT_GE(long_way.failed_waypoint, 1);
  const std::vector<WorldObject> wall{tests::boxObject("wall", {0.02, 2, 2}, {0.95, 0, 0.8})};
  const Pose here = cell().model->forward(tests::configuration(cell(), "ready"), *cell().model->linkIndex("tool_tip"));
  const double into = 0.95 - here.translation().x() + 0.1;
  const Plan blocked = planned("move_parallel", featureOf(FeatureKind::kLine, {{0, 0, 0}, {1, 0, 0}}), {{"distance", into}}, "ready", wall);
  EXPECT_EQ(blocked.status, PlanStatus::kApproachBlocked) << blocked.reason;
  EXPECT_NE(blocked.reason.find("wall"), std::string::npos) << blocked.reason;
  const std::vector<WorldObject> around{tests::boxObject("crate", {0.4, 0.4, 0.4}, {0.75, 0, 0.5})};
  const Plan inside = planned("move_above", featureOf(FeatureKind::kPoint, {{0.75, 0, 0.4}}), {}, "home", around);
  EXPECT_EQ(inside.status, PlanStatus::kGoalInCollision) << inside.reason;
  EXPECT_NE(inside.reason.find("crate"), std::string::npos) << inside.reason;
}

TEST(MacroFailures, RefuseWrongFeaturesAndArgumentsOfEveryMacro) {
  for (const auto& macro : makeMacros(cell())) {
    const MacroInfo info = macro->info();
    PlanContext context = contextOf(cell());
    context.arguments = {{"no_such_parameter", 1}};
    const vision::Feature point = featureOf(FeatureKind::kPoint, {{0.7, 0, 0.5}});
    const vision::Feature line = featureOf(FeatureKind::kLine, {{0.7, 0, 0.5}, {0.7, 0.2, 0.5}});
    const vision::Feature& wrong = info.takes == FeatureKind::kPoint ? line : point;
    if (!info.takes) {
      EXPECT_EQ(macro->plan(context, nullptr).status, PlanStatus::kLimits) << info.name;
      continue;
    }
    EXPECT_EQ(macro->plan(context, &wrong).status, PlanStatus::kLimits) << info.name;
    context.arguments.clear();
    const Plan plan = macro->plan(context, &wrong);
    EXPECT_EQ(plan.status, PlanStatus::kBadFeature) << info.name;
    EXPECT_FALSE(plan.reason.empty());
    EXPECT_EQ(macro->plan(context, nullptr).status, PlanStatus::kBadFeature) << info.name;
    vision::Feature broken = featureOf(*info.takes, std::vector<Vector3d>(static_cast<std::size_t>(vision::vertexCount(*info.takes)), {0.7, 0, std::nan("")}));
    EXPECT_EQ(macro->plan(context, &broken).status, PlanStatus::kBadFeature) << info.name;
  }
}

TEST(MacroFailures, StopWhenCancelledBeforeTheyBegin) {
  PlanContext context = contextOf(cell());
  context.cancel.cancel();
  const vision::Feature feature = upright();
  EXPECT_EQ(macroOf("surface_scan").plan(context, &feature).status, PlanStatus::kCancelled);
  PlanContext late = contextOf(cell());
  late.budget_s = 0;
  EXPECT_EQ(macroOf("surface_scan").plan(late, &feature).status, PlanStatus::kTimeout);
}

// Cancelled at every instant at which progress is told, the last one included: never half a plan.
TEST(MacroFailures, EndAsCancelledWheneverItIsAskedFor) {
  const vision::Feature plane = upright(), box = crate(), pipe = featureOf(FeatureKind::kLine, {{0.7, -0.15, 0.45}, {0.7, 0.15, 0.45}});
  const std::vector<std::pair<std::string, const vision::Feature*>> all{{"surface_scan", &plane}, {"scan_faces", &box}, {"grab_pipe", &pipe}, {"ready", nullptr}};
  for (const auto& [macro, feature] : all) {
    int told = 0;
    PlanContext context = contextOf(cell());
    context.budget_s = 60;
    context.progress = [&](double, const std::string&) { ++told; };
    ASSERT_TRUE(macroOf(macro).plan(context, feature).ok()) << macro;
    ASSERT_GE(told, 2) << macro;
    for (int at = 1; at <= told; ++at) {
      int count = 0;
      context.cancel = CancelToken();
      context.progress = [&, at](double, const std::string&) {
        if (++count == at) context.cancel.cancel();
      };
      const Plan plan = macroOf(macro).plan(context, feature);
      EXPECT_EQ(plan.status, PlanStatus::kCancelled) << macro << ", " << at << " of " << told << ": " << plan.reason;
      EXPECT_TRUE(plan.trajectory.empty());
      EXPECT_LE(count, at + 1) << macro << ": what was under way may tell once more";
    }
  }
}

TEST(MacroFailures, NothingIsFreeInASpaceThatWasCancelled) {
  PlanContext context = contextOf(cell());
  PlanningRun run(context, "test");
  ASSERT_TRUE(run.begin());
  const auto world = run.makeWorld({}, run.configuration());
  const CancelToken cancel;
  const ArmSpace space(cell(), *world, run.configuration(), cancel);
  EXPECT_TRUE(space.valid(run.start()));
  EXPECT_TRUE(space.segmentFree(run.start(), run.start()));
  cancel.cancel();
  EXPECT_FALSE(space.valid(run.start()));
  EXPECT_FALSE(space.segmentFree(run.start(), run.start()));
}

TEST(MacroAccuracy, IsReportedAndNotRefused) {
  EXPECT_EQ(planned("press", upright(0.001)).go, "go");
  const Plan ask = planned("press", upright(0.005));
  EXPECT_TRUE(ask.ok());
  EXPECT_EQ(ask.go, "ask");
  EXPECT_FALSE(ask.accuracy_note.empty());
  EXPECT_EQ(planned("press", upright(0.02)).go, "no_go");
}

}  // namespace
}  // namespace longarm::planning
