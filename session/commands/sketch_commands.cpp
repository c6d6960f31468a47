#include "session/commands/sketch_commands.h"

#include <algorithm>
#include <utility>

#include "core/require.h"

namespace longarm::session {

namespace {

std::string described(const SketchItem& item) {
  return std::string(wordFor(item)) + " '" + item.name + "'";
}

/// An item that enters the list; undone, it leaves.
class AddItem final : public EditCommand {
 public:
  AddItem(SketchItem item, std::size_t index, std::string label)
      : m_item(std::move(item)), m_index(index), m_label(std::move(label)) {}
  void apply(Document& document) override {
    m_selection_before = document.selection();
    document.insertItem(m_index, m_item);
    document.select(Selection::of(m_item.id));
  }
  void revert(Document& document) override {
    document.removeItem(m_item.id);
    document.select(m_selection_before);
  }
  std::string label() const override { return m_label; }

 private:
  SketchItem m_item;
  std::size_t m_index;
  std::string m_label;
  Selection m_selection_before;
};

class RemoveItems final : public EditCommand {
 public:
  RemoveItems(const Document& document, const std::vector<FeatureId>& ids) {
    for (std::size_t i = 0; i < document.items().size(); ++i) {
      const SketchItem& item = document.items()[i];
      if (std::find(ids.begin(), ids.end(), item.id) != ids.end()) m_items.emplace_back(i, item);
    }
  }
  bool empty() const { return m_items.empty(); }
  void apply(Document& document) override {
    m_selection_before = document.selection();
    for (auto entry = m_items.rbegin(); entry != m_items.rend(); ++entry) document.removeItem(entry->second.id);
  }
  void revert(Document& document) override {
    for (const auto& [index, item] : m_items) document.insertItem(index, item);
    document.select(m_selection_before);
  }
  std::string label() const override {
    if (m_items.size() == 1) return "Delete " + described(m_items.front().second);
    return "Delete " + std::to_string(m_items.size()) + " features";
  }

 private:
  std::vector<std::pair<std::size_t, SketchItem>> m_items;  // Index before the removal, ascending.
  Selection m_selection_before;
};

class ReplaceItem final : public EditCommand {
 public:
  ReplaceItem(SketchItem before, SketchItem after, std::string label, std::string merge_key)
      : m_before(std::move(before)), m_after(std::move(after)), m_label(std::move(label)),
        m_merge_key(std::move(merge_key)) {}
  void apply(Document& document) override { document.replaceItem(m_after); }
  void revert(Document& document) override { document.replaceItem(m_before); }
  std::string label() const override { return m_label; }
  bool absorb(const EditCommand& next) override {
    const auto* other = dynamic_cast<const ReplaceItem*>(&next);
    if (other == nullptr || m_merge_key.empty() || other->m_merge_key != m_merge_key ||
        other->m_after.id != m_after.id) {
      return false;
    }
    m_after = other->m_after;
    return true;
  }

 private:
  SketchItem m_before, m_after;
  std::string m_label, m_merge_key;
};

class MoveItem final : public EditCommand {
 public:
  MoveItem(SketchItem item, std::size_t from, std::size_t to)
      : m_item(std::move(item)), m_from(from), m_to(to) {}
  void apply(Document& document) override { move(document, m_to); }
  void revert(Document& document) override { move(document, m_from); }
  std::string label() const override { return "Move " + described(m_item) + " in the list"; }

 private:
  void move(Document& document, std::size_t index) {
    const Selection selection = document.selection();
    document.removeItem(m_item.id);
    document.insertItem(index, m_item);
    document.select(selection);
  }
  SketchItem m_item;
  std::size_t m_from, m_to;
};

using Panes = std::array<SnapshotId, 2>;

void setPanes(Document& document, const Panes& panes) {
  document.setPane(PaneSide::kLeft, panes[0]);
  document.setPane(PaneSide::kRight, panes[1]);
}

class AddSnapshots final : public EditCommand {
 public:
  AddSnapshots(const Document& document, std::vector<SnapshotPtr> snapshots, PaneSide side)
      : m_snapshots(std::move(snapshots)), m_before(document.state().panes), m_after(m_before) {
    if (m_snapshots.size() == 1) {
      m_after[static_cast<std::size_t>(side)] = m_snapshots[0]->id;
    } else {
      for (std::size_t i = 0; i < std::min<std::size_t>(2, m_snapshots.size()); ++i) m_after[i] = m_snapshots[i]->id;
    }
  }
  void apply(Document& document) override {
    for (const auto& snapshot : m_snapshots) document.insertSnapshot(document.snapshots().size(), snapshot);
    setPanes(document, m_after);
  }
  void revert(Document& document) override {
    for (auto it = m_snapshots.rbegin(); it != m_snapshots.rend(); ++it) document.removeSnapshot((*it)->id);
    setPanes(document, m_before);
  }
  std::string label() const override {
    return m_snapshots.size() == 1 ? "Take snapshot" : "Take " + std::to_string(m_snapshots.size()) + " snapshots";
  }

