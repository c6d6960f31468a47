#pragma once

/// @file
/// FaultBoard: which faults are in force.

#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "planning/world/scenario.h"

namespace longarm::virtual_robot {

/// Names that start() takes, in the order of docs/cli.md.
const std::vector<std::string>& faultNames();

/// Faults by name with their ends, on the robot's clock.  Those of a scenario wait for their time or, without one, for
/// the arm to have been moving for a second.  Thread-compatible.
class FaultBoard {
 public:
  explicit FaultBoard(std::vector<planning::ScenarioFault> planned = {});

  /// @param duration_s  0: until cleared.  @returns kNotFound listing the names.  "clear" ends all, planned ones too.
  Status start(const std::string& name, double now_s, double duration_s, const std::string& target);
  /// Lets planned faults strike and old ones end.
  void tick(double now_s, bool arm_moves, double seconds);

  /// Whether a fault is in force; with its target, or empty for the fault's usual one.
  bool active(const std::string& name) const;
  std::optional<std::string> target(const std::string& name) const;
  /// Whether it is in force and strikes `candidate`; `usual` is struck when it was started without a target.
  bool strikes(const std::string& name, const std::string& candidate, const std::string& usual) const;
  /// Names in force.
  std::vector<std::string> names() const;

 private:
  struct Active {
    std::string name, target;
    double until_s = 0;
  };
  const Active* find(const std::string& name) const;

  std::vector<planning::ScenarioFault> m_planned;
  std::vector<Active> m_active;
  double m_moved_s = 0;
};

}  // namespace longarm::virtual_robot
