#include "session/tools/draw_tool.h"

#include <algorithm>
#include <utility>

#include "session/commands/sketch_commands.h"
#include "session/tools/hit_test.h"
#include "session/tools/match_help.h"

namespace longarm::session {

namespace {

constexpr PaneSide kSides[] = {PaneSide::kLeft, PaneSide::kRight};
// Outlines of a thin pipe, or ends of a short line, lie nearer to each other than the pick radius: while something is still to
// be marked in a picture, only a press on the handle itself takes it.
constexpr double kOnHandle = 0.5;          // of the pick radius

ToolReply consumed(bool redraw = true) {
  ToolReply reply;
  reply.consumed = true;
  reply.redraw = redraw;
  return reply;
}

Eigen::Vector2d sizeOf(const vision::Snapshot& snapshot) {
  const int width = snapshot.view.camera.width > 0 ? snapshot.view.camera.width : snapshot.image.cols;
  const int height = snapshot.view.camera.height > 0 ? snapshot.view.camera.height : snapshot.image.rows;
  return {std::max(width - 1, 0), std::max(height - 1, 0)};
}

const char* sideWord(PaneSide side) { return side == PaneSide::kLeft ? "left" : "right"; }

}  // namespace

void DrawTool::activate(const Document& document) {
  m_document = &document;
  m_id = document.nextFeatureId();
  deactivate();
  refresh();
}

void DrawTool::deactivate() {
  m_filter.cancel();
  m_drag.cancel();
  m_grab.reset();
  m_active = {};
  m_note.clear();
  m_state = State::kNoPicture;
}

void DrawTool::refresh() {
  const SketchItem* stored = m_document->item(m_id);
  if (stored != nullptr) {
    m_item = *stored;
  } else {
    m_item = SketchItem{};
    m_item.id = m_id;
    m_item.kind = m_kind;
    m_item.pipe = m_pipe;
    m_item.name = m_document->freeName(m_kind, m_pipe);
  }
  bool any = false;
  for (const PaneSide side : kSides) {
    const SnapshotPtr picture = m_document->paneSnapshot(side);
    if (!picture) continue;
    any = true;
    for (int vertex = 0; vertex < m_item.vertices(); ++vertex) {
      if (m_item.pick(picture->id, vertex) != nullptr) continue;
      const Eigen::Vector2d place = startPlace(vertex).cwiseProduct(sizeOf(*picture));
      m_item.setPick(picture->id, vertex, {place, PickState::kUnplaced});
    }
  }
  if (m_state == State::kNoPicture && any) m_state = State::kPlacing;
  if (!any) m_state = State::kNoPicture;
  const std::vector<Handle> all = handles();
  if (std::find(all.begin(), all.end(), m_active) == all.end()) {
    const auto next = nextUnplaced();
    m_active = next ? *next : Handle{};
  }
}

std::vector<Handle> DrawTool::handles() const {
  std::vector<Handle> all;
  for (const PaneSide side : kSides) {
    const SnapshotId id = m_document->paneSnapshotId(side);
    if (side == PaneSide::kRight && id == m_document->paneSnapshotId(PaneSide::kLeft)) continue;
    for (const int vertex : verticesIn(m_item, id)) all.push_back({m_id, vertex, id, side});
  }
  return all;
}

bool DrawTool::isPlaced(const Handle& handle) const {
  const SketchPick* pick = m_item.pick(handle.snapshot, handle.vertex);
  return pick != nullptr && pick->placed();
}

std::optional<Handle> DrawTool::nextUnplaced(PaneSide side) const {
  const SnapshotId id = m_document->paneSnapshotId(side);
  for (const int vertex : verticesIn(m_item, id)) {
    const Handle handle{m_id, vertex, id, side};
    if (!isPlaced(handle)) return handle;
  }
  return std::nullopt;
}

std::optional<Handle> DrawTool::nextUnplaced() const {
  const PaneSide first = m_active.valid() ? m_active.side : PaneSide::kLeft;
  if (const auto here = nextUnplaced(first)) return here;
  return nextUnplaced(otherSide(first));
}

bool DrawTool::complete(const SketchItem& item) const {
  const SnapshotId left = m_document->paneSnapshotId(PaneSide::kLeft);
  const SnapshotId right = m_document->paneSnapshotId(PaneSide::kRight);
  return left.valid() && right.valid() && left != right && item.placedIn(left) && item.placedIn(right);
}

ToolReply DrawTool::commit(SketchItem after, const std::string& label, const std::string& merge_key) {
  ToolReply reply = consumed();
  const SketchItem* stored = m_document->item(m_id);
  if (stored != nullptr && *stored == after) return reply;
  if (complete(after)) {
    reply.finished = true;
    reply.selection = Selection::of(m_id);
  }
  reply.command = stored == nullptr ? addItem(std::move(after))
                                    : replaceItem(*m_document, std::move(after), label, merge_key);
  return reply;
}

ToolReply DrawTool::onPointer(const vision::PointerEvent& event) {
  if (m_document == nullptr || m_state == State::kNoPicture) return {};
  const auto gesture = m_filter.feed(event);
  if (!gesture) {
    ToolReply reply;
    reply.consumed = m_state == State::kGrabbed || m_state == State::kDragging;
    return reply;
  }
  switch (gesture->kind) {
    case GestureKind::kHover: return onHover(*gesture);
    case GestureKind::kPress: return onPress(*gesture);
    case GestureKind::kClick: return onClick(*gesture);
    case GestureKind::kDragBegin:
    case GestureKind::kDragMove: return onDrag(*gesture);
    case GestureKind::kDragEnd: return onDragEnd(*gesture);
    case GestureKind::kDoubleClick: return consumed(false);
  }
  return {};
}

ToolReply DrawTool::onHover(const Gesture& gesture) {
  if (m_active.valid() && (m_active.side == gesture.side || !isPlaced(m_active))) return {};
  const auto next = nextUnplaced(gesture.side);
  if (!next) return {};
  m_active = *next;
  ToolReply reply;
  reply.redraw = true;
  return reply;
}

ToolReply DrawTool::onPress(const Gesture& gesture) {
  m_drag.cancel();
  m_grab.reset();
  m_state = State::kPlacing;
  m_note.clear();
  const SnapshotPtr picture = m_document->paneSnapshot(gesture.side);
  if (!picture) {
    m_filter.cancel();
    return {};
  }
  if (!isOnPicture(*picture, gesture.pixel) && !meantBy(gesture)) {
    m_filter.cancel();
    m_note = "That is off the picture: nothing was marked. Mark it where the picture shows it, or turn the camera there and take another.";
    ToolReply reply;
    reply.redraw = true;
    return reply;
  }
  m_grab = meantBy(gesture);
  m_state = State::kGrabbed;
  return consumed(false);
}

std::optional<Handle> DrawTool::meantBy(const Gesture& press) const {
  const auto hit = hitItem(*m_document, m_item, press.side, press.pixel, press.tolerance_px);
  if (!hit) return std::nullopt;
  if (!nextUnplaced(press.side)) return hit->handle;
  // The body of a copy that is not placed yet is no hindrance to a stroke across it.
  if (!hit->handle.valid()) return std::nullopt;
  // An outline is drawn with a stroke, wherever its copy lies; other copies are there to be dragged.
  if (!isPlaced(hit->handle)) return m_pipe ? std::nullopt : std::optional(hit->handle);
  return hit->distance_px <= kOnHandle * press.tolerance_px ? std::optional(hit->handle) : std::nullopt;
}

ToolReply DrawTool::onClick(const Gesture& gesture) {
  if (m_state != State::kGrabbed) return {};
  m_state = State::kPlacing;
  if (m_grab && m_grab->valid() && isPlaced(*m_grab)) {
    m_active = *m_grab;
    return consumed();
  }
  const bool active_here = m_active.valid() && m_active.side == gesture.side && !isPlaced(m_active);
  const auto handle = active_here ? std::optional(m_active) : nextUnplaced(gesture.side);
  if (!handle) return consumed(false);
  m_active = *handle;
  return commit(placedAt(*m_document, m_item, *handle, gesture, pictures()).item, "Place '" + m_item.name + "'");
}

bool DrawTool::beginDrag(const Gesture& gesture) {
  if (m_grab) {
    m_drag.begin(*m_document, m_item, *m_grab);
    return true;
  }
  const auto first = nextUnplaced(gesture.side);
  if (!first) return false;
  for (int vertex = first->vertex + 1; vertex < m_item.vertices(); ++vertex) {
    if (isPlaced({m_id, vertex, first->snapshot, first->side})) continue;
    m_drag.beginStroke(*m_document, m_item, *first, vertex, gesture.press_pixel);
    return true;
  }
  m_drag.beginAtPointer(*m_document, m_item, *first);
  return true;
}

ToolReply DrawTool::onDrag(const Gesture& gesture) {
  if (m_state == State::kGrabbed) {
    if (!beginDrag(gesture)) {
      m_filter.cancel();
      m_state = State::kPlacing;
      return consumed(false);
    }
    m_active = m_drag.handle();
    m_state = State::kDragging;
  }
  if (m_state != State::kDragging) return {};
  m_drag.move(gesture, pictures());
  return consumed();
}

ToolReply DrawTool::onDragEnd(const Gesture& gesture) {
  if (m_state != State::kDragging) return {};
  m_drag.move(gesture, pictures());
  m_state = State::kPlacing;
  return commit(m_drag.finish(), "Place '" + m_item.name + "'");
}

ToolReply DrawTool::onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) {
  if (key == vision::SketchKey::kEscape) return cancel();
  if (m_document == nullptr || m_state == State::kNoPicture) return {};
  if (m_state != State::kPlacing) return consumed(false);
  m_note.clear();
  switch (key) {
    case vision::SketchKey::kDelete: return onDelete();
    case vision::SketchKey::kTab: return onTab(modifiers.shift);
    case vision::SketchKey::kReturn: return onReturn();
    default: return onArrow(key, modifiers);
  }
}

