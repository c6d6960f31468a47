// plan, check
#include "app/verbs/cli.h"
#include "core/text.h"
#include "planning/macros/macro.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/plan_report.h"
#include "planning/motion/check_trajectory.h"
#include "planning/trajectory/trajectory_file.h"
#include "planning/world/workcell.h"
#include "vision/sketch/feature.h"

namespace longarm::app {
namespace {

using planning::Workcell;

struct PlanOptions {
  std::string workcell, macro, feature, name, start = "home", out;
  std::vector<std::string> parameters;
  unsigned seed = 1;
  double budget_s = 5;
};

struct CheckVerbOptions {
  std::string workcell, trajectory, start = "home";
};

Result<Workcell> workcellOption(const std::string& path) {
  return path.empty() ? planning::loadBuiltInWorkcell() : planning::loadWorkcell(path);
}

std::string rootName(const Workcell& workcell) {
  return workcell.model->links()[static_cast<std::size_t>(workcell.model->rootLink())].name;
}

// A canned pose by name, or the arm's joints as numbers; the gripper stands open.
Result<Eigen::VectorXd> startOption(const Workcell& workcell, const std::string& start) {
  const auto& model = *workcell.model;
  Eigen::VectorXd q = model.neutral();
  const auto set = [&](const std::string& joint, double value) {
    const auto index = model.jointIndex(joint);
    if (index && model.joints()[static_cast<std::size_t>(*index)].q_index >= 0) {
      q[model.joints()[static_cast<std::size_t>(*index)].q_index] = value;
    }
  };
  if (workcell.gripper) set(workcell.gripper->joint, workcell.gripper->open);
  const auto pose = workcell.poses.find(start);
  if (pose != workcell.poses.end()) {
    for (const auto& [joint, value] : pose->second) {
      if (!workcell.gripper || joint != workcell.gripper->joint) set(joint, value);
    }
    return q;
  }
  const auto numbers = parseNumbers(start);
  if (!numbers || numbers->empty()) {
    std::string names;
    for (const auto& [name, joints] : workcell.poses) names += (names.empty() ? "" : ", ") + name;
    return Error{ErrorCode::kInvalidInput, "--start: \"" + start + "\" is no pose of the workcell (" + names +
                                               ") and no comma-separated joint list"};
  }
  const auto joints = workcell.armJointNames();
  if (numbers->size() != joints.size()) {
    return Error{ErrorCode::kInvalidInput, "--start: " + std::to_string(numbers->size()) + " values given, the arm has " +
                                               std::to_string(joints.size()) + " joints"};
  }
  for (std::size_t i = 0; i < joints.size(); ++i) set(joints[i], (*numbers)[i]);
  return q;
}

// One feature, or what `target` printed: its first good feature, or the one of that name.
Result<vision::Feature> featureOption(const std::string& path, const std::string& name) {
  const auto json = readJsonFile(path);
  if (!json) return json.error();
  nlohmann::json chosen = *json;
  if (json->is_object() && json->contains("features") && (*json)["features"].is_array()) {
    chosen = nlohmann::json();
    for (const auto& f : (*json)["features"]) {
      const bool wanted = f.is_object() && f.contains("vertices") && (name.empty() || f.value("name", "") == name);
      if (wanted && chosen.is_null()) chosen = f;
    }
    if (chosen.is_null()) {
      return Error{ErrorCode::kInvalidInput, path + ": has no measured feature" + (name.empty() ? "" : " named \"" + name + "\"")};
    }
  }
  auto feature = vision::featureFromJson(chosen);
  if (!feature) return Error{feature.error().code, path + ": " + feature.error().message};
  return feature;
}

std::string planTable(const planning::Plan& plan) {
  if (!plan.ok()) return std::string(planning::toString(plan.status)) + ": " + plan.reason + "\n";
  std::string text = plan.macro + ": " + formatFixed(plan.trajectory.duration(), 2) + " s, clearance " +
                     formatFixed(plan.min_clearance * 1e3, 1) + " mm, velocity " + formatFixed(100 * plan.max_velocity_ratio, 0) +
                     " %, acceleration " + formatFixed(100 * plan.max_acceleration_ratio, 0) + " % of the limits; " + plan.go + "\n";
  if (!plan.accuracy_note.empty()) text += plan.accuracy_note + "\n";
  for (const auto& [name, value] : plan.figures) text += name + ": " + formatFixed(value, 4) + "\n";
  for (const auto& note : plan.notes) text += "note: " + note + "\n";
  return text;
}

// "name=value", in the parameter's unit.
Result<std::map<std::string, double>> argumentsOption(const planning::MacroInfo& info, const std::vector<std::string>& given) {
  std::map<std::string, double> out;
  for (const auto& text : given) {
    const std::size_t equals = text.find('=');
    const auto value = equals == std::string::npos ? std::nullopt : parseNumber(std::string_view(text).substr(equals + 1));
    if (!value) return Error{ErrorCode::kInvalidInput, "--param: \"" + text + "\" is not name=value with a number"};
    out[text.substr(0, equals)] = *value;
  }
  if (const auto good = planning::MacroArguments::from(info, out); !good) {
    return Error{ErrorCode::kInvalidInput, "--param: " + good.error().message};
  }
  return out;
}

Result<planning::Plan> makePlan(const Workcell& workcell, const PlanOptions& options) {
  const auto macros = planning::makeMacros(workcell);
  const planning::Macro* macro = planning::findMacro(macros, options.macro);
  if (macro == nullptr) {
    std::string names;
    for (const auto& m : macros) names += (names.empty() ? "" : ", ") + m->info().name;
    return Error{ErrorCode::kInvalidInput, "--macro: there is no macro \"" + options.macro + "\"; the workcell has " + names};
  }
  std::optional<vision::Feature> feature;
  if (macro->info().takes) {
    if (options.feature.empty()) {
      return Error{ErrorCode::kInvalidInput, "--macro: " + options.macro + " needs a " + vision::toString(*macro->info().takes) +
                                                 "; give it with --feature"};
    }
    auto read = featureOption(options.feature, options.name);
    if (!read) return read.error();
    feature = *read;
  } else if (!options.feature.empty()) {
    return Error{ErrorCode::kInvalidInput, "--feature: " + options.macro + " takes no feature"};
  }
  const auto start = startOption(workcell, options.start);
  if (!start) return start.error();
  const auto arguments = argumentsOption(macro->info(), options.parameters);
  if (!arguments) return arguments.error();
  planning::PlanContext context;
  context.arguments = *arguments;
  context.workcell = &workcell;
  context.start = *start;
  context.seed = options.seed;
  context.budget_s = options.budget_s;
  return macro->plan(context, feature ? &*feature : nullptr);
}

Result<Answer> runPlan(const PlanOptions& options) {
  const auto workcell = workcellOption(options.workcell);
  if (!workcell) return workcell.error();
  const auto plan = makePlan(*workcell, options);
  if (!plan) return plan.error();
  if (plan->ok() && !options.out.empty()) {
    if (const auto written = planning::writeTrajectory(options.out, plan->trajectory); !written) return written.error();
  }
  return Answer{planning::toJson(*plan, rootName(*workcell)), planTable(*plan), plan->ok() ? kExitDone : kExitNoSolution};
}

Result<Answer> runCheck(const CheckVerbOptions& options) {
  const auto workcell = workcellOption(options.workcell);
  if (!workcell) return workcell.error();
  const auto trajectory = planning::readTrajectory(options.trajectory);
  if (!trajectory) return trajectory.error();
  const auto q = startOption(*workcell, options.start);
  if (!q) return q.error();
  const auto report = planning::checkTrajectory(*workcell, *trajectory, *q);
  if (!report) return Error{report.error().code, options.trajectory + ": " + report.error().message};
  std::string table = report->ok ? "nothing wrong in " + std::to_string(report->states) + " configurations\n" : "";
  for (const auto& v : report->violations) table += "at " + formatFixed(v.t, 3) + " s: " + v.sentence + "\n";
  return Answer{planning::toJson(*report), table, report->ok ? kExitDone : kExitNoSolution};
}

}  // namespace

void addPlanVerbs(Cli& cli) {
  cli.addVerb<PlanOptions>(
      cli.app(), "plan", "Plan a macro's collision-free motion", "longarm plan --macro grab_pipe --feature pipe.json --out t.json --json",
      [](CLI::App& verb, PlanOptions& options) {
        verb.add_option("--workcell", options.workcell, "Workcell file (default: the built-in robot alone)");
        verb.add_option("--macro", options.macro, "Name of the macro (longarm list macros)")->required();
        verb.add_option("--feature", options.feature, "Feature to act on, as `target` prints it");
        verb.add_option("--name", options.name, "Which feature of that file (default: the first)");
        verb.add_option("--param", options.parameters, "Parameter of the macro as name=value, SI units and radians; may be repeated");
        verb.add_option("--start", options.start, "Canned pose, or the arm's joints comma separated")->capture_default_str();
        verb.add_option("--seed", options.seed, "Seed of the planner")->capture_default_str();
        verb.add_option("--budget", options.budget_s, "Give up after this many seconds")->check(CLI::Range(0.05, 600.0))->capture_default_str();
        verb.add_option("--out", options.out, "Where to write the trajectory");
      },
      runPlan);
  cli.addVerb<CheckVerbOptions>(
      cli.app(), "check", "Look for broken limits, collisions and jumps in a trajectory",
      "longarm check --trajectory t.json --json",
      [](CLI::App& verb, CheckVerbOptions& options) {
        verb.add_option("--workcell", options.workcell, "Workcell file (default: the built-in robot alone)");
        verb.add_option("--trajectory", options.trajectory, "Trajectory file")->required();
        verb.add_option("--start", options.start, "Pose of the joints the trajectory does not name")->capture_default_str();
      },
      runCheck);
}

}  // namespace longarm::app
