#pragma once

/// @file
/// Internal to the codec: bounded readers of JSON text and CBOR into one value.

#include <string_view>

#include <nlohmann/json.hpp>

#include "core/result.h"

namespace longarm::rosbridge::internal {

/// @returns kInvalidInput naming the byte where it went wrong or the bound that was passed.  Never throws.
Result<nlohmann::json> readJson(std::string_view text);
/// As readJson.  Typed number arrays of RFC 8746 (tags 80 ... 86) stay binary with the tag as their subtype.
Result<nlohmann::json> readCbor(std::string_view bytes);

}  // namespace longarm::rosbridge::internal
