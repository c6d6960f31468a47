#pragma once

/// @file
/// Macros: what can be done with a selected feature.  One file each; the registry lists them.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/macros/reach_answer.h"
#include "planning/motion/plan.h"
#include "vision/sketch/feature.h"

namespace longarm::planning {

/// A number that an operator or script may set; given by name in PlanContext::arguments.
struct MacroParameter {
  std::string name;                               ///< "stand_off": stable, lower case.
  std::string unit;                               ///< "m", "rad", "m/s"; "1": a share or count; "choice": whole numbers.
  double value = 0;                               ///< Default.
  double lower = 0, upper = 0;                    ///< Allowed range, both included.
  std::string description;                        ///< One sentence.
  std::vector<std::string> choices = {};          ///< Of a "choice": what the numbers from `lower` on mean; empty: a count.
};

struct MacroInfo {
  std::string name;                               ///< "grab_pipe": stable, lower case.
  std::string title;                              ///< "Grab Pipe"
  std::string description;                        ///< One sentence for a tooltip.
  std::optional<vision::FeatureKind> takes;       ///< Empty: available when nothing is selected.
  std::vector<MacroParameter> parameters = {};    ///< In the order to show them.
  /// How well the feature must be known, 95 % [m]: up to it "go", up to three times it "ask", beyond "no_go".  Grab
  /// Pipe judges across its fingers, by the gripper and radius at hand.  0: takes no feature.
  double accuracy_need = 0;
  bool uses_up = false;                           ///< Goes by PlanContext::up: "above", "level", "upright".
};

class Macro {
 public:
  virtual ~Macro() = default;
  virtual MacroInfo info() const = 0;
  /// Plans with context.arguments (a wrong one ends it as kLimits); never throws, answers within context.budget_s,
  /// honours context.cancel within 100 ms.
  /// @pre feature is given exactly when info().takes is.
  virtual Plan plan(const PlanContext& context, const vision::Feature* feature) const = 0;
  /// A quick look at whether it can be done, within context.budget_s; kUnknown from macros that cannot tell.
  virtual ReachAnswer reach(const PlanContext& context, const vision::Feature& feature, const ReachSeed& seed) const;
};

/// All macros of a workcell: the canned poses it names, then those for features.
std::vector<std::unique_ptr<Macro>> makeMacros(const Workcell& workcell);
/// Null if there is none of that name.
const Macro* findMacro(const std::vector<std::unique_ptr<Macro>>& macros, const std::string& name);

}  // namespace longarm::planning
