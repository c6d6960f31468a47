#include "session/commands/edit_history.h"

#include <algorithm>

#include "core/require.h"

namespace longarm::session {

EditHistory::EditHistory(Document& document, std::size_t limit)
    : m_document(document), m_limit(std::max<std::size_t>(limit, 100)) {}

void EditHistory::push(std::unique_ptr<EditCommand> command) {
  LONGARM_REQUIRE(command != nullptr, "null command");
  forgetRedo();
  command->apply(m_document);
  // The clean state itself must stay reachable by undo, so that nothing is absorbed into its step.
  const bool may_absorb = !m_sealed && m_position > 0 && !isClean();
  m_sealed = false;
  if (!may_absorb || !m_steps[m_position - 1]->absorb(*command)) {
    m_steps.push_back(std::move(command));
    ++m_position;
    forgetOldest();
  }
  notify();
}

void EditHistory::undo() {
  if (!canUndo()) return;
  m_steps[--m_position]->revert(m_document);
  m_sealed = true;
  notify();
}

void EditHistory::redo() {
  if (!canRedo()) return;
  m_steps[m_position++]->apply(m_document);
  m_sealed = true;
  notify();
}

void EditHistory::clear() {
  m_steps.clear();
  m_position = 0;
  m_clean = 0;
  m_has_clean = true;
  m_sealed = false;
  notify();
}

std::string EditHistory::undoLabel() const { return canUndo() ? m_steps[m_position - 1]->label() : std::string(); }

std::string EditHistory::redoLabel() const { return canRedo() ? m_steps[m_position]->label() : std::string(); }

void EditHistory::markClean() {
  m_clean = m_position;
  m_has_clean = true;
  notify();
}

void EditHistory::forgetRedo() {
  m_steps.resize(m_position);
  if (m_clean > m_position) m_has_clean = false;
}

void EditHistory::forgetOldest() {
  if (m_steps.size() <= m_limit) return;
  m_steps.erase(m_steps.begin());
  --m_position;
  if (m_clean == 0) m_has_clean = false;
  else --m_clean;
}

void EditHistory::notify() {
  if (m_changed) m_changed();
}

}  // namespace longarm::session
