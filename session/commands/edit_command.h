#pragma once

/// @file
/// One step of undo: before and after values, and the label for the menu.

#include <string>

#include "session/document/document.h"

namespace longarm::session {

/// Changes the document's state.  revert() after apply() restores it bit for bit; apply() may follow again.
class EditCommand {
 public:
  virtual ~EditCommand() = default;
  virtual void apply(Document& document) = 0;
  virtual void revert(Document& document) = 0;
  /// "Move line 'Line 1'", for "Undo ..." in the menu.
  virtual std::string label() const = 0;
  /// Takes over `next`, which was applied right after this: the two become one step (key nudges).
  virtual bool absorb(const EditCommand& /*next*/) { return false; }
};

}  // namespace longarm::session
