// The quick look at reach agrees with planning, and goes on from how it was done a moment ago.
#include <gtest/gtest.h>

#include "tests/planning/macro_scene.h"

namespace longarm::planning {
namespace {

using tests::contextOf;
using tests::featureOf;
using tests::macroOf;
using vision::FeatureKind;
using Level = ReachAnswer::Level;

const Workcell& cell() { return tests::builtIn(); }

PlanContext patient() {
  PlanContext context = contextOf(cell());
  context.budget_s = 60;                 // a loaded machine must not change the answer
  return context;
}

TEST(MacroReach, AgreesWithPlanningNearAndFar) {
  const vision::Feature near = featureOf(FeatureKind::kPoint, {{0.75, 0.1, 0.45}}), far = featureOf(FeatureKind::kPoint, {{3, 0, 0.5}});
  for (const char* name : {"touch", "move_above", "place_here"}) {
    const ReachAnswer yes = macroOf(name).reach(patient(), near, {});
    EXPECT_NE(yes.level, Level::kNot) << name << ": " << yes.reason;
    EXPECT_TRUE(macroOf(name).plan(patient(), &near).ok()) << name;
    const ReachAnswer no = macroOf(name).reach(patient(), far, {});
    EXPECT_EQ(no.level, Level::kNot) << name;
    EXPECT_NE(no.reason.find("reach"), std::string::npos) << no.reason;
  }
  const vision::Feature pipe = featureOf(FeatureKind::kLine, {{0.7, -0.15, 0.45}, {0.7, 0.15, 0.45}});
  const vision::Feature away = featureOf(FeatureKind::kLine, {{2.7, -0.15, 0.45}, {2.7, 0.15, 0.45}});
  EXPECT_EQ(macroOf("grab_pipe").reach(patient(), pipe, {}).level, Level::kReached);
  EXPECT_EQ(macroOf("grab_pipe").reach(patient(), away, {}).level, Level::kNot);
}

TEST(MacroReach, NamesWhatIsInTheWay) {
  PlanContext context = patient();
  context.objects = {tests::boxObject("crate", {0.4, 0.4, 0.4}, {0.75, 0, 0.5})};
  const ReachAnswer answer = macroOf("move_above").reach(context, featureOf(FeatureKind::kPoint, {{0.75, 0, 0.4}}), {});
  EXPECT_EQ(answer.level, Level::kNot);
  EXPECT_NE(answer.reason.find("crate"), std::string::npos) << answer.reason;
}

TEST(MacroReach, FollowsADragFromTheAnswerBefore) {
  ReachAnswer last;
  int same = 0;
  for (int i = 0; i < 30; ++i) {
    const vision::Feature point = featureOf(FeatureKind::kPoint, {{0.75, 0.1 + 0.002 * i, 0.45}});
    const ReachAnswer next = macroOf("touch").reach(patient(), point, last.seed);
    ASSERT_TRUE(next.level == Level::kReached || next.level == Level::kStrained) << i << ": " << next.reason;
    if (i > 0 && next.seed.task == last.seed.task) {
      ++same;
      EXPECT_LT((next.seed.entry - last.seed.entry).cwiseAbs().maxCoeff(), 0.1) << "the same posture, a little further";
    }
    last = next;
  }
  EXPECT_GE(same, 25) << "of 29; now and then a better way opens";
}

TEST(MacroReach, SaysWhenTimeWasTooShort) {
  PlanContext context = contextOf(cell());
  context.budget_s = 0;
  EXPECT_EQ(macroOf("touch").reach(context, featureOf(FeatureKind::kPoint, {{0.75, 0.1, 0.45}}), {}).level, Level::kStrained);
}

TEST(MacroReach, RefusesBadFeaturesWithASentence) {
  const ReachAnswer answer = macroOf("touch").reach(patient(), featureOf(FeatureKind::kPoint, {{0.7, 0, std::nan("")}}), {});
  EXPECT_EQ(answer.level, Level::kNot);
  EXPECT_FALSE(answer.reason.empty());
  EXPECT_EQ(macroOf("home").reach(patient(), featureOf(FeatureKind::kPoint, {{0.7, 0, 0.5}}), {}).level, Level::kUnknown);
}

}  // namespace
}  // namespace longarm::planning
