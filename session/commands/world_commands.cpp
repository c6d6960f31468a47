#include "session/commands/world_commands.h"

#include <algorithm>
#include <utility>

namespace longarm::session {

namespace {

class AddWorldItem final : public EditCommand {
 public:
  explicit AddWorldItem(WorldItem item) : m_item(std::move(item)) {}
  void apply(Document& document) override { document.insertWorldItem(document.world().size(), m_item); }
  void revert(Document& document) override { document.removeWorldItem(m_item.id); }
  std::string label() const override { return "Add '" + m_item.name + "' to the world"; }

 private:
  WorldItem m_item;
};

class RemoveWorldItems final : public EditCommand {
 public:
  RemoveWorldItems(const Document& document, const std::vector<WorldItemId>& ids) {
    for (std::size_t i = 0; i < document.world().size(); ++i) {
      const WorldItem& item = document.world()[i];
      if (std::find(ids.begin(), ids.end(), item.id) != ids.end()) m_items.emplace_back(i, item);
    }
  }
  bool empty() const { return m_items.empty(); }
  void apply(Document& document) override {
    for (auto entry = m_items.rbegin(); entry != m_items.rend(); ++entry) document.removeWorldItem(entry->second.id);
  }
  void revert(Document& document) override {
    for (const auto& [index, item] : m_items) document.insertWorldItem(index, item);
  }
  std::string label() const override {
    if (m_items.size() == 1) return "Remove '" + m_items.front().second.name + "' from the world";
    return "Remove " + std::to_string(m_items.size()) + " bodies from the world";
  }

 private:
  std::vector<std::pair<std::size_t, WorldItem>> m_items;  // Index before the removal, ascending.
};

class ReplaceWorldItem final : public EditCommand {
 public:
  ReplaceWorldItem(WorldItem before, WorldItem after) : m_before(std::move(before)), m_after(std::move(after)) {}
  void apply(Document& document) override { document.replaceWorldItem(m_after); }
  void revert(Document& document) override { document.replaceWorldItem(m_before); }
  std::string label() const override { return "Edit '" + m_before.name + "' of the world"; }

 private:
  WorldItem m_before, m_after;
};

class PinSnapshot final : public EditCommand {
 public:
  PinSnapshot(SnapshotId id, std::string name, bool pinned) : m_id(id), m_name(std::move(name)), m_pinned(pinned) {}
  void apply(Document& document) override { document.setPinned(m_id, m_pinned); }
  void revert(Document& document) override { document.setPinned(m_id, !m_pinned); }
  std::string label() const override { return (m_pinned ? "Pin snapshot " : "Unpin snapshot ") + m_name; }

 private:
  SnapshotId m_id;
  std::string m_name;
  bool m_pinned;
};

}  // namespace

CommandPtr addWorldItem(WorldItem item) { return std::make_unique<AddWorldItem>(std::move(item)); }

CommandPtr removeWorldItems(const Document& document, const std::vector<WorldItemId>& ids) {
  auto command = std::make_unique<RemoveWorldItems>(document, ids);
  if (command->empty()) return nullptr;
  return command;
}

CommandPtr replaceWorldItem(const Document& document, WorldItem after) {
  const WorldItem* before = document.worldItem(after.id);
  if (before == nullptr || *before == after) return nullptr;
  return std::make_unique<ReplaceWorldItem>(*before, std::move(after));
}

CommandPtr pinSnapshot(const Document& document, SnapshotId id, bool pinned) {
  const SnapshotPtr snapshot = document.snapshot(id);
  if (!snapshot || document.pinned(id) == pinned) return nullptr;
  return std::make_unique<PinSnapshot>(id, snapshot->view.name, pinned);
}

}  // namespace longarm::session
