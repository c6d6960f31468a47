#include "session/task_runner.h"

#include <exception>

#include <nlohmann/json.hpp>

#include "session/task/task_run.h"

namespace longarm::session {

Result<TaskReport> runTask(const planning::Workcell& workcell, const TaskOptions& options) {
  try {
    auto scenario = planning::loadScenario(options.scenario);
    if (!scenario) return scenario.error();
    if (!workcell.model || !workcell.gripper) {
      return Error{ErrorCode::kInvalidInput, "workcell " + workcell.path + ": a task needs a robot with a gripper"};
    }
    auto faults = TaskFaults::make(options.faults, options.lockstep);
    if (!faults) return faults.error();
    TaskRun run(workcell, planning::randomised(*scenario, options.seed), options, std::move(*faults));
    if (auto status = run.start(); !status) return status.error();
    return run.run();
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInternal, std::string("the task failed inside: ") + e.what()};
  }
}

std::string toJson(const TaskReport& report) {
  nlohmann::ordered_json out = {{"success", report.success},
                                {"stages", nlohmann::ordered_json::array()},
                                {"errors", report.errors},
                                {"stops", nlohmann::ordered_json::array()}};
  for (const auto& s : report.stages) {
    out["stages"].push_back({{"name", s.name}, {"ok", s.ok}, {"seconds", s.seconds}, {"detail", s.detail}});
  }
  for (const auto& s : report.stops) out["stops"].push_back({{"t", s.t}, {"source", s.source}, {"reason", s.reason}});
  return out.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace longarm::session
