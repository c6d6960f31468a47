#include "session/tools/pick_drag.h"

#include <utility>

#include "core/require.h"

namespace longarm::session {

std::vector<int> verticesIn(const SketchItem& item, SnapshotId snapshot) {
  std::vector<int> vertices;
  for (int vertex = 0; vertex < vision::vertexCount(item.kind); ++vertex) {
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

void PickDrag::move(const Eigen::Vector2d& pixel, const Eigen::Vector2d& travel, bool release) {
  LONGARM_REQUIRE(active(), "no drag to move");
  switch (m_way) {
    case Way::kTravel: m_edit = m_editor->moveBy(travel, release); break;
    case Way::kPointer: m_edit = m_editor->moveTo({pixel}, release); break;
    case Way::kStroke: m_edit = m_editor->moveTo({pixel, m_stroke_start}, release); break;
  }
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
