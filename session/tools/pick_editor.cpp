#include "session/tools/pick_editor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

#include "core/require.h"
#include "core/text.h"
#include "session/document/feature_rows.h"
#include "vision/sketch/overlay.h"
#include "vision/stereo/epipolar_band.h"
#include "vision/stereo/triangulate.h"

namespace longarm::session {

namespace {

constexpr double kOffPicture_px = 1;       // Beyond the outer pixels.

Eigen::Vector2d keptOnPicture(const vision::Snapshot& snapshot, const Eigen::Vector2d& pixel) {
  const int width = snapshot.view.camera.width > 0 ? snapshot.view.camera.width : snapshot.image.cols;
  const int height = snapshot.view.camera.height > 0 ? snapshot.view.camera.height : snapshot.image.rows;
  if (width <= 0 || height <= 0) return pixel;
  return {std::clamp(pixel.x(), 0.0, width - 1.0), std::clamp(pixel.y(), 0.0, height - 1.0)};
}

bool inAPane(const Document& document, SnapshotId id) {
  return document.paneSnapshotId(PaneSide::kLeft) == id || document.paneSnapshotId(PaneSide::kRight) == id;
}

/// Unit direction of the piece of the curve that is nearest to the pixel.
Eigen::Vector2d tangentNear(const vision::EpipolarCurve& curve, const Eigen::Vector2d& pixel) {
  Eigen::Vector2d best = Eigen::Vector2d::Zero();
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const Eigen::Vector2d a = curve.points[i - 1].pixel, ab = curve.points[i].pixel - a;
    if (ab.squaredNorm() == 0 || curve.points[i].begins_piece) continue;
    const double s = std::clamp((pixel - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    const double distance = (a + s * ab - pixel).squaredNorm();
    if (distance < nearest) {
      nearest = distance;
      best = ab.normalized();
    }
  }
  return best;
}

/// The nearest corner before the nearest edge.  A wide search alone would take the strongest of several corners.
std::optional<vision::SnapPoint> nearestSnap(const vision::MatchPicture& picture, const Eigen::Vector2d& pixel, double radius_px) {
  constexpr double kFirst_px = 4;
  for (const bool corners : {true, false}) {
    for (double reach = std::min(kFirst_px, radius_px);; reach = std::min(2 * reach, radius_px)) {
      vision::SnapOptions options;
      options.radius_px = reach;
      options.corners = corners;
      options.edges = !corners;
      if (const auto snap = vision::snapPick(picture, pixel, options)) return snap;
      if (reach >= radius_px) break;
    }
  }
  return std::nullopt;
}

/// Where the straight edge through the snapped point crosses the curve, or the curve's point nearest to a corner.
std::optional<Eigen::Vector2d> heldTo(const vision::EpipolarCurve& curve, const vision::SnapPoint& snap, double radius_px) {
  if (snap.kind == vision::SnapKind::kCorner) {
    const auto nearest = curve.nearest(snap.pixel);
    if (!nearest || (nearest->pixel - snap.pixel).norm() > radius_px) return std::nullopt;
    return nearest->pixel;
  }
  std::optional<Eigen::Vector2d> best;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    if (curve.points[i].begins_piece) continue;
    const Eigen::Vector2d a = curve.points[i - 1].pixel, ab = curve.points[i].pixel - a, to = snap.pixel - a;
    const double turn = ab.x() * snap.along.y() - ab.y() * snap.along.x();
    if (std::abs(turn) < 0.1 * ab.norm()) continue;   // Nearly along the edge: the crossing would be anywhere.
    const double s = (to.x() * snap.along.y() - to.y() * snap.along.x()) / turn;
    const Eigen::Vector2d crossing = a + s * ab;
    if (s < 0 || s > 1 || (crossing - snap.pixel).norm() > radius_px) continue;
    if (!best || (crossing - snap.pixel).norm() < (*best - snap.pixel).norm()) best = crossing;
  }
  return best;
}

std::optional<vision::EpipolarCurve> curveBetween(const vision::Snapshot& from, const Eigen::Vector2d& pixel,
                                                  const vision::Snapshot& to) {
  auto curve = vision::epipolarCurve(from.view, pixel, to.view);
  if (!curve || curve->points.empty()) return std::nullopt;
  return std::move(*curve);
}

}  // namespace

bool isOnPicture(const vision::Snapshot& snapshot, const Eigen::Vector2d& pixel) {
  return (keptOnPicture(snapshot, pixel) - pixel).norm() <= kOffPicture_px;
}

std::string dragHint(const PickEdit& edit) {
  if (edit.off_picture) return "The picture ends here: what lies beyond it cannot be marked. Esc cancels; turn the camera there and take another.";
  if (edit.released) return "Off the epipolar curve: the miss shows how far. Let go of Control to return to it.";
  if (edit.on_curve) return "Slides along the epipolar curve. Hold Control to leave it; Esc to cancel.";
  return "Drag onto the feature; Esc cancels.";
}

SnapshotId constrainingSnapshot(const Document& document, const SketchItem& item, SnapshotId snapshot, int vertex) {
  if (item.pipe || item.edge) return {};
  const SketchPick* own = item.pick(snapshot, vertex);
  const bool own_is_free = own != nullptr && own->state == PickState::kFree;
  SnapshotId best;
  int best_score = -1;
  for (const auto& [id, list] : item.picks) {
    const SketchPick* other = item.pick(id, vertex);
    if (id == snapshot || other == nullptr || !other->placed() || !document.snapshot(id)) continue;
    if (own_is_free && other->state != PickState::kFree) return {};
    const int score = (inAPane(document, id) ? 2 : 0) + (other->state == PickState::kFree ? 1 : 0);
    if (score > best_score) {
      best_score = score;
      best = id;
    }
  }
  return best;
}

std::optional<vision::EpipolarCurve> constrainingCurve(const Document& document, const SketchItem& item,
                                                       SnapshotId snapshot, int vertex) {
  const SnapshotId from = constrainingSnapshot(document, item, snapshot, vertex);
  const SnapshotPtr source = document.snapshot(from), target = document.snapshot(snapshot);
  if (!source || !target) return std::nullopt;
  return curveBetween(*source, item.pick(from, vertex)->pixel, *target);
}

Result<SketchItem> withVertexAt(const Document& document, const SketchItem& item, int vertex, const Eigen::Vector3d& xyz) {
  if (item.pipe) return Error{ErrorCode::kInvalidInput, "The outlines of a pipe are no points: move them in the pictures."};
  SketchItem after = item;
  int moved = 0;
  for (const auto& [id, list] : item.picks) {
    const SketchPick* pick = item.pick(id, vertex);
    const SnapshotPtr picture = document.snapshot(id);
    if (pick == nullptr || !pick->placed() || !picture) continue;
    const auto pixel = picture->view.project(xyz);
    if (!pixel || !picture->view.camera.containsPixel(*pixel)) {
      return Error{ErrorCode::kInvalidInput, "Picture " + picture->view.name + " does not see that place."};
    }
    after.setPick(id, vertex, {*pixel, pick->state == PickState::kMatched ? PickState::kConstrained : pick->state});
    ++moved;
  }
  if (moved < 2) return Error{ErrorCode::kInvalidInput, "'" + item.name + "' is not marked in two pictures there: it has no place yet."};
  return after;
}

Result<SketchItem> withPickAt(const Document& document, const SketchItem& item, SnapshotId snapshot, int vertex,
                              const Eigen::Vector2d& pixel) {
  const SnapshotPtr picture = document.snapshot(snapshot);
  if (!picture || item.pick(snapshot, vertex) == nullptr) return Error{ErrorCode::kInvalidInput, "There is no such pick."};
  if (!pixel.allFinite() || (keptOnPicture(*picture, pixel) - pixel).norm() > 0) {
    return Error{ErrorCode::kInvalidInput, "(" + formatFixed(pixel.x(), 1) + ", " + formatFixed(pixel.y(), 1) + ") is off picture " +
                                               picture->view.name + "."};
  }
  const PickEditor editor(document, item, snapshot, {vertex});
  return editor.moveTo({pixel}, true).item;
}

PickEditor::PickEditor(const Document& document, SketchItem item, SnapshotId snapshot, std::vector<int> vertices)
    : m_document(document), m_before(std::move(item)), m_snapshot(snapshot), m_vertices(std::move(vertices)) {
  LONGARM_REQUIRE(!m_vertices.empty(), "no vertex to move");
  for (const int vertex : m_vertices) {
    LONGARM_REQUIRE(m_before.pick(snapshot, vertex) != nullptr, "no pick to move");
    if (auto curve = constrainingCurve(document, m_before, snapshot, vertex)) m_curves[vertex] = std::move(*curve);
  }
}

PickEdit PickEditor::moveTo(const std::vector<Eigen::Vector2d>& wanted, bool release) const {
  LONGARM_REQUIRE(wanted.size() == m_vertices.size(), "one pixel per vertex");
  const SnapshotPtr picture = m_document.snapshot(m_snapshot);
  PickEdit edit;
  edit.item = m_before;
  if (!picture) return edit;
  for (std::size_t i = 0; i < m_vertices.size(); ++i) {
    const int vertex = m_vertices[i];
    const bool held = constrainingSnapshot(m_document, m_before, m_snapshot, vertex).valid();
    const auto curve = m_curves.find(vertex);
    SketchPick pick{keptOnPicture(*picture, wanted[i]), held ? PickState::kReleased : PickState::kFree};
    if (i == 0) edit.raw = pick.pixel;
    if (i == 0) edit.off_picture = (wanted[i] - pick.pixel).norm() > kOffPicture_px;
    if (held && !release && curve != m_curves.end()) {
      const auto nearest = curve->second.nearest(pick.pixel);
      if (nearest) {
        pick = {nearest->pixel, PickState::kConstrained};
        if (i == 0) edit.depth = nearest->depth;
      }
    }
    edit.item.setPick(m_snapshot, vertex, pick);
    follow(edit.item, vertex);
    if (i != 0) continue;
    edit.constrained = pick.pixel;
    edit.on_curve = pick.state == PickState::kConstrained;
    edit.released = pick.state == PickState::kReleased;
  }
  return edit;
}

PickEdit PickEditor::moveBy(const Eigen::Vector2d& travel, bool release) const {
  std::vector<Eigen::Vector2d> wanted;
  for (const int vertex : m_vertices) wanted.push_back(m_before.pick(m_snapshot, vertex)->pixel + travel);
  return moveTo(wanted, release);
}

PickEdit PickEditor::nudge(const Eigen::Vector2d& direction, double step_px, bool release) const {
  const auto curve = m_curves.find(m_vertices.front());
  if (curve == m_curves.end() || release) return moveBy(step_px * direction, release);
  const Eigen::Vector2d tangent = tangentNear(curve->second, m_before.pick(m_snapshot, m_vertices.front())->pixel);
  const double along = tangent.dot(direction);
  // A key across the curve asks for what the constraint forbids: nothing moves.
  if (std::abs(along) < 0.05) return moveBy(Eigen::Vector2d::Zero(), false);
  return moveBy((along > 0 ? step_px : -step_px) * tangent, false);
}

std::optional<vision::SnapPoint> PickEditor::snapped(int vertex, const Eigen::Vector2d& wanted, bool release,
                                                     const vision::MatchPicture& picture, double radius_px) const {
  const auto curve = m_curves.find(vertex);
  Eigen::Vector2d from = wanted;
  if (!release && curve != m_curves.end()) {
    const auto nearest = curve->second.nearest(wanted);
    if (nearest) from = nearest->pixel;
  }
  auto snap = nearestSnap(picture, from, radius_px);
  if (!snap || release || curve == m_curves.end()) return snap;
  const auto held = heldTo(curve->second, *snap, radius_px);
  if (!held) return std::nullopt;
  snap->pixel = *held;
  return snap;
}

void PickEditor::follow(SketchItem& item, int vertex) const {
  const SketchPick moved = *item.pick(m_snapshot, vertex);
  const SnapshotPtr source = m_document.snapshot(m_snapshot);
  for (const auto& [id, list] : m_before.picks) {
    const SketchPick* old = m_before.pick(id, vertex);
    const SnapshotPtr target = m_document.snapshot(id);
    if (id == m_snapshot || old == nullptr || !target) continue;
    const bool held = old->state == PickState::kConstrained || old->state == PickState::kMatched;
    const bool slid = held && moved.state == PickState::kFree;
    if (!slid && old->state != PickState::kUnplaced) continue;
    const auto curve = curveBetween(*source, moved.pixel, *target);
    if (!curve) continue;
    const PickState state = slid ? PickState::kConstrained : PickState::kUnplaced;   // What was matched no longer is.
    if (const auto nearest = curve->nearest(old->pixel)) item.setPick(id, vertex, {nearest->pixel, state});
  }
}

namespace {

void fillVertex(LiveMeasure& live, const Eigen::Vector3d& xyz, const Eigen::Matrix3d& covariance, double miss) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance, Eigen::EigenvaluesOnly);
  live.xyz = xyz;
  live.plus_minus = plusMinus95(std::sqrt(std::max(0.0, axes.eigenvalues()(2))));
  live.miss = miss;
}

