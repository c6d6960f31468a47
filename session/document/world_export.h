#pragma once

/// @file
/// The sketched world as a file: OBJ, binary glTF, or JSON.

#include <string>
#include <vector>

#include "core/result.h"
#include "session/document/world_item.h"

namespace longarm::session {

/// Triangles of the bodies, without margins, in the frame of the items (metres, z up; glTF: turned to y up, as it
/// demands).  Each body is a group, a node of its own.  Pure functions.
std::string worldAsObj(const std::vector<WorldItem>& items);
std::string worldAsGlb(const std::vector<WorldItem>& items);
/// {"frame", "objects": [{"name", "kind", "pose", "size", "points", "margin_m", "role"}]}
std::string worldAsJson(const std::vector<WorldItem>& items);

/// The kind is told by the ending: .obj, .glb or .json.
/// @returns kInvalidInput: another ending, nothing to write, items of several frames, or a file that cannot be written.
Status exportWorld(const std::string& path, const std::vector<WorldItem>& items);

}  // namespace longarm::session
