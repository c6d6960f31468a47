#include "session/tools/select_tool.h"

#include <algorithm>

#include "session/commands/sketch_commands.h"
#include "session/tools/match_help.h"

namespace longarm::session {

namespace {

ToolReply consumed(bool redraw = true) {
  ToolReply reply;
  reply.consumed = true;
  reply.redraw = redraw;
  return reply;
}

vision::Overlay bandPreview(const Gesture& band, PaneSide side) {
  vision::Overlay overlay;
  if (side != band.side) return overlay;
  const Eigen::Vector2d &a = band.press_pixel, &b = band.pixel;
  overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kUnplaced,
                            {a, {b.x(), a.y()}, b, {a.x(), b.y()}, a}, {}});
  return overlay;
}

std::string quoted(const SketchItem& item) { return "'" + item.name + "'"; }

}  // namespace

void SelectTool::activate(const Document& document) {
  m_document = &document;
  deactivate();
}

void SelectTool::deactivate() {
  m_filter.cancel();
  endDrag();
  m_grab.reset();
  m_band.reset();
  m_active = m_moved = {};
  m_state = State::kIdle;
  m_note.clear();
}

bool SelectTool::exists(const Handle& handle) const {
  const SketchItem* item = m_document == nullptr ? nullptr : m_document->item(handle.item);
  return item != nullptr && !item->hidden && item->pick(handle.snapshot, handle.vertex) != nullptr;
}

void SelectTool::setActiveHandle(const Handle& handle) {
  if (exists(handle)) m_active = handle;
}

ToolReply SelectTool::onPointer(const vision::PointerEvent& event) {
  if (m_document == nullptr) return {};
  const auto gesture = m_filter.feed(event);
  if (!gesture) {
    ToolReply reply;
    reply.consumed = m_state != State::kIdle;
    return reply;
  }
  switch (gesture->kind) {
    case GestureKind::kHover: return onHover(*gesture);
    case GestureKind::kPress: return onPress(*gesture);
    case GestureKind::kClick: return onClick(*gesture);
    case GestureKind::kDragBegin:
    case GestureKind::kDragMove: return onDrag(*gesture);
    case GestureKind::kDragEnd: return onDragEnd(*gesture);
    case GestureKind::kDoubleClick: return {};
  }
  return {};
}

ToolReply SelectTool::onHover(const Gesture& gesture) {
  const auto hit = hitTest(*m_document, gesture.side, gesture.pixel, gesture.tolerance_px);
  std::string note;
  if (hit) {
    const SketchItem& item = *m_document->item(hit->handle.item);
    note = hit->handle.valid() ? "Drag the handle of " + quoted(item) + ", or click to select it."
                               : "Drag " + quoted(item) + " as a whole, or click to select it.";
  }
  ToolReply reply;
  reply.redraw = note != m_note;
  m_note = note;
  return reply;
}

ToolReply SelectTool::onPress(const Gesture& gesture) {
  endDrag();
  m_state = State::kIdle;
  m_note.clear();
  m_band.reset();
  m_grab = hitTest(*m_document, gesture.side, gesture.pixel, gesture.tolerance_px);
  if (!m_grab) return {};
  m_state = State::kGrabbed;
  return consumed(false);
}

ToolReply SelectTool::onClick(const Gesture& gesture) {
  const bool grabbed = m_state == State::kGrabbed && m_grab && m_document->item(m_grab->handle.item) != nullptr;
  m_state = State::kIdle;
  ToolReply reply = consumed();
  const bool keep = gesture.modifiers.control || gesture.modifiers.shift;
  if (!grabbed) {
    reply.consumed = false;
    if (!keep) {
      m_active = {};
      reply.selection = Selection{};
    }
    return reply;
  }
  const FeatureId id = m_grab->handle.item;
  const std::vector<FeatureId> taken = withGroup(id, gesture.modifiers.alt);
  Selection selection = keep ? m_document->selection() : Selection{};
  if (gesture.modifiers.control && selection.contains(id)) {
    for (const FeatureId each : taken) selection.items.erase(each);
  } else {
    selection.items.insert(taken.begin(), taken.end());
    selection.primary = id;
  }
  m_active = m_grab->handle.valid() ? m_grab->handle : Handle{};
  reply.selection = std::move(selection);
  return reply;
}

