// run: a whole task on the virtual robot with no operator
#include "app/verbs/cli.h"
#include "core/text.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"
#include "session/task_runner.h"

namespace longarm::app {
namespace {

struct RunOptions {
  std::string scenario = "grab_pipe", workcell, faults;
  unsigned seed = 1;
  double click_sigma_px = 0.5, speed = 1;
  bool lockstep = false, ideal = false;
};

Result<planning::Workcell> workcellOf(const RunOptions& options, const planning::Scenario& scenario) {
  return options.workcell.empty() ? planning::workcellOf(scenario) : planning::loadWorkcell(options.workcell);
}

std::string stagesTable(const session::TaskReport& report) {
  std::vector<std::vector<std::string>> rows = {{"stage", "", "seconds", "what"}};
  for (const auto& stage : report.stages) {
    rows.push_back({stage.name, stage.ok ? "ok" : "FAILED", formatFixed(stage.seconds, 2), stage.detail});
  }
  std::string text = tableText(rows);
  for (const auto& stop : report.stops) text += "stopped at " + formatFixed(stop.t, 2) + " s by " + stop.source + ": " + stop.reason + "\n";
  for (const auto& error : report.errors) text += "error: " + error + "\n";
  return text + (report.success ? "task achieved\n" : "task not achieved\n");
}

Result<Answer> runRun(const RunOptions& options) {
  const auto scenario = planning::loadScenario(options.scenario);
  if (!scenario) return scenario.error();
  const auto workcell = workcellOf(options, *scenario);
  if (!workcell) return workcell.error();
  session::TaskOptions task;
  task.scenario = options.scenario;
  task.variant = scenario->variant;
  task.seed = options.seed;
  task.click_sigma_px = options.click_sigma_px;
  task.speed = options.speed;
  task.lockstep = options.lockstep;
  task.ideal = options.ideal;
  if (!options.faults.empty()) task.faults = split(options.faults, ',');
  const auto report = session::runTask(*workcell, task);
  if (!report) return report.error();
  return Answer{nlohmann::json::parse(session::toJson(*report)), stagesTable(*report), report->success ? kExitDone : kExitNoSolution};
}

}  // namespace

void addRunVerb(Cli& cli) {
  cli.addVerb<RunOptions>(
      cli.app(), "run", "Do a scenario's whole task on the virtual robot, unattended", "longarm run --scenario grab_pipe --json",
      [](CLI::App& verb, RunOptions& options) {
        verb.add_option("--scenario", options.scenario, "Built-in name or file (longarm list scenarios)")->capture_default_str();
        verb.add_option("--workcell", options.workcell, "Workcell file (default: the scenario's robot)");
        verb.add_option("--faults", options.faults, "Names joined by commas, e.g. link_cut");
        verb.add_option("--seed", options.seed, "Seed of the scenario and of the synthetic clicks")->capture_default_str();
        verb.add_option("--click-sigma", options.click_sigma_px, "Noise of the synthetic clicks [px]")->check(CLI::Range(0.0, 20.0));
        verb.add_option("--speed", options.speed, "Speed of the transport, 0.1 ... 2")->check(CLI::Range(0.1, 2.0));
        verb.add_flag("--lockstep", options.lockstep, "Simulated time, as fast as the machine allows");
        verb.add_flag("--ideal", options.ideal, "A robot without offsets, backlash, latency and noise");
      },
      runRun);
}

}  // namespace longarm::app
