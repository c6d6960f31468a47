#pragma once

/// @file
/// Defaults of a macro that depend on where the robot stands.

#include <map>
#include <string>

#include <Eigen/Core>

#include "planning/world/workcell.h"

namespace longarm::planning {

/// Mixed into a Macro some of whose parameters default to what is now.  Pure functions; thread-safe.
class StandingDefaults {
 public:
  virtual ~StandingDefaults() = default;
  /// Parameter name -> value, in the parameter's unit and within its range, at the full configuration q.  Planning takes the same
  /// for what PlanContext::arguments leaves out.  Empty where q is not one of the workcell's.
  virtual std::map<std::string, double> defaultsAt(const Workcell& workcell, const Eigen::VectorXd& q) const = 0;
};

}  // namespace longarm::planning
