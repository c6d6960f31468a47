#pragma once

/// @file
/// TaskRunner: does a scenario's whole task with no operator, as a test and a demonstration.

#include <string>
#include <vector>

#include "core/cancel.h"
#include "core/result.h"
#include "planning/world/workcell.h"

namespace longarm::session {

struct TaskOptions {
  std::string scenario = "grab_pipe";              ///< Name or file.
  std::string variant;
  unsigned seed = 1;
  double click_sigma_px = 0.5;                     ///< Noise of the synthetic clicks, 1 sigma [px].
  bool lockstep = false;                           ///< Simulated time: as fast as the machine allows.
  bool ideal = false;
  std::vector<std::string> faults;                 ///< Built-in names; each strikes once, in mid-motion.
  double speed = 1;                                ///< Of the transport.
  std::string virtual_robot;                       ///< As RuntimeOptions::virtual_robot.
  CancelToken cancel;
};

struct TaskStage {
  std::string name;                                ///< "connect", "aim", "snapshot", "measure", "plan", "open", "play", "close", "lift", "verify"
  bool ok = false;
  double seconds = 0;                              ///< On the robot's clock.
  std::string detail;
};

struct TaskStop {
  double t = 0;                                    ///< Since the start [s].
  std::string source, reason;
};

struct TaskReport {
  bool success = false;
  std::vector<TaskStage> stages;                   ///< In order; ends with the first that failed.
  std::vector<std::string> errors;
  std::vector<TaskStop> stops;
};

/// Runs the task; ends by itself, after losing the link for good within 10 s.
/// @returns kNotFound / kInvalidInput when the scenario or the virtual robot cannot be had; a task that
///   merely fails is a report with success = false.
/// @par Thread safety: may be called from any thread, one task at a time per process.
Result<TaskReport> runTask(const planning::Workcell& workcell, const TaskOptions& options);

/// The object {"success", "stages", "errors", "stops"} that the verb `run` prints.
std::string toJson(const TaskReport& report);

}  // namespace longarm::session
