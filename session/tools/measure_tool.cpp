#include "session/tools/measure_tool.h"

#include <algorithm>

#include "session/document/overlay_builder.h"
#include "session/tools/hit_test.h"

namespace longarm::session {

void MeasureTool::activate(const Document& document) {
  m_document = &document;
  deactivate();
}

void MeasureTool::deactivate() {
  m_filter.cancel();
  m_taken.clear();
}

ToolReply MeasureTool::onPointer(const vision::PointerEvent& event) {
  if (m_document == nullptr) return {};
  const auto gesture = m_filter.feed(event);
  ToolReply reply;
  reply.consumed = event.left;
  if (!gesture || gesture->kind != GestureKind::kClick) return reply;
  const auto hit = hitTest(*m_document, gesture->side, gesture->pixel, gesture->tolerance_px);
  if (!hit || !hit->handle.valid()) return reply;
  return onVertex({hit->handle.item, hit->handle.vertex});
}

ToolReply MeasureTool::onVertex(const VertexRef& vertex) {
  ToolReply reply;
  if (m_document == nullptr || m_document->item(vertex.item) == nullptr) return reply;
  if (state() == State::kDone) m_taken.clear();
  m_taken.push_back(vertex);
  reply.consumed = reply.redraw = true;
  return reply;
}

ToolReply MeasureTool::onKey(vision::SketchKey key, const vision::KeyModifiers&) {
  return key == vision::SketchKey::kEscape ? cancel() : ToolReply{};
}

ToolReply MeasureTool::cancel() {
  ToolReply reply;
  reply.consumed = reply.redraw = true;
  reply.finished = m_taken.empty();
  deactivate();
  return reply;
}

void MeasureTool::documentChanged() {
  if (m_document == nullptr) return;
  const auto gone = [this](const VertexRef& ref) { return m_document->item(ref.item) == nullptr; };
  if (std::any_of(m_taken.begin(), m_taken.end(), gone)) m_taken.clear();
}

std::optional<SceneDimension> MeasureTool::dimension() const {
  SceneDimension out;
  for (const auto& ref : m_taken) {
    const auto place = positionOf(*m_document, ref);
    if (!place) return std::nullopt;
    out.points.push_back(*place);
  }
  if (out.points.empty()) return std::nullopt;
  const auto number = out.points.size() > 1 ? measured() : Result<Dimension>(Error{ErrorCode::kRefused, ""});
  if (number) out.text = number->text();
  return out;
}

// Where the picture shows the vertex: as it was marked there, else as it was measured in others.
std::optional<Eigen::Vector2d> MeasureTool::placeIn(const vision::Snapshot& picture, const VertexRef& ref) const {
  const SketchPick* pick = m_document->item(ref.item)->pick(picture.id, ref.vertex);
  if (pick != nullptr && pick->placed()) return pick->pixel;
  const auto place = positionOf(*m_document, ref);
  const auto pixel = place ? picture.view.project(*place) : Result<Eigen::Vector2d>(place.error());
  return pixel && picture.view.camera.containsPixel(*pixel) ? std::optional(*pixel) : std::nullopt;
}

Result<Dimension> MeasureTool::measured() const {
  if (m_taken.size() == 3) return angleAt(*m_document, m_taken[0], m_taken[1], m_taken[2]);
  return distanceBetween(*m_document, m_taken[0], m_taken[1]);
}

vision::Overlay MeasureTool::preview(PaneSide side) const {
  vision::Overlay overlay;
  const SnapshotPtr picture = m_document == nullptr ? nullptr : m_document->paneSnapshot(side);
  if (!picture || m_taken.empty()) return overlay;
  std::vector<Eigen::Vector2d> places;
  for (const auto& ref : m_taken) {
    const auto place = placeIn(*picture, ref);
    if (!place) return overlay;
    places.push_back(*place);
    overlay.shapes.push_back({vision::OverlayShape::Kind::kMarker, vision::OverlayRole::kDimension, {*place}, {}});
  }
  for (std::size_t i = 1; i < places.size(); ++i) {
    overlay.shapes.push_back({vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kDimension,
                              pictureOfEdge(picture->view.camera, places[i - 1], places[i]), {}});
  }
  if (places.size() < 2) return overlay;
  const auto number = measured();
  const Eigen::Vector2d at = places.size() == 3 ? places[1] : Eigen::Vector2d((places[0] + places[1]) / 2);
  overlay.shapes.push_back({vision::OverlayShape::Kind::kText, vision::OverlayRole::kDimension, {at}, number ? number->text() : "?"});
  return overlay;
}

std::string MeasureTool::nameOf(const VertexRef& ref) const { return "'" + m_document->item(ref.item)->name + "'"; }

std::string MeasureTool::hint() const {
  if (m_document == nullptr || m_document->items().empty()) return "There is nothing to measure between. Mark points or lines first.";
  if (m_taken.empty()) return "Click the first handle of what is to be measured, in a picture or in the scene; Esc ends.";
  if (m_taken.size() == 1) return "From " + nameOf(m_taken[0]) + ": click the handle to measure to.";
  const auto number = measured();
  if (!number) return number.error().message;
  if (m_taken.size() == 2) return "Distance " + number->text() + ". A third handle gives the angle at the second; Esc begins anew.";
  return "Angle at " + nameOf(m_taken[1]) + " " + number->text() + ". Click a handle to begin anew.";
}

}  // namespace longarm::session