void measureVertexAlone(LiveMeasure& live, const Document& document, const SketchItem& item, int vertex) {
  std::vector<vision::Sighting> sightings;
  for (const auto& [id, list] : item.picks) {
    const SketchPick* pick = item.pick(id, vertex);
    const SnapshotPtr picture = document.snapshot(id);
    if (pick == nullptr || !pick->placed() || !picture) continue;
    sightings.push_back({&picture->view, pick->pixel, pick->sigma_px});
  }
  if (sightings.size() < 2) return;
  const auto point = vision::triangulate(sightings);
  if (!point) {
    live.reason = point.error().message;
    return;
  }
  fillVertex(live, point->xyz, point->covariance, point->miss_m);
  live.warnings = point->warnings;
}

}  // namespace

LiveMeasure liveMeasureOf(const Document& document, const SketchItem& item, const Handle& handle,
                          const PickEdit* edit) {
  LiveMeasure live;
  live.handle = handle;
  const SketchPick* pick = item.pick(handle.snapshot, handle.vertex);
  if (pick != nullptr) {
    live.raw = live.constrained = pick->pixel;
    live.on_curve = pick->state == PickState::kConstrained;
    live.released = pick->state == PickState::kReleased;
  }
  if (edit != nullptr) live.raw = edit->raw;
  const Measurement measurement = document.measure(item);
  live.reason = measurement.reason;
  live.feature = measurement.feature;
  if (measurement.feature && item.pipe) {
    const vision::Feature& pipe = *measurement.feature;
    const auto& end = pipe.vertices[static_cast<std::size_t>(handle.vertex % 2)];
    fillVertex(live, end.xyz, end.covariance, end.miss_m);
    live.warnings = pipe.warnings;
    live.length = pipe.length();
    live.length_plus_minus = plusMinus95(pipe.lengthSigma());
    live.radius = pipe.pipe->radius;
    live.radius_plus_minus = plusMinus95(pipe.pipe->radius_sigma);
  } else if (measurement.feature) {
    const auto& vertex = measurement.feature->vertices[static_cast<std::size_t>(handle.vertex)];
    fillVertex(live, vertex.xyz, vertex.covariance, vertex.miss_m);
    live.warnings = measurement.feature->warnings;
    if (item.kind == vision::FeatureKind::kLine) {
      live.length = measurement.feature->length();
      live.length_plus_minus = plusMinus95(measurement.feature->lengthSigma());
    }
  } else if (!item.pipe && !item.edge) {
    measureVertexAlone(live, document, item, handle.vertex);
  }
  const SnapshotPtr from = document.snapshot(constrainingSnapshot(document, item, handle.snapshot, handle.vertex));
  if (live.xyz && from) live.depth = (from->view.X_WC.inverse() * *live.xyz).z();
  live.refused = !measurement.feature && item.markedTwice();
  if (live.xyz && !live.length && !live.refused) live.reason.clear();
  return live;
}