std::vector<FeatureId> SelectTool::withGroup(FeatureId id, bool alone) const {
  const SketchItem* item = m_document->item(id);
  std::vector<FeatureId> ids;
  for (const auto& other : m_document->items()) {
    const bool together = !alone && item != nullptr && item->group != 0 && other.group == item->group;
    if (other.id == id || together) ids.push_back(other.id);
  }
  return ids;
}

ToolReply SelectTool::onBand(const Gesture& gesture) {
  if (!m_document->paneSnapshot(gesture.side)) return {};
  m_state = State::kBand;
  m_band = gesture;
  return consumed();
}

ToolReply SelectTool::onBandEnd(const Gesture& gesture) {
  m_state = State::kIdle;
  m_band.reset();
  const Eigen::Vector2d low = gesture.press_pixel.cwiseMin(gesture.pixel), high = gesture.press_pixel.cwiseMax(gesture.pixel);
  const SnapshotId shown = m_document->paneSnapshotId(gesture.side);
  Selection selection = gesture.modifiers.shift || gesture.modifiers.control ? m_document->selection() : Selection{};
  for (const auto& item : m_document->items()) {
    if (item.hidden) continue;
    for (const int vertex : verticesIn(item, shown)) {
      const Eigen::Vector2d& at = item.pick(shown, vertex)->pixel;
      if ((at - low).minCoeff() < 0 || (high - at).minCoeff() < 0) continue;
      const auto taken = withGroup(item.id, gesture.modifiers.alt);
      selection.items.insert(taken.begin(), taken.end());
      selection.primary = item.id;
      break;
    }
  }
  ToolReply reply = consumed();
  reply.selection = std::move(selection);
  return reply;
}

std::vector<FeatureId> SelectTool::movedWith(FeatureId id, bool alone) const {
  std::vector<FeatureId> ids = withGroup(id, alone);
  if (alone || !m_document->selection().contains(id)) return ids;
  for (const FeatureId selected : m_document->selection().items) {
    for (const FeatureId each : withGroup(selected, false)) {
      if (std::find(ids.begin(), ids.end(), each) == ids.end()) ids.push_back(each);
    }
  }
  return ids;
}

bool SelectTool::wholeIsGrabbed(const Gesture& gesture) const {
  if (!m_grab->handle.valid()) return true;
  const SketchItem* item = m_document->item(m_grab->handle.item);
  return item->vertices() == 1 && movedWith(item->id, gesture.modifiers.alt).size() > 1;
}

void SelectTool::beginCompanions(const Gesture& gesture) {
  m_companions.clear();
  const FeatureId leader = m_grab->handle.item;
  const SnapshotId shown = m_document->paneSnapshotId(gesture.side);
  for (const FeatureId id : movedWith(leader, gesture.modifiers.alt)) {
    const SketchItem& other = *m_document->item(id);
    const std::vector<int> vertices = verticesIn(other, shown);
    if (id == leader || other.locked || other.hidden || vertices.empty()) continue;
    m_companions.push_back({PickEditor(*m_document, other, shown, vertices), other});
  }
}

void SelectTool::endDrag() {
  m_drag.cancel();
  m_companions.clear();
}

CommandPtr SelectTool::movedTogether(const SketchItem& moved) {
  std::vector<CommandPtr> commands;
  commands.push_back(replaceItem(*m_document, moved, "Move"));
  for (const Companion& companion : m_companions) commands.push_back(replaceItem(*m_document, companion.item, "Move"));
  const std::string what = commands.size() > 1 ? std::to_string(commands.size()) + " features with " : std::string(wordFor(moved)) + " ";
  return composite("Move " + what + quoted(moved), std::move(commands));
}

void SelectTool::moveDrag(const Gesture& gesture) {
  m_drag.move(gesture, pictures());
  for (Companion& companion : m_companions) {
    companion.item = companion.editor.moveBy(gesture.travel(), gesture.modifiers.control).item;
  }
}

