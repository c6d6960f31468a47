#pragma once

/// @file
/// What a template adds to the JSON of a body.

#include <nlohmann/json_fwd.hpp>

#include "session/document/world_item.h"

namespace longarm::session {

/// {"template", "parameters", "parts": [{"name", "moves", "xyz", "quaternion_xyzw", and "box", "cylinder" or "sphere"}]}
nlohmann::json templateJson(const WorldItem& item);

/// Reads the same into the item.  @returns kInvalidInput naming the key.  Never throws.
Status readTemplate(const nlohmann::json& value, WorldItem& item);

}  // namespace longarm::session
