#pragma once

/// @file
/// Undo and redo: Qt 5 keeps its own in QtWidgets, which the model must not need.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "session/commands/edit_command.h"

namespace longarm::session {

/// The one way to change a Document's state.  GUI thread only.
class EditHistory {
 public:
  /// @param limit Steps kept, at least 100; the oldest is forgotten first.
  explicit EditHistory(Document& document, std::size_t limit = 500);
  EditHistory(const EditHistory&) = delete;
  EditHistory& operator=(const EditHistory&) = delete;

  /// Applies and records; what was undone is forgotten.  The step before may absorb it unless sealed.
  void push(std::unique_ptr<EditCommand> command);
  void undo();                             ///< Nothing when there is no step.
  void redo();
  void clear();                            ///< Forgets all; the document stays, and counts as clean.
  /// Ends the current step: the next push is not absorbed.
  void seal() { m_sealed = true; }

  bool canUndo() const { return m_position > 0; }
  bool canRedo() const { return m_position < m_steps.size(); }
  std::string undoLabel() const;           ///< Empty when there is none.
  std::string redoLabel() const;
  std::size_t size() const { return m_steps.size(); }
  std::size_t position() const { return m_position; }
  std::size_t limit() const { return m_limit; }

  /// The clean mark: the state that was saved last.
  void markClean();
  bool isClean() const { return m_has_clean && m_clean == m_position; }

  /// Called after each change of the history (GUI actions, clean mark).
  void onChanged(std::function<void()> callback) { m_changed = std::move(callback); }

 private:
  void forgetRedo();
  void forgetOldest();
  void notify();

  Document& m_document;
  std::size_t m_limit;
  std::vector<std::unique_ptr<EditCommand>> m_steps;
  std::size_t m_position = 0;
  std::size_t m_clean = 0;
  bool m_has_clean = true, m_sealed = false;
  std::function<void()> m_changed;
};

}  // namespace longarm::session
