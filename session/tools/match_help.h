#pragma once

/// @file
/// Suggested matches as the operator sees them, and what taking one does.

#include <string>
#include <vector>

#include "session/tools/sketch_tool.h"

namespace longarm::session {

/// Ghosts of what was found for a picture: the offered match with its confidence, or all rivals where none stands out.
void addMatchHelp(const std::vector<MatchHelp>& help, SnapshotId shown, vision::Overlay* overlay);
/// What to do about it, for the status line; empty when nothing was found out yet.
std::string matchHint(const std::vector<MatchHelp>& help);

/// The item with the best match as a pick of its own uncertainty.  @pre help.matches is not empty
SketchItem withMatch(const SketchItem& item, const MatchHelp& help);

}  // namespace longarm::session