std::string LiveMeasure::text() const {
  if (refused) return "Not measured: " + reason;
  if (!xyz) return reason;
  std::string line = "x " + formatFixed(xyz->x() * 1000, 1) + "  y " + formatFixed(xyz->y() * 1000, 1) + "  z " +
                     formatFixed(xyz->z() * 1000, 1) + " \u00b1 " + formatFixed(plus_minus * 1000, 1) +
                     " mm   miss " + formatFixed(miss * 1000, 1) + " mm";
  if (length) line += "   length " + millimetreText(*length, *length_plus_minus);
  if (radius) line += "   radius " + millimetreText(*radius, *radius_plus_minus);
  return line;
}

vision::Overlay handlePreview(const Document& document, const SketchItem& item, const Handle& handle, PaneSide side) {
  vision::Overlay overlay;
  const SnapshotId here = document.paneSnapshotId(side);
  if (!handle.valid() || !here.valid()) return overlay;
  const auto curve = constrainingCurve(document, item, here, handle.vertex);
  if (!curve) return overlay;
  const SnapshotPtr from = document.snapshot(constrainingSnapshot(document, item, here, handle.vertex));
  const Eigen::Vector2d& source = item.pick(from->id, handle.vertex)->pixel;
  const auto band = vision::epipolarBand(from->view, source, document.snapshot(here)->view, *curve);
  if (band) vision::addEpipolarBand(*curve, *band, &overlay);
  vision::addEpipolarCurve(*curve, &overlay);
  const SketchPick* pick = item.pick(here, handle.vertex);
  const bool off = pick != nullptr && (pick->state == PickState::kReleased || pick->state == PickState::kMatched);
  if (!off) return overlay;
  const auto nearest = curve->nearest(pick->pixel);
  const LiveMeasure live = liveMeasureOf(document, item, handle);
  vision::OverlayShape line{vision::OverlayShape::Kind::kPolyline, vision::OverlayRole::kMiss,
                            {pick->pixel, nearest->pixel}, {}};
  overlay.shapes.push_back(std::move(line));
  if (live.xyz) {
    overlay.shapes.push_back({vision::OverlayShape::Kind::kText, vision::OverlayRole::kMiss, {pick->pixel},
                              "miss " + millimetreText(live.miss)});
  }
  return overlay;
}

}  // namespace longarm::session