ToolReply DrawTool::onArrow(vision::SketchKey key, const vision::KeyModifiers& modifiers) {
  if (!m_active.valid()) return {};
  PickEdit edit = nudged(*m_document, m_item, m_active, key, modifiers);
  if (edit.item == m_item) return consumed();
  return commit(std::move(edit.item), "Nudge '" + m_item.name + "'", nudgeKey(m_active));
}

ToolReply DrawTool::onReturn() {
  if (!m_active.valid() || isPlaced(m_active)) {
    const auto next = nextUnplaced();
    if (!next) return consumed();
    m_active = *next;
    return consumed();
  }
  const PickEditor editor(*m_document, m_item, m_active.snapshot, {m_active.vertex});
  return commit(editor.moveBy(Eigen::Vector2d::Zero(), false).item, "Place '" + m_item.name + "'");
}

ToolReply DrawTool::onTab(bool backwards) {
  const std::vector<Handle> all = handles();
  if (all.empty()) return {};
  const auto here = std::find(all.begin(), all.end(), m_active);
  const std::size_t n = all.size(), at = static_cast<std::size_t>(here - all.begin());
  m_active = here == all.end() ? all.front() : all[(at + (backwards ? n - 1 : 1)) % n];
  return consumed();
}

std::vector<MatchWish> DrawTool::matchWishes() const {
  const SnapshotId panes[] = {m_document == nullptr ? SnapshotId{} : m_document->paneSnapshotId(PaneSide::kLeft),
                              m_document == nullptr ? SnapshotId{} : m_document->paneSnapshotId(PaneSide::kRight)};
  std::vector<MatchWish> wishes;
  if (m_pipe || m_state == State::kDragging || !panes[0].valid() || !panes[1].valid() || panes[0] == panes[1]) return wishes;
  for (int vertex = 0; vertex < m_item.vertices(); ++vertex) {
    for (const int from : {0, 1}) {
      const SketchPick *here = m_item.pick(panes[from], vertex), *there = m_item.pick(panes[1 - from], vertex);
      const bool wanted = here != nullptr && here->placed() && there != nullptr && !there->placed();
      if (wanted) wishes.push_back({m_id, vertex, panes[from], panes[1 - from], here->pixel});
    }
  }
  return wishes;
}

