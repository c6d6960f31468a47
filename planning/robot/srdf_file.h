#pragma once

/// @file
/// SRDF: groups, named states and the pairs of links whose contact is allowed.

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

namespace longarm::planning::internal {

struct SrdfGroup {
  std::string name;
  std::string base_link, tip_link;            ///< Of its <chain>; empty if it has none.
  std::vector<std::string> joints, links;     ///< Of its <joint> and <link> elements.
};

/// The file's content by name; nothing is looked up in the robot yet.
struct SrdfContent {
  std::string robot;
  std::vector<SrdfGroup> groups;
  std::map<std::string, std::map<std::string, double>> states;   ///< State -> joint -> value.
  std::vector<std::pair<std::string, std::string>> allowed_pairs;
};

/// @returns kInvalidInput naming file, line, element and value: not XML, no <robot>, missing names, values that
///   are no finite numbers.  The text must be within XmlBounds.  Pure function.
Result<SrdfContent> parseSrdf(std::string_view text, const std::string& name);

}  // namespace longarm::planning::internal
