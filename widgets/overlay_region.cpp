#include "widgets/overlay_region.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace longarm::widgets {

namespace {

using vision::OverlayRole;
using vision::OverlayShape;

constexpr int kTile = 32;              // edge of a tile [px]
constexpr double kEdge = 2;            // halo and smoothing beyond half the width of a line [px]

// A raster of tiles over the widget: bounded work and a bounded number of rectangles whatever is drawn.
class Tiles {
 public:
  explicit Tiles(const QSize& widget)
      : m_columns((widget.width() + kTile - 1) / kTile),
        m_rows((widget.height() + kTile - 1) / kTile),
        m_marked(static_cast<std::size_t>(std::max(0, m_columns * m_rows))) {}

  void mark(const QRectF& box) {
    const QRectF area(0, 0, m_columns * kTile, m_rows * kTile);
    // Something drawn at no number at all is nowhere.
    if (!std::isfinite(box.left() + box.top() + box.right() + box.bottom())) return;
    const QRectF inside = box.intersected(area);
    if (inside.isEmpty()) return;
    const int right = std::min(m_columns - 1, static_cast<int>(inside.right()) / kTile);
    const int bottom = std::min(m_rows - 1, static_cast<int>(inside.bottom()) / kTile);
    for (int y = static_cast<int>(inside.top()) / kTile; y <= bottom; ++y) {
      for (int x = static_cast<int>(inside.left()) / kTile; x <= right; ++x) m_marked[index(x, y)] = 1;
    }
  }

  // Boxes of at most a tile's length along the part of the segment that lies near the widget.
  void markSegment(QPointF a, QPointF b, double margin) {
    if (!clip(a, b, margin)) return;
    const QPointF way = b - a;
    const int pieces = 1 + static_cast<int>(std::max(std::abs(way.x()), std::abs(way.y())) / kTile);
    for (int i = 0; i < pieces; ++i) {
      const QRectF piece(a + way * i / pieces, a + way * (i + 1) / pieces);
      mark(piece.normalized().adjusted(-margin, -margin, margin, margin));
    }
  }

  // Tiles whose middle lies inside; those at the edge are the segments' business.
  void markInside(const QPolygonF& area) {
    const QRectF box = area.boundingRect();
    for (int y = 0; y < m_rows; ++y) {
      for (int x = 0; x < m_columns; ++x) {
        const QPointF middle((x + 0.5) * kTile, (y + 0.5) * kTile);
        if (box.contains(middle) && area.containsPoint(middle, Qt::OddEvenFill)) m_marked[index(x, y)] = 1;
      }
    }
  }

  QRegion region() const {
    QRegion region;
    for (int y = 0; y < m_rows; ++y) {
      for (int x = 0; x < m_columns; ++x) {
        const int from = x;
        while (x < m_columns && m_marked[index(x, y)] != 0) ++x;
        if (x > from) region += QRect(from * kTile, y * kTile, (x - from) * kTile, kTile);
      }
    }
    return region;
  }

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y * m_columns + x); }

  // Cuts the segment to the widget and its margin, one axis after the other; false when nothing is left.
  bool clip(QPointF& a, QPointF& b, double margin) const {
    double from = 0, to = 1;
    const auto axis = [&](double start, double way, double high) {
      if (way == 0) return start >= -margin && start <= high + margin;
      double enter = (-margin - start) / way, leave = (high + margin - start) / way;
      if (enter > leave) std::swap(enter, leave);
      from = std::max(from, enter);
      to = std::min(to, leave);
      return from <= to;
    };
    const QPointF start = a, way = b - a;
    if (!(std::isfinite(way.x()) && std::isfinite(way.y()))) return false;
    if (!axis(start.x(), way.x(), m_columns * kTile) || !axis(start.y(), way.y(), m_rows * kTile)) return false;
    a = start + way * from;
    b = start + way * to;
    return true;
  }

  int m_columns, m_rows;
  std::vector<std::uint8_t> m_marked;
};

struct Cover {
  const Theme& theme;
  const PixelToWidget& to_widget;
  const OverlayLook& look;
  const QFontMetricsF& metrics;
  const QSize& widget;
  Tiles tiles;

  void add(const OverlayShape& shape) {
    const double margin = 0.5 * theme.role(shape.role).width * look.size_factor + kEdge;
    switch (shape.kind) {
      case OverlayShape::Kind::kPolyline: addLine(shape, margin); break;
      case OverlayShape::Kind::kMarker: addMarkers(shape, margin); break;
      case OverlayShape::Kind::kText: addText(shape); break;
      case OverlayShape::Kind::kArea: addArea(shape); break;
    }
  }
  void addLine(const OverlayShape& shape, double margin) {
    for (const auto& run : mapRuns(shape, to_widget, look.max_step_px)) {
      for (int i = 1; i < run.size(); ++i) tiles.markSegment(run[i - 1], run[i], margin);
    }
  }
  void addArea(const OverlayShape& shape) {
    for (const auto& run : mapRuns(shape, to_widget, look.max_step_px)) {
      for (int i = 0; i < run.size(); ++i) tiles.markSegment(run[i], run[(i + 1) % run.size()], kEdge);
      tiles.markInside(run);
    }
  }
  void addMarkers(const OverlayShape& shape, double margin) {
    const double reach = kMarkerReach * look.size_factor + margin;
    for (const auto& raw : shape.points) {
      if (const auto at = to_widget(raw)) tiles.mark(QRectF(*at, *at).adjusted(-reach, -reach, reach, reach));
    }
  }
  void addText(const OverlayShape& shape) {
    if (!look.labels || shape.points.empty()) return;
    const auto at = to_widget(shape.points.front());
    if (!at) return;
    const QRectF box = placeText(shape, *at, metrics, widget.width() - 1).box;
    tiles.mark(box.adjusted(-kEdge, -kEdge, kEdge, kEdge));
  }
};

bool isSame(const OverlayShape& a, const OverlayShape& b) {
  return a.kind == b.kind && a.role == b.role && a.colour_rgb == b.colour_rgb && a.points == b.points && a.text == b.text;
}

// A tick's label is left out where it would cover another's, so that one may appear because another has moved.
bool dependsOnOthers(const OverlayShape& shape) {
  return shape.kind == OverlayShape::Kind::kText && shape.role == OverlayRole::kDepthTick;
}

}  // namespace

QRegion changedRegion(const vision::Overlay& before, const vision::Overlay& after, const Theme& theme,
                      const PixelToWidget& to_widget, const OverlayLook& look, const QFontMetricsF& metrics,
                      const QSize& widget) {
  Cover cover{theme, to_widget, look, metrics, widget, Tiles(widget)};
  const std::size_t count = std::max(before.shapes.size(), after.shapes.size());
  std::vector<const OverlayShape*> ticks;
  bool changed = false;
  for (std::size_t i = 0; i < count; ++i) {
    const OverlayShape* a = i < before.shapes.size() ? &before.shapes[i] : nullptr;
    const OverlayShape* b = i < after.shapes.size() ? &after.shapes[i] : nullptr;
    const bool same = a != nullptr && b != nullptr && isSame(*a, *b);
    changed = changed || !same;
    for (const auto* shape : {a, b}) {
      if (shape == nullptr) continue;
      if (!same) cover.add(*shape);
      if (same && dependsOnOthers(*shape)) ticks.push_back(shape);
    }
  }
  if (changed) {
    for (const auto* tick : ticks) cover.add(*tick);
  }
  return cover.tiles.region();
}

}  // namespace longarm::widgets
