#include "planning/macros/feature_macro.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/text.h"
#include "planning/macros/accuracy.h"
#include "planning/macros/job_reach.h"
#include "planning/motion/timed_motion.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

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

// Where it is not the base's z, what is meant by "above" should be seen.
void noteUp(PlanningRun& run) {
  constexpr double kTold_deg = 0.5;
  const double off = std::acos(std::clamp(run.up().z(), -1.0, 1.0)) * 180 / M_PI;
  if (off < kTold_deg) return;
  run.plan().notes.push_back("Up is what the robot's attitude sensor says: " + formatFixed(off, 1) + " deg off the base's z.");
}

void sortParts(ToolJob& job) {
  for (TaskPart& part : job.parts) {
    std::stable_sort(part.tasks.begin(), part.tasks.end(),
                     [](const ToolTask& a, const ToolTask& b) { return a.preference < b.preference; });
  }
}

}  // namespace

Plan FeatureMacro::plan(const PlanContext& context, const vision::Feature* feature) const {
  const MacroInfo about = info();
  try {
    if (feature == nullptr) {
      return PlanningRun(context, about.name).fail(PlanStatus::kBadFeature, about.title + " needs a " + vision::toString(*about.takes) + ": mark one first.");
    }
    return run(context, *feature, [this](MacroSetup& setup) { return planJob(setup); });
  } catch (const std::exception& e) {
    return PlanningRun(context, about.name).fail(PlanStatus::kNoPath, std::string("Planning failed inside: ") + e.what());
  }
}

ReachAnswer FeatureMacro::reach(const PlanContext& context, const vision::Feature& feature, const ReachSeed& seed) const {
  ReachAnswer answer;
  bool described = false;
  try {
    const Plan plan = run(context, feature, [&](MacroSetup& setup) {
      described = true;
      sortParts(setup.job);
      answer = reachOfJob(setup.run, setup.job, seed);
      if (setup.arm_stays) answer.level = ReachAnswer::Level::kReached;
      return setup.run.plan();
    });
    if (!described) answer = {ReachAnswer::Level::kNot, plan.reason, 0, {}};
  } catch (const std::exception& e) {
    answer = {ReachAnswer::Level::kUnknown, std::string("Looking failed inside: ") + e.what(), 0, {}};
  }
  return answer;
}

Plan FeatureMacro::run(const PlanContext& context, const vision::Feature& feature, const std::function<Plan(MacroSetup&)>& use) const {
  const MacroInfo about = info();
  PlanningRun run(context, about.name);
  const auto arguments = MacroArguments::from(about, context.arguments);
  if (!arguments) return run.fail(PlanStatus::kLimits, "Cannot plan: " + arguments.error().message + ".");
  if (!run.begin()) return run.plan();
  auto points = rooted(feature, *about.takes, run.model(), context.start);
  if (!points) return run.fail(PlanStatus::kBadFeature, about.title + ": " + points.error().message + ".");
  if (about.uses_up && context.up) noteUp(run);
  MacroSetup setup{run, *arguments, *std::move(points)};
  setup.X_RT = run.model().forward(context.start, run.model().linkIndex(run.workcell().arm.tip_link).valueOr(run.model().rootLink()));
  setup.reach = reachOf(run.workcell(), context.start);
  setup.eye = eyeOf(run.workcell(), context.start, setup.reach.shoulder);
  setup.job.subject = "the " + std::string(vision::toString(*about.takes)) + " \"" + setup.feature.name + "\"";
  setup.job.place = meanOf(setup.feature.points);
  const AccuracyVerdict verdict = judgeAccuracy(setup.feature.uncertainty(), about.accuracy_need);
  run.plan().go = verdict.go;
  run.plan().accuracy_note = verdict.note;
  if (const Status described = describe(setup); !described) {
    const bool limits = described.error().code == ErrorCode::kOutOfLimits;
    return run.fail(limits ? PlanStatus::kLimits : PlanStatus::kBadFeature, about.title + ": " + described.error().message + ".");
  }
  return use(setup);
}

Plan FeatureMacro::planJob(MacroSetup& setup) const {
  PlanningRun& run = setup.run;
  const bool from_here = !setup.job.parts.empty() && setup.job.parts.front().from_here;
  if (from_here || setup.arm_stays) run.keepContact();
  else if (!run.leaveContact()) return run.plan();
  const std::vector<std::string> notes = run.plan().notes;
  const auto world = run.makeWorld({}, run.configuration());
  run.plan().notes = notes;              // the planner looks at the start again, with the job's own obstacles
  const ArmSpace space(run.workcell(), *world, run.configuration(), run.context().cancel);
  if (setup.arm_stays) {
    appendStage(run.plan(), "aim", false, standStill(run.workcell().armJointNames(), run.start(), 0.1));
    measureClearance(space, run.plan(), 0, 0.1);
    run.plan().goal = setup.X_RT;
    return run.finish();
  }
  sortParts(setup.job);
  Plan plan = TaskPlanner(run, setup.job).plan();
  if (plan.ok() && setup.measure) setup.measure(space, plan);
  return plan;
}

}  // namespace longarm::planning