 private:
  std::vector<SnapshotPtr> m_snapshots;
  Panes m_before, m_after;
};

class RemoveSnapshot final : public EditCommand {
 public:
  RemoveSnapshot(const Document& document, SnapshotId id) : m_panes(document.state().panes) {
    for (std::size_t i = 0; i < document.snapshots().size(); ++i) {
      if (document.snapshots()[i]->id != id) continue;
      m_index = i;
      m_snapshot = document.snapshots()[i];
    }
    for (const auto& item : document.items()) {
      if (item.picks.count(id) != 0) m_items.push_back(item);
    }
  }
  bool empty() const { return !m_snapshot; }
  void apply(Document& document) override {
    for (SketchItem item : m_items) {
      item.picks.erase(m_snapshot->id);
      document.replaceItem(item);
    }
    document.removeSnapshot(m_snapshot->id);
  }
  void revert(Document& document) override {
    document.insertSnapshot(m_index, m_snapshot);
    for (const auto& item : m_items) document.replaceItem(item);
    setPanes(document, m_panes);
  }
  std::string label() const override { return "Remove snapshot " + m_snapshot->view.name; }

 private:
  SnapshotPtr m_snapshot;
  std::size_t m_index = 0;
  Panes m_panes;
  std::vector<SketchItem> m_items;  // With their picks in it.
};

class ShowSnapshot final : public EditCommand {
 public:
  ShowSnapshot(const Panes& before, const Panes& after, std::string name)
      : m_before(before), m_after(after), m_name(std::move(name)) {}
  void apply(Document& document) override { setPanes(document, m_after); }
  void revert(Document& document) override { setPanes(document, m_before); }
  std::string label() const override { return "Show snapshot " + m_name; }

 private:
  Panes m_before, m_after;
  std::string m_name;
};

class OpenState final : public EditCommand {
 public:
  OpenState(const Document& document, DocumentState after, std::string label)
      : m_before(document.state()), m_after(std::move(after)), m_label(std::move(label)) {}
  void apply(Document& document) override {
    m_selection_before = document.selection();
    document.reset(m_after);
  }
  void revert(Document& document) override {
    document.reset(m_before);
    document.select(m_selection_before);
  }
  std::string label() const override { return m_label; }

 private:
  DocumentState m_before, m_after;
  std::string m_label;
  Selection m_selection_before;
};

class Composite final : public EditCommand {
 public:
  Composite(std::string label, std::vector<CommandPtr> commands)
      : m_label(std::move(label)), m_commands(std::move(commands)) {}
  void apply(Document& document) override {
    for (auto& command : m_commands) command->apply(document);
  }
  void revert(Document& document) override {
    for (auto command = m_commands.rbegin(); command != m_commands.rend(); ++command) (*command)->revert(document);
  }
  std::string label() const override { return m_label; }

