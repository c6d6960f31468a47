// move_to and look_around: where the tool and the camera go, what they keep clear of, and what would help when they cannot.
#include <cmath>

#include <gtest/gtest.h>

#include "planning/macros/camera_look.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/move_to.h"
#include "planning/motion/ladder.h"
#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using tests::contextOf;
using tests::featureOf;
using tests::macroOf;
using vision::FeatureKind;

const Workcell& cell() { return tests::builtIn(); }
const std::map<std::string, double> kDown{{"x", 0.70}, {"y", 0.15}, {"z", 0.55}, {"roll", M_PI}, {"pitch", 0}, {"yaw", 2.8}};

std::map<std::string, double> with(std::map<std::string, double> values, const std::map<std::string, double>& others) {
  for (const auto& [name, value] : others) values[name] = value;
  return values;
}

Plan planned(const std::string& macro, const vision::Feature* feature, const std::map<std::string, double>& arguments,
             const std::vector<WorldObject>& objects = {}, const std::string& start = "ready") {
  PlanContext context = contextOf(cell(), start);
  context.arguments = arguments;
  context.objects = objects;
  context.budget_s = 60;                 // a loaded machine must not change the answer
  return macroOf(macro).plan(context, feature);
}

Pose toolAt(const std::string& pose) {
  return cell().model->forward(tests::configuration(cell(), pose), *cell().model->linkIndex(cell().arm.tip_link));
}

Pose endOf(const Plan& plan) { return tests::toolAt(cell(), plan, plan.trajectory.duration()); }

void expectAt(const Pose& X, const Pose& wanted) {
  EXPECT_LT((X.translation() - wanted.translation()).norm(), 1e-5);
  EXPECT_LT(angleBetween(X.linear(), wanted.linear()), 1e-5);
}

bool tells(const std::vector<std::string>& sentences, const std::string& words) {
  return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& s) { return s.find(words) != std::string::npos; });
}

void expectClean(const Plan& plan, const std::vector<WorldObject>& objects) {
  for (const auto& v : tests::sweepOf(cell(), plan, objects).violations) ADD_FAILURE() << plan.macro << ": " << v.sentence;
}

TEST(MoveTo, TakesTheToolToTheTypedPose) {
  const Plan plan = planned("move_to", nullptr, kDown);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  expectAt(endOf(plan), poseFromRpy({0.70, 0.15, 0.55}, {M_PI, 0, 2.8}));
  ASSERT_EQ(plan.stages.size(), 1u);
  EXPECT_EQ(plan.stages[0].name, "transit");
  EXPECT_EQ(plan.go, "go");
  expectClean(plan, {});
}

TEST(MoveTo, LeavesWhatIsNotGivenAsItIs) {
  const Pose now = toolAt("ready");
  const Plan up = planned("move_to", nullptr, {{"z", now.translation().z() + 0.08}});
  ASSERT_TRUE(up.ok()) << up.reason;
  expectAt(endOf(up), Eigen::Translation3d(0, 0, 0.08) * now);
  const Plan stay = planned("move_to", nullptr, {});
  ASSERT_TRUE(stay.ok()) << stay.reason;
  expectAt(endOf(stay), now);
  EXPECT_TRUE(tells(stay.notes, "already there"));
  EXPECT_LT((stay.trajectory.points.back().positions - stay.trajectory.points.front().positions).norm(), 1e-6);
}

TEST(MoveTo, DefaultsAreThePoseOfTheTool) {
  Random random(7);
  const MoveTo macro(cell());
  for (int i = 0; i < 200; ++i) {
    Eigen::VectorXd q = tests::configuration(cell(), "ready");
    for (Eigen::Index j = 0; j < q.size(); ++j) q[j] += random.uniform(-1.5, 1.5);
    auto at = macro.defaultsAt(cell(), q);
    ASSERT_TRUE(MacroArguments::from(macro.info(), at).ok());
    const Pose X = poseFromRpy({at["x"], at["y"], at["z"]}, {at["roll"], at["pitch"], at["yaw"]});
    const Pose wanted = cell().model->forward(q, *cell().model->linkIndex(cell().arm.tip_link));
    EXPECT_LT((X.matrix() - wanted.matrix()).norm(), 1e-9);
  }
  EXPECT_TRUE(macro.defaultsAt(cell(), Eigen::VectorXd::Zero(1)).empty());
}

