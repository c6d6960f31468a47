#include "session/tools/hit_test.h"

#include <algorithm>

#include "session/document/overlay_builder.h"

namespace longarm::session {

namespace {

double distanceToSegment(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double s = length2 == 0 ? 0 : std::clamp((p - a).dot(ab) / length2, 0.0, 1.0);
  return (a + s * ab - p).norm();
}

double distanceToPolyline(const Eigen::Vector2d& p, const std::vector<Eigen::Vector2d>& points) {
  double best = (points.front() - p).norm();
  for (std::size_t i = 1; i < points.size(); ++i) best = std::min(best, distanceToSegment(p, points[i - 1], points[i]));
  return best;
}

std::optional<Hit> hitHandle(const SketchItem& item, const Handle& base, const Eigen::Vector2d& pixel, double radius) {
  std::optional<Hit> best;
  for (int vertex = 0; vertex < item.vertices(); ++vertex) {
    const SketchPick* pick = item.pick(base.snapshot, vertex);
    if (pick == nullptr) continue;
    const double distance = (pick->pixel - pixel).norm();
    if (distance > radius || (best && distance >= best->distance_px)) continue;
    best = Hit{base, distance};
    best->handle.vertex = vertex;
  }
  return best;
}

}  // namespace

std::optional<Hit> hitItem(const Document& document, const SketchItem& item, PaneSide side,
                           const Eigen::Vector2d& pixel, double radius_px) {
  const SnapshotPtr picture = document.paneSnapshot(side);
  if (!picture) return std::nullopt;
  const Handle base{item.id, -1, picture->id, side};
  if (auto handle = hitHandle(item, base, pixel, radius_px)) return handle;
  std::optional<Hit> best;
  for (const auto& [a, b] : edgesOf(item)) {
    const SketchPick* from = item.pick(picture->id, a);
    const SketchPick* to = item.pick(picture->id, b);
    if (from == nullptr || to == nullptr) continue;
    const double distance = distanceToPolyline(pixel, pictureOfEdge(picture->view.camera, from->pixel, to->pixel));
    if (distance <= radius_px && (!best || distance < best->distance_px)) best = Hit{base, distance};
  }
  return best;
}

std::optional<Hit> hitTest(const Document& document, PaneSide side, const Eigen::Vector2d& pixel, double radius_px) {
  std::optional<Hit> best;
  int best_rank = -1;
  for (const auto& item : document.items()) {
    if (item.hidden) continue;
    const auto hit = hitItem(document, item, side, pixel, radius_px);
    if (!hit) continue;
    const int rank = (hit->handle.valid() ? 2 : 0) + (document.selection().contains(item.id) ? 1 : 0);
    if (rank < best_rank || (rank == best_rank && hit->distance_px >= best->distance_px)) continue;
    best = hit;
    best_rank = rank;
  }
  return best;
}

}  // namespace longarm::session