ToolReply DrawTool::acceptMatch(const MatchHelp& help) {
  if (m_state != State::kPlacing || help.matches.empty()) return {};
  SketchItem after = withMatch(m_item, help);
  const PaneSide side = help.wish.to == m_document->paneSnapshotId(PaneSide::kLeft) ? PaneSide::kLeft : PaneSide::kRight;
  m_active = {m_id, help.wish.vertex, help.wish.to, side};
  return commit(std::move(after), "Accept match of '" + m_item.name + "'");
}

ToolReply DrawTool::onDelete() {
  ToolReply reply = consumed();
  reply.command = removeItems(*m_document, {m_id});
  return reply;
}

ToolReply DrawTool::cancel() {
  m_filter.cancel();
  ToolReply reply = consumed();
  if (m_state == State::kGrabbed || m_state == State::kDragging) {
    m_drag.cancel();
    m_state = State::kPlacing;
    return reply;
  }
  reply.finished = true;
  return reply;
}

void DrawTool::documentChanged() {
  if (m_document == nullptr) return;
  const bool held = m_state == State::kDragging || m_state == State::kGrabbed;
  const bool was_stored = m_drag.active() && m_document->item(m_id) == nullptr && m_item.placedCount(0) > 0;
  const bool picture_left = m_drag.active() &&
                            m_document->paneSnapshotId(m_drag.handle().side) != m_drag.handle().snapshot;
  if (held && (was_stored || picture_left)) {
    m_filter.cancel();
    m_drag.cancel();
    m_state = State::kPlacing;
  }
  refresh();
}

