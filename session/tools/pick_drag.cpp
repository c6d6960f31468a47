#include "session/tools/pick_drag.h"

#include <algorithm>
#include <utility>

#include "core/require.h"

namespace longarm::session {

std::vector<int> verticesIn(const SketchItem& item, SnapshotId snapshot) {
  std::vector<int> vertices;
  for (int vertex = 0; vertex < item.vertices(); ++vertex) {
    if (item.pick(snapshot, vertex) != nullptr) vertices.push_back(vertex);
  }
  return vertices;
}

void PickDrag::begin(const Document& document, const SketchItem& item, const Handle& handle) {
  const std::vector<int> vertices = handle.valid() ? std::vector<int>{handle.vertex} : verticesIn(item, handle.snapshot);
  m_editor = std::make_unique<PickEditor>(document, item, handle.snapshot, vertices);
  m_handle = handle;
  m_handle.vertex = vertices.front();
  m_way = Way::kTravel;
  m_edit = PickEdit();
  m_edit.item = item;
}

void PickDrag::beginAtPointer(const Document& document, const SketchItem& item, const Handle& handle) {
  begin(document, item, handle);
  m_way = Way::kPointer;
}

void PickDrag::beginStroke(const Document& document, const SketchItem& item, const Handle& first, int second,
                           const Eigen::Vector2d& press_pixel) {
  // The vertex that follows the pointer comes first: it is the one whose numbers are shown.
  m_editor = std::make_unique<PickEditor>(document, item, first.snapshot, std::vector<int>{second, first.vertex});
  m_handle = first;
  m_handle.vertex = second;
  m_stroke_start = press_pixel;
  m_way = Way::kStroke;
  m_edit = PickEdit();
  m_edit.item = item;
}

Eigen::Vector2d PickDrag::snapped(int vertex, const Eigen::Vector2d& wanted, const Gesture& gesture,
                                  MatchPictures* pictures, std::optional<vision::SnapKind>* kind) const {
  if (pictures == nullptr || gesture.modifiers.shift == pictures->snapping()) return wanted;
  const auto picture = pictures->of(m_editor->document().snapshot(m_editor->snapshot()));
  if (!picture) return wanted;
  const auto snap = m_editor->snapped(vertex, wanted, gesture.modifiers.control, *picture, snapRadius(gesture.tolerance_px));
  if (!snap) return wanted;
  *kind = snap->kind;
  return snap->pixel;
}

void PickDrag::move(const Gesture& gesture, MatchPictures* pictures) {
  LONGARM_REQUIRE(active(), "no drag to move");
  const bool release = gesture.modifiers.control;
  const std::vector<int>& vertices = m_editor->vertices();
  if (m_way == Way::kTravel && vertices.size() > 1) {
    m_edit = m_editor->moveBy(gesture.travel(), release);
    return;
  }
  Eigen::Vector2d wanted = gesture.pixel;
  if (m_way == Way::kTravel) wanted = m_editor->before().pick(m_editor->snapshot(), vertices[0])->pixel + gesture.travel();
  std::optional<vision::SnapKind> kind, start_kind;
  std::vector<Eigen::Vector2d> places{snapped(vertices[0], wanted, gesture, pictures, &kind)};
  if (m_way == Way::kStroke) places.push_back(snapped(vertices[1], m_stroke_start, gesture, pictures, &start_kind));
  m_edit = m_editor->moveTo(places, release);
  m_edit.snapped = kind;
}

SketchItem PickDrag::finish() {
  LONGARM_REQUIRE(active(), "no drag to finish");
  m_editor.reset();
  return std::move(m_edit.item);
}

Eigen::Vector2d arrowDirection(vision::SketchKey key) {
  switch (key) {
    case vision::SketchKey::kLeft: return {-1, 0};
    case vision::SketchKey::kRight: return {1, 0};
    case vision::SketchKey::kUp: return {0, -1};
    case vision::SketchKey::kDown: return {0, 1};
    default: return Eigen::Vector2d::Zero();
  }
}

double snapRadius(double tolerance_px) { return std::clamp(0.75 * tolerance_px, 4.0, 16.0); }

PickEdit placedAt(const Document& document, const SketchItem& item, const Handle& handle, const Gesture& gesture,
                  MatchPictures* pictures) {
  PickDrag drag;
  drag.beginAtPointer(document, item, handle);
  drag.move(gesture, pictures);
  return drag.edit();
}

vision::Overlay dragPreview(const Document& document, const PickDrag& drag, PaneSide side) {
  vision::Overlay overlay = handlePreview(document, drag.item(), drag.handle(), side);
  const SketchPick* pick = drag.item().pick(drag.handle().snapshot, drag.handle().vertex);
  if (side != drag.handle().side || !drag.edit().snapped || pick == nullptr) return overlay;
  const std::string word = *drag.edit().snapped == vision::SnapKind::kCorner ? "corner" : "edge";
  overlay.shapes.push_back({vision::OverlayShape::Kind::kText, vision::OverlayRole::kMatch, {pick->pixel}, word});
  return overlay;
}

PickEdit nudged(const Document& document, const SketchItem& item, const Handle& handle, vision::SketchKey key,
                const vision::KeyModifiers& modifiers) {
  const PickEditor editor(document, item, handle.snapshot, {handle.vertex});
  return editor.nudge(arrowDirection(key), modifiers.shift ? 1.0 : 0.1, modifiers.control);
}

std::string nudgeKey(const Handle& handle) {
  return "nudge " + std::to_string(handle.item.value) + " " + std::to_string(handle.vertex) + " " +
         std::to_string(handle.snapshot.value);
}

}  // namespace longarm::session
