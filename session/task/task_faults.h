#pragma once

/// @file
/// TaskFaults: what goes wrong in the middle of a task's motion.

#include <memory>
#include <string>
#include <vector>

#include "core/result.h"
#include "hardware/fault_proxy/fault_proxy.h"
#include "session/robot/robot_runtime.h"

namespace longarm::session {

/// Faults by the names of docs/cli.md, each struck once and for good.  Those of the link are made by a proxy in the way
/// of the connection, in simulated time by the robot; all others by the robot.
class TaskFaults {
 public:
  /// @returns kInvalidInput listing the names.
  static Result<TaskFaults> make(std::vector<std::string> names, bool lockstep);

  /// For RuntimeOptions::through; empty when no proxy is needed.
  std::function<std::string(const std::string& url)> through();
  /// Strikes those whose share of the motion has passed; they are spread evenly over it.
  /// @param done  0 ... 1 of the motion.
  /// @returns what the robot says when it refuses.
  Status strikeAt(double done, RobotRuntime& runtime);
  bool allStruck() const { return m_next == m_names.size(); }

 private:
  TaskFaults(std::vector<std::string> names, bool lockstep) : m_names(std::move(names)), m_lockstep(lockstep) {}
  Status strike(const std::string& name, RobotRuntime& runtime);

  std::vector<std::string> m_names;
  bool m_lockstep;
  std::size_t m_next = 0;
  std::shared_ptr<std::unique_ptr<hardware::FaultProxy>> m_proxy =
      std::make_shared<std::unique_ptr<hardware::FaultProxy>>();
};

}  // namespace longarm::session
