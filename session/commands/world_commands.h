#pragma once

/// @file
/// The edits of the sketched world and of the picture library's pins as undo steps.

#include <string>
#include <vector>

#include "session/commands/sketch_commands.h"

namespace longarm::session {

/// @pre item.id is not in the document
CommandPtr addWorldItem(WorldItem item);
/// Null when none of them exists.
CommandPtr removeWorldItems(const Document& document, const std::vector<WorldItemId>& ids);
/// Null when it does not exist or nothing would change.
CommandPtr replaceWorldItem(const Document& document, WorldItem after);
/// Null when the picture does not exist or is so already.
CommandPtr pinSnapshot(const Document& document, SnapshotId id, bool pinned);

}  // namespace longarm::session
