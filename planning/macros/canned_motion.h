#pragma once

/// @file
/// Canned motions: to a pose that the workcell names, available when nothing is selected.

#include <map>
#include <string>

#include "planning/macros/macro.h"

namespace longarm::planning {

/// Moves the arm to a named pose; joints of the pose that are not the arm's are named in a note.
class CannedMotion final : public Macro {
 public:
  /// @param joints  Joint name -> value; arm joints left out stay where they are.
  CannedMotion(std::string name, std::map<std::string, double> joints);
  MacroInfo info() const override;
  Plan plan(const PlanContext& context, const vision::Feature* feature) const override;

 private:
  std::string m_name;
  std::map<std::string, double> m_joints;
};

}  // namespace longarm::planning
