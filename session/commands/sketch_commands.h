#pragma once

/// @file
/// The edits of pictures and sketch as undo steps.  All return a command for EditHistory::push.

#include <memory>
#include <string>
#include <vector>

#include "session/commands/edit_command.h"

namespace longarm::session {

using CommandPtr = std::unique_ptr<EditCommand>;

/// Adds an item at the end of the list and selects it.  @pre item.id is not in the document
CommandPtr addItem(SketchItem item);
CommandPtr removeItems(const Document& document, const std::vector<FeatureId>& ids);
/// Replaces the item of the same id.  @param merge_key Steps in a row with the same key that is not empty become one.
CommandPtr replaceItem(const Document& document, SketchItem after, std::string label, std::string merge_key = {});

/// Null when the item does not exist or nothing would change.
CommandPtr renameItem(const Document& document, FeatureId id, const std::string& name);
CommandPtr hideItem(const Document& document, FeatureId id, bool hidden);
CommandPtr lockItem(const Document& document, FeatureId id, bool locked);
/// A line whose ends are others in every picture, or the same again.  Null for what is no line, or a pipe.
CommandPtr edgeItem(const Document& document, FeatureId id, bool edge);
CommandPtr colourItem(const Document& document, FeatureId id, std::optional<std::uint32_t> colour);
CommandPtr noteItem(const Document& document, FeatureId id, const std::string& note);
/// Makes one group of them (two or more), or takes them out of theirs.
CommandPtr groupItems(const Document& document, const std::vector<FeatureId>& ids, bool together);
/// Copy with its own id and name, in no group.
CommandPtr duplicateItem(const Document& document, FeatureId id);
/// The feature in other pictures: a copy whose handles lie where they should be seen there, dashed and not measured until
/// they are dragged.
/// @returns kNotFound (no such feature or picture), kRefused: it is not measured, a pipe (its outlines differ from every
///   side), marked there already, or a vertex is not in one of the pictures.
Result<CommandPtr> copyItemTo(const Document& document, FeatureId id, const std::vector<SnapshotId>& pictures);
/// Same item elsewhere in the list.
CommandPtr moveItem(const Document& document, FeatureId id, std::size_t index);

/// Adds pictures to the library and shows them: the first left, the second right.  A single picture goes to `side`.
CommandPtr addSnapshots(const Document& document, std::vector<SnapshotPtr> snapshots,
                        PaneSide side = PaneSide::kLeft);
/// Removes a picture with every pick made in it.  Null when it does not exist or is pinned.
CommandPtr removeSnapshot(const Document& document, SnapshotId id);
/// Shows a picture of the library; when the other pane has it the two change places.
CommandPtr showSnapshot(const Document& document, PaneSide side, SnapshotId id);

/// Everything gives way to a sketch that was read; undone, everything is back.  @param name for "Undo Open ..."
CommandPtr openState(const Document& document, DocumentState state, const std::string& name);

/// Several steps as one.
CommandPtr composite(std::string label, std::vector<CommandPtr> commands);

}  // namespace longarm::session
