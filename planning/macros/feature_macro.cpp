#include "planning/macros/feature_macro.h"

#include <algorithm>
#include <exception>

#include "core/text.h"
#include "planning/motion/timed_motion.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

constexpr double kHopeless = 3;          // times the need

std::string millimetres(double metres) { return formatFixed(metres * 1000, 1) + " mm"; }

Eigen::Vector3d eyeOf(const Workcell& cell, const Eigen::VectorXd& q, const Eigen::Vector3d& shoulder) {
  for (const auto& camera : cell.cameras) {
    if (const auto link = cell.model->linkIndex(camera.link)) return cell.model->forward(q, *link).translation();
  }
  return shoulder;
}

Eigen::Vector3d meanOf(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

}  // namespace

void judgeAccuracy(Plan& plan, double uncertainty, double need) {
  plan.go = uncertainty <= need ? "go" : uncertainty <= kHopeless * need ? "ask" : "no_go";
  if (uncertainty == 0) plan.accuracy_note = "The feature states no uncertainty.";
  if (uncertainty <= need) return;
  plan.accuracy_note = "The feature is known to " + millimetres(uncertainty) + " (95 %), this needs " + millimetres(need) +
                       (plan.go == "ask" ? ": measure again from nearer or with a wider baseline, or go on with care."
                                         : ": measure again from nearer or with a wider baseline.");
}

Plan FeatureMacro::plan(const PlanContext& context, const vision::Feature* feature) const {
  const MacroInfo about = info();
  try {
    if (feature == nullptr) {
      return PlanningRun(context, about.name).fail(PlanStatus::kBadFeature, about.title + " needs a " + vision::toString(*about.takes) + ": mark one first.");
    }
    return run(context, *feature);
  } catch (const std::exception& e) {
    return PlanningRun(context, about.name).fail(PlanStatus::kNoPath, std::string("Planning failed inside: ") + e.what());
  }
}

Plan FeatureMacro::run(const PlanContext& context, const vision::Feature& feature) const {
  const MacroInfo about = info();
  PlanningRun run(context, about.name);
  const auto arguments = MacroArguments::from(about, context.arguments);
  if (!arguments) return run.fail(PlanStatus::kLimits, "Cannot plan: " + arguments.error().message + ".");
  if (!run.begin()) return run.plan();
  auto points = rooted(feature, *about.takes, run.model(), context.start);
  if (!points) return run.fail(PlanStatus::kBadFeature, about.title + ": " + points.error().message + ".");
  MacroSetup setup{run, *arguments, *std::move(points)};
  setup.X_RT = run.model().forward(context.start, run.model().linkIndex(run.workcell().arm.tip_link).valueOr(run.model().rootLink()));
  setup.reach = reachOf(run.workcell(), context.start);
  setup.eye = eyeOf(run.workcell(), context.start, setup.reach.shoulder);
  setup.job.subject = "the " + std::string(vision::toString(*about.takes)) + " \"" + setup.feature.name + "\"";
  setup.job.place = meanOf(setup.feature.points);
  judgeAccuracy(run.plan(), setup.feature.uncertainty(), about.accuracy_need);
  if (const Status described = describe(setup); !described) {
    const bool limits = described.error().code == ErrorCode::kOutOfLimits;
    return run.fail(limits ? PlanStatus::kLimits : PlanStatus::kBadFeature, about.title + ": " + described.error().message + ".");
  }
  return planJob(setup);
}

Plan FeatureMacro::planJob(MacroSetup& setup) const {
  PlanningRun& run = setup.run;
  const std::vector<std::string> notes = run.plan().notes;
  const auto world = run.makeWorld({}, run.context().start);
  run.plan().notes = notes;              // the planner looks at the start again, with the job's own obstacles
  const ArmSpace space(run.workcell(), *world, run.context().start);
  if (setup.arm_stays) {
    appendStage(run.plan(), "aim", false, standStill(run.workcell().armJointNames(), run.start(), 0.1));
    run.plan().min_clearance = leastClearance(space, run.plan().trajectory, 0, 0.1);
    run.plan().goal = setup.X_RT;
    return run.finish();
  }
  for (TaskPart& part : setup.job.parts) {
    std::stable_sort(part.tasks.begin(), part.tasks.end(),
                     [](const ToolTask& a, const ToolTask& b) { return a.preference < b.preference; });
  }
  Plan plan = TaskPlanner(run, setup.job).plan();
  if (plan.ok() && setup.measure) setup.measure(space, plan);
  return plan;
}

}  // namespace longarm::planning