TEST(MoveTo, GoesRoundABodyThatStandsInTheStraightWay) {
  const auto left = with(kDown, {{"y", 0.35}}), right = with(kDown, {{"y", -0.35}});
  const Plan there = planned("move_to", nullptr, left);
  ASSERT_TRUE(there.ok()) << there.reason;
  PlanContext context = contextOf(cell(), "ready");
  context.start = tests::planAt(cell(), there, there.trajectory.duration());
  context.arguments = right;
  context.budget_s = 60;
  const std::vector<WorldObject> post{tests::boxObject("post", {0.3, 0.06, 0.9}, {0.72, 0, 0.45})};
  const Plan without = macroOf("move_to").plan(context, nullptr);
  context.objects = post;
  const Plan round = macroOf("move_to").plan(context, nullptr);
  ASSERT_TRUE(without.ok() && round.ok()) << without.reason << round.reason;
  expectAt(endOf(round), endOf(without));
  expectClean(round, post);
  EXPECT_FALSE(tests::sweepOf(cell(), without, post).ok) << "the straight way must be blocked, or the test shows nothing";
}

TEST(MoveTo, NamesTheBodyAtThePoseAndATurnThatIsFree) {
  const std::vector<WorldObject> crate{tests::boxObject("crate", {0.3, 0.3, 0.3}, {0.70, 0.15, 0.55})};
  const Plan inside = planned("move_to", nullptr, kDown, crate);
  EXPECT_EQ(inside.status, PlanStatus::kGoalInCollision) << inside.reason;
  EXPECT_NE(inside.reason.find("crate"), std::string::npos) << inside.reason;
  EXPECT_TRUE(tells(inside.advice, "\"crate\" is in the way"));
  EXPECT_TRUE(tells(inside.advice, "it gets as far as")) << "short of the crate";
  EXPECT_FALSE(tells(inside.advice, "Drive")) << "the pose goes with the base";
}

TEST(MoveTo, SaysHowFarItGetsWhereItDoesNotReach) {
  const Plan far = planned("move_to", nullptr, with(kDown, {{"x", 2.5}}));
  EXPECT_EQ(far.status, PlanStatus::kUnreachable);
  EXPECT_NE(far.reason.find("x 2.500"), std::string::npos) << far.reason;
  EXPECT_NE(far.reason.find("the arm reaches"), std::string::npos) << far.reason;
  EXPECT_TRUE(tells(far.advice, "it gets as far as"));
  EXPECT_TRUE(tells(far.advice, "Now the tool is at x"));
  EXPECT_FALSE(tells(far.advice, "Drive"));
  EXPECT_TRUE(far.failed_pose.has_value());
  // Within reach, but not with the tool pointing back at the robot.
  const Plan turned = planned("move_to", nullptr, with(kDown, {{"x", 1.05}, {"roll", 0}, {"pitch", -M_PI / 2}, {"yaw", 0}}));
  ASSERT_EQ(turned.status, PlanStatus::kUnreachable) << turned.reason;
  EXPECT_TRUE(tells(turned.advice, "At that place the tool can be held at roll"));
}

TEST(MoveTo, RefusesFeaturesAndValuesBeyondTheirRange) {
  const auto point = featureOf(FeatureKind::kPoint, {{0.7, 0, 0.5}});
  EXPECT_EQ(planned("move_to", &point, {}).status, PlanStatus::kBadFeature);
  const Plan wild = planned("move_to", nullptr, {{"x", 50}});
  EXPECT_EQ(wild.status, PlanStatus::kLimits);
  EXPECT_NE(wild.reason.find("x = 50"), std::string::npos) << wild.reason;
}

// A box of 0.1 x 0.08 x 0.12 m before the robot.
vision::Feature box(const Vector3d& corner = {0.70, -0.04, 0.40}) {
  return featureOf(FeatureKind::kTriad, {corner, corner + Vector3d(0, 0.08, 0), corner + Vector3d(0.1, 0, 0), corner + Vector3d(0, 0, 0.12)});
}
std::vector<WorldObject> bodyOf(const vision::Feature& feature) {
  RootedFeature rooted{"mark", {}, {}};
  for (const auto& v : feature.vertices) rooted.points.push_back(v.xyz);
  return {boxPatchFrom(rooted)->object("mark")};
}

// Every stage ends where the eye looks at the middle from the wanted distance and elevation.  @returns their azimuths [rad].
std::vector<double> expectViews(const Plan& plan, const Pose& X_TC, double distance, double elevation) {
  const Vector3d middle(0.75, 0, 0.46);
  std::vector<double> azimuths;
  for (const auto& stage : plan.stages) {
    EXPECT_EQ(stage.name.rfind("view ", 0), 0u) << stage.name;
    const Pose X_RC = tests::toolAt(cell(), plan, stage.end_s) * X_TC;
    const Vector3d out = X_RC.translation() - middle;
    EXPECT_NEAR(out.norm(), distance, 1e-4) << stage.name;
    EXPECT_NEAR(std::asin(out.z() / out.norm()), elevation, 1e-4) << stage.name;
    EXPECT_LT((X_RC.linear().col(2) + out.normalized()).norm(), 1e-4) << stage.name << " looks at the middle";
    azimuths.push_back(std::atan2(out.y(), out.x()));
  }
  return azimuths;
}

