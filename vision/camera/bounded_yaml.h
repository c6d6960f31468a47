#pragma once

/// @file
/// YAML text as JSON values, bounded in size, depth and count, and independent of the locale.

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/result.h"

namespace longarm::vision {

struct YamlLimits {
  std::size_t max_depth = 32;
  std::size_t max_values = 200000;   ///< Counted after aliases are expanded.
};

/// One YAML document as JSON.  Plain scalars become null, booleans ("true", "false"), integers and finite
/// numbers; everything else, and all that is quoted, is text.  Tags are ignored, so that OpenCV's
/// `!!opencv-matrix` reads as a map, and so is its first line `%YAML:1.0`.
/// @returns kInvalidInput naming the line: broken syntax, a key given twice, keys that are no scalars, more
///   than one document, or a limit exceeded.  Never throws.  Pure function.
Result<nlohmann::json> jsonFromYaml(std::string_view text, const YamlLimits& limits = {});

}  // namespace longarm::vision