ToolReply SelectTool::onDrag(const Gesture& gesture) {
  if (m_state == State::kBand || m_state == State::kIdle) return onBand(gesture);
  if (m_state == State::kGrabbed) {
    const SketchItem* item = m_grab ? m_document->item(m_grab->handle.item) : nullptr;
    if (item == nullptr || item->locked) {
      m_state = State::kIdle;
      m_filter.cancel();
      if (item != nullptr) m_note = quoted(*item) + " is locked. Unlock it in the list to move it.";
      return consumed();
    }
    m_drag.begin(*m_document, *item, m_grab->handle);
    m_companions.clear();
    if (wholeIsGrabbed(gesture)) beginCompanions(gesture);
    m_active = m_drag.handle();
    m_state = State::kDragging;
  }
  moveDrag(gesture);
  ToolReply reply = consumed();
  if (!m_document->selection().contains(m_active.item)) {
    const auto taken = withGroup(m_active.item, gesture.modifiers.alt);
    reply.selection = Selection{{taken.begin(), taken.end()}, m_active.item};
  }
  return reply;
}

ToolReply SelectTool::onDragEnd(const Gesture& gesture) {
  if (m_state == State::kBand) return onBandEnd(gesture);
  if (m_state != State::kDragging) return {};
  moveDrag(gesture);
  SketchItem after = m_drag.finish();
  m_state = State::kIdle;
  ToolReply reply = consumed();
  const SketchItem* before = m_document->item(after.id);
  if (before == nullptr || *before == after) {
    m_companions.clear();
    return reply;
  }
  if (!m_companions.empty() || (m_grab && !m_grab->handle.valid())) {
    reply.command = movedTogether(after);
    m_companions.clear();
    return reply;
  }
  m_moved = m_active;
  const std::string label = std::string("Move handle of ") + wordFor(after) + " " + quoted(after);
  reply.command = replaceItem(*m_document, std::move(after), label);
  return reply;
}

ToolReply SelectTool::onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) {
  if (m_document == nullptr || m_state == State::kDragging || m_state == State::kBand) {
    return key == vision::SketchKey::kEscape ? cancel() : consumed(false);
  }
  m_note.clear();
  switch (key) {
    case vision::SketchKey::kEscape: return cancel();
    case vision::SketchKey::kDelete: return onDelete();
    case vision::SketchKey::kTab: return onTab(modifiers.shift);
    case vision::SketchKey::kReturn: return {};
    default: return onArrow(key, modifiers);
  }
}

ToolReply SelectTool::onArrow(vision::SketchKey key, const vision::KeyModifiers& modifiers) {
  if (!exists(m_active)) return {};
  const SketchItem& item = *m_document->item(m_active.item);
  ToolReply reply = consumed();
  if (item.locked) {
    m_note = quoted(item) + " is locked. Unlock it in the list to move it.";
    return reply;
  }
  PickEdit edit = nudged(*m_document, item, m_active, key, modifiers);
  if (edit.item == item) return reply;
  reply.command = replaceItem(*m_document, std::move(edit.item), "Nudge " + quoted(item), nudgeKey(m_active));
  return reply;
}

std::vector<Handle> SelectTool::handlesOf(FeatureId id) const {
  std::vector<Handle> handles;
  const SketchItem* item = m_document->item(id);
  if (item == nullptr || item->hidden) return handles;
  for (const PaneSide side : {PaneSide::kLeft, PaneSide::kRight}) {
    const SnapshotId snapshot = m_document->paneSnapshotId(side);
    for (const int vertex : verticesIn(*item, snapshot)) handles.push_back({id, vertex, snapshot, side});
  }
  return handles;
}

ToolReply SelectTool::onTab(bool backwards) {
  const std::vector<Handle> handles = handlesOf(m_document->selection().primary);
  if (handles.empty()) return {};
  const auto here = std::find(handles.begin(), handles.end(), m_active);
  const std::size_t n = handles.size();
  const std::size_t at = static_cast<std::size_t>(here - handles.begin());
  m_active = here == handles.end() ? handles[backwards ? n - 1 : 0] : handles[(at + (backwards ? n - 1 : 1)) % n];
  return consumed();
}

ToolReply SelectTool::onDelete() {
  std::vector<FeatureId> ids;
  for (const FeatureId id : m_document->selection().items) {
    const SketchItem* item = m_document->item(id);
    if (!item->locked) ids.push_back(id);
    else m_note = quoted(*item) + " is locked. Unlock it in the list to delete it.";
  }
  if (m_document->selection().items.empty()) return {};
  ToolReply reply = consumed();
  reply.command = removeItems(*m_document, ids);
  return reply;
}