 private:
  std::string m_label;
  std::vector<CommandPtr> m_commands;
};

/// Applies `change` to a copy of the item; null when nothing is different.
template <typename Change>
CommandPtr edited(const Document& document, FeatureId id, const std::string& verb, Change change) {
  const SketchItem* item = document.item(id);
  if (item == nullptr) return nullptr;
  SketchItem after = *item;
  change(after);
  if (after == *item) return nullptr;
  return std::make_unique<ReplaceItem>(*item, std::move(after), verb + " " + described(*item), std::string());
}

}  // namespace

CommandPtr addItem(SketchItem item) {
  std::string label = "Add " + described(item);
  return std::make_unique<AddItem>(std::move(item), static_cast<std::size_t>(-1), std::move(label));
}

CommandPtr removeItems(const Document& document, const std::vector<FeatureId>& ids) {
  auto command = std::make_unique<RemoveItems>(document, ids);
  if (command->empty()) return nullptr;
  return command;
}

CommandPtr replaceItem(const Document& document, SketchItem after, std::string label, std::string merge_key) {
  const SketchItem* before = document.item(after.id);
  LONGARM_REQUIRE(before != nullptr, "no item " + std::to_string(after.id.value));
  return std::make_unique<ReplaceItem>(*before, std::move(after), std::move(label), std::move(merge_key));
}

CommandPtr renameItem(const Document& document, FeatureId id, const std::string& name) {
  if (name.empty()) return nullptr;
  return edited(document, id, "Rename", [&](SketchItem& item) { item.name = name; });
}

CommandPtr hideItem(const Document& document, FeatureId id, bool hidden) {
  return edited(document, id, hidden ? "Hide" : "Show", [&](SketchItem& item) { item.hidden = hidden; });
}

CommandPtr lockItem(const Document& document, FeatureId id, bool locked) {
  return edited(document, id, locked ? "Lock" : "Unlock", [&](SketchItem& item) { item.locked = locked; });
}

CommandPtr edgeItem(const Document& document, FeatureId id, bool edge) {
  const SketchItem* item = document.item(id);
  if (item == nullptr || item->kind != vision::FeatureKind::kLine || item->pipe) return nullptr;
  return edited(document, id, edge ? "Ends differ" : "Ends correspond", [&](SketchItem& changed) { changed.edge = edge; });
}

CommandPtr colourItem(const Document& document, FeatureId id, std::optional<std::uint32_t> colour) {
  return edited(document, id, "Colour", [&](SketchItem& item) { item.colour = colour; });
}

CommandPtr noteItem(const Document& document, FeatureId id, const std::string& note) {
  return edited(document, id, "Note on", [&](SketchItem& item) { item.note = note; });
}

CommandPtr groupItems(const Document& document, const std::vector<FeatureId>& ids, bool together) {
  if (together && ids.size() < 2) return nullptr;
  const std::uint64_t group = together ? document.nextGroup() : 0;
  std::vector<CommandPtr> commands;
  for (const FeatureId id : ids) {
    commands.push_back(edited(document, id, "Group", [&](SketchItem& item) { item.group = group; }));
  }
  return composite(together ? "Group " + std::to_string(ids.size()) + " features" : "Ungroup", std::move(commands));
}

CommandPtr duplicateItem(const Document& document, FeatureId id) {
  const SketchItem* item = document.item(id);
  if (item == nullptr) return nullptr;
  SketchItem copy = *item;
  copy.id = document.nextFeatureId();
  copy.name = document.freeName(item->kind, item->pipe);
  copy.locked = false;
  copy.group = 0;
  return std::make_unique<AddItem>(std::move(copy), static_cast<std::size_t>(document.indexOf(id)) + 1,
                                   "Duplicate " + described(*item));
}

Result<CommandPtr> copyItemTo(const Document& document, FeatureId id, const std::vector<SnapshotId>& pictures) {
  const SketchItem* item = document.item(id);
  if (item == nullptr) return Error{ErrorCode::kNotFound, "That feature is gone."};
  const auto& measured = document.measurement(id).feature;
  if (!measured) return Error{ErrorCode::kRefused, described(*item) + " is not measured: nobody knows where it would be seen. Finish it first."};
  if (item->pipe) return Error{ErrorCode::kRefused, described(*item) + " is a pipe: its outlines are others from there. Mark them anew."};
  SketchItem copy = *item;
  copy.id = document.nextFeatureId();
  copy.name = document.freeName(item->kind, item->pipe);
  copy.locked = false;
  copy.group = 0;
  copy.edge = false;                       // its ends are those of the first picture now
  copy.picks.clear();
  for (const SnapshotId picture : pictures) {
    const auto snapshot = document.snapshot(picture);
    if (!snapshot) return Error{ErrorCode::kNotFound, "There is no picture to copy it to. Take or show one first."};
    if (item->pick(picture, 0) != nullptr) return Error{ErrorCode::kRefused, described(*item) + " is marked in these pictures already. Show other ones first."};
    for (std::size_t vertex = 0; vertex < measured->vertices.size(); ++vertex) {
      const auto pixel = snapshot->view.project(measured->vertices[vertex].xyz);
      if (!pixel || !snapshot->view.camera.containsPixel(*pixel)) {
        return Error{ErrorCode::kRefused, "Vertex " + std::to_string(vertex + 1) + " of " + described(*item) + " is not in the picture of " + snapshot->view.name + ". Turn the camera there first."};
      }
      copy.setPick(picture, static_cast<int>(vertex), {*pixel, PickState::kUnplaced});
    }
  }
  return CommandPtr(std::make_unique<AddItem>(std::move(copy), static_cast<std::size_t>(document.indexOf(id)) + 1, "Copy " + described(*item)));
}

CommandPtr moveItem(const Document& document, FeatureId id, std::size_t index) {
  const int from = document.indexOf(id);
  if (from < 0) return nullptr;
  index = std::min(index, document.items().size() - 1);
  if (index == static_cast<std::size_t>(from)) return nullptr;
  return std::make_unique<MoveItem>(*document.item(id), static_cast<std::size_t>(from), index);
}

CommandPtr addSnapshots(const Document& document, std::vector<SnapshotPtr> snapshots, PaneSide side) {
  if (snapshots.empty()) return nullptr;
  return std::make_unique<AddSnapshots>(document, std::move(snapshots), side);
}

CommandPtr removeSnapshot(const Document& document, SnapshotId id) {
  auto command = std::make_unique<RemoveSnapshot>(document, id);
  if (command->empty() || document.pinned(id)) return nullptr;
  return command;
}

CommandPtr showSnapshot(const Document& document, PaneSide side, SnapshotId id) {
  const SnapshotPtr snapshot = document.snapshot(id);
  const Panes before = document.state().panes;
  const auto here = static_cast<std::size_t>(side);
  if (!snapshot || before[here] == id) return nullptr;
  Panes after = before;
  if (after[1 - here] == id) std::swap(after[0], after[1]);
  after[here] = id;
  return std::make_unique<ShowSnapshot>(before, after, snapshot->view.name);
}

CommandPtr openState(const Document& document, DocumentState state, const std::string& name) {
  return std::make_unique<OpenState>(document, std::move(state), "Open " + name);
}

CommandPtr composite(std::string label, std::vector<CommandPtr> commands) {
  commands.erase(std::remove(commands.begin(), commands.end(), nullptr), commands.end());
  if (commands.empty()) return nullptr;
  return std::make_unique<Composite>(std::move(label), std::move(commands));
}

}  // namespace longarm::session
