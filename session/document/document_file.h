#pragma once

/// @file
/// A sketch on disk: a folder with sketch.json and one PNG per picture.

#include <string>

#include "core/result.h"
#include "session/document/document.h"

namespace longarm::session {

/// Name of the index inside a sketch folder.
inline constexpr const char* kSketchFileName = "sketch.json";

/// Writes `folder` (created when missing): pictures that are not there yet, then sketch.json atomically.  Pictures
/// never change, so that a file of an earlier save is kept; those that no sketch needs any more are removed last.
/// @returns kInvalidInput with path and reason.  Thread-safe: takes a value.
Status saveSketch(const std::string& folder, const DocumentState& state);

/// Reads what saveSketch wrote.  `path` is the folder or its sketch.json.
/// @returns kNotFound, or kInvalidInput naming file, key and value; bounded in size, counts and pixels.
Result<DocumentState> loadSketch(const std::string& path);

}  // namespace longarm::session
