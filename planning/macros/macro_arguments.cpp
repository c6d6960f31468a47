#include "planning/macros/macro_arguments.h"

#include <algorithm>
#include <cmath>

#include "core/require.h"
#include "core/text.h"

namespace longarm::planning {

Result<MacroArguments> MacroArguments::from(const MacroInfo& info, const std::map<std::string, double>& given) {
  MacroArguments out;
  for (const auto& parameter : info.parameters) out.m_values[parameter.name] = parameter.value;
  for (const auto& [name, value] : given) {
    const auto it = std::find_if(info.parameters.begin(), info.parameters.end(),
                                 [&](const MacroParameter& p) { return p.name == name; });
    if (it == info.parameters.end()) {
      std::string known;
      for (const auto& p : info.parameters) known += (known.empty() ? "" : ", ") + p.name;
      return Error{ErrorCode::kNotFound, info.name + " has no parameter \"" + name + "\"; it has " +
                                             (known.empty() ? "none" : known)};
    }
    const bool whole = it->unit != "choice" || value == std::round(value);
    if (!(value >= it->lower && value <= it->upper) || !whole) {
      return Error{ErrorCode::kOutOfLimits, info.name + ": " + name + " = " + formatNumber(value) + " is not " +
                                                (it->unit == "choice" ? "a whole number " : "") + "within " +
                                                formatNumber(it->lower) + " ... " + formatNumber(it->upper) +
                                                (it->unit == "1" || it->unit == "choice" ? "" : " " + it->unit)};
    }
    out.m_values[name] = value;
  }
  return out;
}

double MacroArguments::operator[](const std::string& name) const {
  const auto it = m_values.find(name);
  LONGARM_REQUIRE(it != m_values.end(), "macro has no parameter \"" + name + "\"");
  return it->second;
}

int MacroArguments::choice(const std::string& name) const { return static_cast<int>(std::lround((*this)[name])); }

MacroParameter standOffParameter(double value) {
  return {"stand_off", "m", value, 0.02, 0.5, "How far away the straight approach begins."};
}

MacroParameter approachSpeedParameter(double value) {
  return {"approach_speed", "m/s", value, 0.002, 0.25, "Speed of the tool on the straight approach."};
}

MacroParameter travelSpeedParameter(double value) {
  return {"speed", "m/s", value, 0.002, 0.5, "Speed of the tool along its path."};
}

}  // namespace longarm::planning