ToolReply SelectTool::cancel() {
  m_filter.cancel();
  if (m_state != State::kIdle) {
    endDrag();
    m_band.reset();
    m_state = State::kIdle;
    return consumed();
  }
  if (m_document == nullptr || m_document->selection().items.empty()) return {};
  m_active = {};
  ToolReply reply = consumed();
  reply.selection = Selection{};
  return reply;
}

void SelectTool::documentChanged() {
  if (m_state == State::kGrabbed && m_grab && m_document->item(m_grab->handle.item) == nullptr) m_state = State::kIdle;
  const bool gone = m_state == State::kDragging && !exists(m_drag.handle());
  const bool other_picture = m_state == State::kDragging &&
                             m_document->paneSnapshotId(m_drag.handle().side) != m_drag.handle().snapshot;
  if (gone || other_picture) {
    m_filter.cancel();
    endDrag();
    m_state = State::kIdle;
  }
  m_companions.remove_if([this](const Companion& each) { return m_document->item(each.item.id) == nullptr; });
  if (m_active.valid() && !exists(m_active)) m_active = {};
}

// After its first pick was moved a vertex has only been slid along in the other picture.
std::vector<MatchWish> SelectTool::matchWishes() const {
  if (m_state == State::kDragging || !m_moved.valid() || !(m_moved == m_active) || !exists(m_moved)) return {};
  const SketchItem& item = *m_document->item(m_moved.item);
  const SnapshotId other = m_document->paneSnapshotId(otherSide(m_moved.side));
  const SketchPick *here = item.pick(m_moved.snapshot, m_moved.vertex), *there = item.pick(other, m_moved.vertex);
  if (item.locked || there == nullptr || here->state != PickState::kFree || other == m_moved.snapshot) return {};
  if (there->state != PickState::kConstrained && there->placed()) return {};
  return {{m_moved.item, m_moved.vertex, m_moved.snapshot, other, here->pixel}};
}

ToolReply SelectTool::acceptMatch(const MatchHelp& help) {
  const SketchItem* item = m_document == nullptr ? nullptr : m_document->item(help.wish.item);
  if (m_state != State::kIdle || item == nullptr || help.matches.empty()) return {};
  ToolReply reply = consumed();
  m_moved = {};
  reply.command = replaceItem(*m_document, withMatch(*item, help), "Accept match of " + quoted(*item));
  return reply;
}

std::vector<const SketchItem*> SelectTool::drafts() const {
  std::vector<const SketchItem*> items;
  if (!m_drag.active()) return items;
  for (const Companion& companion : m_companions) items.push_back(&companion.item);
  items.push_back(&m_drag.item());
  return items;
}

vision::Overlay SelectTool::preview(PaneSide side) const {
  if (m_band) return bandPreview(*m_band, side);
  if (m_drag.active()) return dragPreview(*m_document, m_drag, side);
  if (!exists(m_active)) return {};
  return handlePreview(*m_document, *m_document->item(m_active.item), m_active, side);
}

std::optional<LiveMeasure> SelectTool::liveMeasure() const {
  if (m_drag.active()) return liveMeasureOf(*m_document, m_drag.item(), m_drag.handle(), &m_drag.edit());
  if (!exists(m_active)) return std::nullopt;
  return liveMeasureOf(*m_document, *m_document->item(m_active.item), m_active);
}

std::string SelectTool::hint() const {
  if (m_drag.active()) return dragHint(m_drag.edit());
  if (m_band) return "Let go to select what has a handle in the frame; with Shift it is added.";
  if (!m_note.empty()) return m_note;
  const SketchItem* chosen = m_document == nullptr ? nullptr : m_document->item(m_document->selection().primary);
  if (chosen != nullptr && chosen->markedTwice() && !m_document->measurement(chosen->id).feature) {
    return quoted(*chosen) + " is not measured: " + m_document->measurement(chosen->id).reason;
  }
  if (m_active.valid()) return "Arrow keys move the handle 0.1 px, with Shift 1 px; Tab goes to the next handle.";
  if (m_document != nullptr && !m_document->selection().items.empty()) {
    return "Choose a macro, drag a handle, or press Tab to work with the keys.";
  }
  if (m_document != nullptr && m_document->snapshots().empty()) return "Take a pair of snapshots to begin.";
  return "Choose Point or Line and mark what matters, or click a feature to select it.";
}

}  // namespace longarm::session