std::vector<const SketchItem*> DrawTool::drafts() const {
  const SketchItem* item = draft();
  return item == nullptr ? std::vector<const SketchItem*>{} : std::vector<const SketchItem*>{item};
}

const SketchItem* DrawTool::draft() const {
  if (m_document == nullptr || m_state == State::kNoPicture) return nullptr;
  return m_drag.active() ? &m_drag.item() : &m_item;
}

vision::Overlay DrawTool::preview(PaneSide side) const {
  const SketchItem* item = draft();
  if (item == nullptr) return {};
  return m_drag.active() ? dragPreview(*m_document, m_drag, side) : handlePreview(*m_document, *item, m_active, side);
}

std::optional<LiveMeasure> DrawTool::liveMeasure() const {
  const SketchItem* item = draft();
  if (item == nullptr || !m_active.valid()) return std::nullopt;
  return liveMeasureOf(*m_document, *item, m_active, m_drag.active() ? &m_drag.edit() : nullptr);
}

std::string DrawTool::hint() const {
  if (m_document == nullptr || m_state == State::kNoPicture) return "Take a pair of snapshots first, then mark it in both.";
  if (m_drag.active()) return dragHint(m_drag.edit());
  return m_note.empty() ? placingHint() : m_note;
}

std::string DrawTool::placingHint() const {
  const std::string kind = wordFor(m_item);
  const auto next = nextUnplaced();
  if (!next) {
    const bool same = m_document->paneSnapshotId(PaneSide::kLeft) == m_document->paneSnapshotId(PaneSide::kRight);
    return same ? "Both panes show the same picture. Show another one to mark the " + kind + " in it too."
                : "Put a second picture into the other pane to mark the " + kind + " in it too.";
  }
  const std::string where = std::string(" in the ") + sideWord(next->side) + " picture";
  const bool constrained = constrainingSnapshot(*m_document, m_item, next->snapshot, next->vertex).valid();
  if (constrained) {
    return "Slide " + vertexName(next->vertex) + where + " along its curve onto the same spot; Control leaves the curve.";
  }
  return "Drag or click " + vertexName(next->vertex) + where + " onto the feature; " +
         (pictures() != nullptr && pictures()->snapping() ? "with Shift it does not snap, Esc ends." : "Shift snaps to corners and edges, Esc ends.");
}

}  // namespace longarm::session
