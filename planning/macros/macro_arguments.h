#pragma once

/// @file
/// The values a macro runs with: what was given, checked against its parameters, and their defaults.

#include <map>
#include <string>

#include "core/result.h"
#include "planning/macros/macro.h"

namespace longarm::planning {

/// Immutable value; thread-safe.
class MacroArguments {
 public:
  /// @param given  Parameter name -> value in the parameter's unit.
  /// @returns kNotFound: no such parameter (the message lists those there are); kOutOfLimits: not finite, outside the
  ///   range, or no whole number where one of a list is chosen.
  static Result<MacroArguments> from(const MacroInfo& info, const std::map<std::string, double>& given);

  /// Value of a parameter.  @pre The macro has one of that name.
  double operator[](const std::string& name) const;
  /// The same as a yes or no, or as the number of a choice.
  bool is(const std::string& name) const { return (*this)[name] > 0.5; }
  int choice(const std::string& name) const;

 private:
  std::map<std::string, double> m_values;
};

/// Parameters that many macros share.
MacroParameter standOffParameter(double value);
MacroParameter approachSpeedParameter(double value = 0.05);
MacroParameter travelSpeedParameter(double value);

}  // namespace longarm::planning
