#pragma once

/// @file
/// Checks a URDF element by element before urdfdom reads it, because urdfdom accepts NaN, zero axes and
/// crossed limits, and does not say which element or value it refuses.

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace longarm::planning::internal {

/// What the check learns and urdfdom forgets.
struct UrdfOutline {
  std::vector<std::string> links;          ///< In the order of the file.
  std::vector<std::string> joints;         ///< In the order of the file.
  std::vector<std::string> warnings;
};

/// @param text  URDF that is within XmlBounds; `name` stands for the file in messages.
/// @returns kInvalidInput naming file, line, element, value and what was expected: not XML, no <robot>, links or
///   joints without or with equal names, unknown parents or children, numbers that are none or not finite,
///   sizes that are not positive, zero axis, lower > upper, missing limits, two parents, loops, several roots,
///   mimic of an unknown joint or in a circle.  Pure function.
Result<UrdfOutline> checkUrdf(std::string_view text, const std::string& name);

}  // namespace longarm::planning::internal
