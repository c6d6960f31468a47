#pragma once

/// @file
/// Where the program's own files are: robots, scenarios, styles.

#include <string>

#include "core/result.h"

namespace longarm {

/// Absolute path of a file or folder under resources/, e.g. "robots/longarm_one/workcell.yaml".  Looked for in
/// $LONGARM_RESOURCES, in the source tree the program was built from, and in <prefix>/share/longarm beside the
/// executable.  @returns kNotFound naming the places tried.  Thread-safe.
Result<std::string> resourcePath(const std::string& relative);

/// Folder of the running executable, for programs that stand beside it.
std::string executableFolder();

}  // namespace longarm