TEST(LookAround, StandsOnARingAndLooksAtTheMiddle) {
  const auto feature = box();
  const Plan plan = planned("look_around", &feature, {{"views", 6}, {"stand_off", 0.15}, {"elevation", 0.7}});
  ASSERT_TRUE(plan.ok()) << plan.reason;
  const auto eye = armEyeOf(cell(), tests::configuration(cell(), "ready"), toolAt("ready"));
  ASSERT_TRUE(eye.has_value());
  const auto azimuths = expectViews(plan, eye->X_CT.inverse(), 0.15 + 0.5 * Vector3d(0.1, 0.08, 0.12).norm(), 0.7);
  ASSERT_GE(azimuths.size(), 2u);
  for (std::size_t i = 1; i < azimuths.size(); ++i) {
    const double steps = std::abs(std::remainder(azimuths[i] - azimuths[i - 1], 2 * M_PI)) / (M_PI / 3);
    EXPECT_NEAR(steps, std::round(steps), 1e-3);
    EXPECT_GT(steps, 0.5) << "never twice the same";
  }
  EXPECT_EQ(plan.figures.at("views"), static_cast<double>(azimuths.size()));
  EXPECT_EQ(plan.figures.at("views_wanted"), 6);
  EXPECT_TRUE(tells(plan.notes, std::to_string(azimuths.size()) + " of 6 views"));
  expectClean(plan, bodyOf(feature));
}

TEST(LookAround, LeavesOutAndNamesTheViewsThatAreBlocked) {
  const auto feature = box();
  const std::map<std::string, double> arguments{{"views", 6}, {"stand_off", 0.15}, {"elevation", 0.7}};
  const Plan open = planned("look_around", &feature, arguments);
  ASSERT_TRUE(open.ok()) << open.reason;
  // A cabinet to the left of the box.
  const std::vector<WorldObject> cabinet{tests::boxObject("cabinet", {0.4, 0.3, 1.2}, {0.9, 0.32, 0.6})};
  const Plan some = planned("look_around", &feature, arguments, cabinet);
  ASSERT_TRUE(some.ok()) << some.reason;
  EXPECT_LT(some.figures.at("views"), open.figures.at("views"));
  EXPECT_GE(some.figures.at("views"), 2);
  EXPECT_TRUE(tells(some.notes, "is left out"));
  auto objects = bodyOf(feature);
  objects.push_back(cabinet[0]);
  expectClean(some, objects);
}

TEST(LookAround, NeedsTwoViewsAndSaysWhatWouldHelp) {
  const auto far = box({2.6, -0.04, 0.40});
  const Plan none = planned("look_around", &far, {});
  EXPECT_EQ(none.status, PlanStatus::kUnreachable);
  EXPECT_NE(none.reason.find("the arm reaches"), std::string::npos) << none.reason;
  EXPECT_NE(none.reason.find("drive"), std::string::npos) << none.reason;
  // Away from the arm step by step, until only one view is left.
  bool met = false;
  for (double x = 0.9; x < 1.6 && !met; x += 0.05) {
    const auto feature = box({x, -0.04, 0.40});
    const Plan plan = planned("look_around", &feature, {{"views", 6}});
    EXPECT_TRUE(!plan.ok() || plan.figures.at("views") >= 2);
    met = plan.reason.find("Only 1 of 6") != std::string::npos;
    EXPECT_EQ(met, plan.reason.find("2 are needed") != std::string::npos) << plan.reason;
  }
  EXPECT_TRUE(met);
}

TEST(LookAround, AtAGlanceAgreesWithPlanning) {
  PlanContext context = contextOf(cell(), "ready");
  context.budget_s = 60;
  const auto near = box(), far = box({2.6, -0.04, 0.40});
  EXPECT_EQ(macroOf("look_around").reach(context, near, {}).level, ReachAnswer::Level::kReached);
  const ReachAnswer no = macroOf("look_around").reach(context, far, {});
  EXPECT_EQ(no.level, ReachAnswer::Level::kNot);
  EXPECT_NE(no.reason.find("reach"), std::string::npos) << no.reason;
}

TEST(LookAround, LooksAlongTheToolWhereTheArmHasNoCamera) {
  Workcell blind = cell();
  blind.cameras.clear();
  PlanContext context = contextOf(blind, "ready");
  context.arguments = {{"views", 6}, {"stand_off", 0.15}, {"elevation", 0.7}};
  context.budget_s = 60;
  const auto feature = box();
  const Plan plan = macroOf("look_around").plan(context, &feature);
  ASSERT_TRUE(plan.ok()) << plan.reason;
  EXPECT_TRUE(tells(plan.notes, "no camera"));
  EXPECT_GE(expectViews(plan, Pose::Identity(), 0.15 + 0.5 * Vector3d(0.1, 0.08, 0.12).norm(), 0.7).size(), 2u);
}

}  // namespace
}  // namespace longarm::planning
