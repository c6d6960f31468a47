#include "widgets/overlay_painter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <QFontMetricsF>
#include <QPainterPath>
#include <QVector>

namespace longarm::widgets {

namespace {

using vision::OverlayRole;
using vision::OverlayShape;

const QColor kHalo(0, 0, 0, 190);

// A curve of many small bends looks the same with plain joins, and round ones are most of what drawing it costs.
Qt::PenJoinStyle joinOf(int points) { return points > 8 ? Qt::BevelJoin : Qt::RoundJoin; }

QPen penOf(const RoleStyle& style, double factor, int points = 0) {
  QPen pen(style.color, style.width * factor, style.dashed ? Qt::CustomDashLine : Qt::SolidLine, Qt::RoundCap,
           joinOf(points));
  if (style.dashed) pen.setDashPattern({4, 3});
  return pen;
}

}  // namespace

QVector<QPolygonF> mapRuns(const OverlayShape& shape, const PixelToWidget& to_widget, double max_step) {
  QVector<QPolygonF> runs(1);
  const auto add = [&](const Eigen::Vector2d& raw) {
    const auto position = to_widget(raw);
    if (position) {
      runs.last().append(*position);
    } else if (!runs.last().isEmpty()) {
      runs.append(QPolygonF());
    }
  };
  for (std::size_t i = 0; i < shape.points.size(); ++i) {
    if (i > 0 && max_step > 0) {
      const Eigen::Vector2d step = shape.points[i] - shape.points[i - 1];
      const int pieces = static_cast<int>(std::min(200.0, std::ceil(step.norm() / max_step)));
      for (int k = 1; k < pieces; ++k) add(shape.points[i - 1] + step * k / pieces);
    }
    add(shape.points[i]);
  }
  return runs;
}

namespace {

// Whether both ends lie beyond the same side.
bool isOutside(const QRectF& bounds, const QPointF& a, const QPointF& b) {
  return std::max(a.x(), b.x()) < bounds.left() || std::min(a.x(), b.x()) > bounds.right() ||
         std::max(a.y(), b.y()) < bounds.top() || std::min(a.y(), b.y()) > bounds.bottom();
}

// The runs without what cannot be seen: the loupe shows a fiftieth of a line.
QVector<QPolygonF> culled(const QVector<QPolygonF>& runs, const QRectF& bounds) {
  QVector<QPolygonF> out;
  for (const auto& run : runs) {
    bool open = false;
    for (int i = 1; i < run.size(); ++i) {
      if (isOutside(bounds, run[i - 1], run[i])) {
        open = false;
        continue;
      }
      if (!open) out.append(QPolygonF({run[i - 1]}));
      out.last().append(run[i]);
      open = true;
    }
  }
  return out;
}

void paintPolyline(QPainter& painter, const OverlayShape& shape, const RoleStyle& style,
                   const PixelToWidget& to_widget, const OverlayLook& look) {
  auto runs = mapRuns(shape, to_widget, look.max_step_px);
  if (!style.dashed) {                         // dashes are counted from the beginning
    const QRectF seen = painter.hasClipping() ? painter.clipBoundingRect() : QRectF(painter.viewport());
    runs = culled(runs, seen.adjusted(-8, -8, 8, 8));
  }
  const int points = static_cast<int>(shape.points.size());
  painter.setBrush(Qt::NoBrush);
  if (style.halo) {
    QPen halo(kHalo, style.width * look.size_factor + 2, Qt::SolidLine, Qt::RoundCap, joinOf(points));
    painter.setPen(halo);
    for (const auto& run : runs) painter.drawPolyline(run);
  }
  painter.setPen(penOf(style, look.size_factor, points));
  for (const auto& run : runs) painter.drawPolyline(run);
}

void paintArea(QPainter& painter, const OverlayShape& shape, const RoleStyle& style, const PixelToWidget& to_widget,
               const OverlayLook& look) {
  constexpr int kSeenThrough = 60, kHatch = 110;   // of 255
  QColor fill = style.color;
  fill.setAlpha(kSeenThrough);
  painter.setPen(Qt::NoPen);
  painter.setBrush(fill);
  if (shape.role == OverlayRole::kOwnLink) {     // hatched, so that a grey arm before a grey wall is told, too
    fill.setAlpha(kHatch);
    painter.setBrush(QBrush(fill, Qt::BDiagPattern));
  }
  for (const auto& run : mapRuns(shape, to_widget, look.max_step_px)) painter.drawPolygon(run);
}

// A ring with a cross inside that leaves the pixel itself free to see.
void paintHandle(QPainter& painter, const QPointF& at, const RoleStyle& style, double factor, bool active) {
  const double r = kHandleRadius * factor * (active ? 1.25 : 1);
  const double gap = r * 0.35;
  QPainterPath path;
  path.addEllipse(at, r, r);
  for (const QPointF way : {QPointF(1, 0), QPointF(-1, 0), QPointF(0, 1), QPointF(0, -1)}) {
    path.moveTo(at + way * gap);
    path.lineTo(at + way * (r * 1.5));
  }
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(kHalo, style.width * factor + 2.2, Qt::SolidLine, Qt::RoundCap));
  painter.drawPath(path);
  painter.setPen(penOf(style, factor));
  painter.drawPath(path);
}

void paintTick(QPainter& painter, const QPointF& at, const RoleStyle& style, double factor) {
  painter.setPen(QPen(kHalo, 1));
  painter.setBrush(style.color);
  painter.drawEllipse(at, 3.2 * factor, 3.2 * factor);
}

void paintMarker(QPainter& painter, const OverlayShape& shape, const RoleStyle& style,
                 const PixelToWidget& to_widget, const OverlayLook& look) {
  for (const auto& raw : shape.points) {
    const auto at = to_widget(raw);
    if (!at) continue;
    switch (shape.role) {
      case OverlayRole::kHandle:
      case OverlayRole::kMatch:
      case OverlayRole::kRival:
      case OverlayRole::kUnplaced: paintHandle(painter, *at, style, look.size_factor, false); break;
      case OverlayRole::kActiveHandle: paintHandle(painter, *at, style, look.size_factor, true); break;
      default: paintTick(painter, *at, style, look.size_factor); break;
    }
  }
}

// Depth ticks crowd together far away: a label that would cover one drawn before is left out.
void paintText(QPainter& painter, const OverlayShape& shape, const RoleStyle& style, const PixelToWidget& to_widget,
               std::vector<QRectF>& ticks) {
  if (shape.points.empty()) return;
  const auto at = to_widget(shape.points.front());
  if (!at) return;
  const QFontMetricsF metrics(painter.font());
  const PlacedText placed = placeText(shape, *at, metrics, painter.viewport().right());
  if (shape.role == OverlayRole::kDepthTick) {
    const auto crossed = [&](const QRectF& other) { return other.intersects(placed.box); };
    if (std::any_of(ticks.begin(), ticks.end(), crossed)) return;
    ticks.push_back(placed.box);
  }
  paintHaloText(painter, placed.anchor, placed.text, style.color);
}

}  // namespace

PlacedText placeText(const OverlayShape& shape, const QPointF& at, const QFontMetricsF& metrics, double right) {
  const bool tick = shape.role == OverlayRole::kDepthTick;
  const double lift = tick ? 5 : kHandleRadius + 5;
  PlacedText placed;
  placed.text = QString::fromStdString(shape.text);
  placed.anchor = at + QPointF(lift, tick ? lift + metrics.ascent() : -lift);
  const double reach = right - metrics.horizontalAdvance(placed.text) - 3;
  placed.anchor.setX(std::max(3.0, std::min(placed.anchor.x(), reach)));
  placed.box = metrics.boundingRect(placed.text).translated(placed.anchor).adjusted(-3, 0, 3, 0);
  return placed;
}

void paintHaloText(QPainter& painter, const QPointF& anchor, const QString& text, const QColor& color) {
  // The same glyphs about the place, out of the font's cache: stroking their outlines takes a hundred times as long.
  painter.setPen(kHalo);
  for (const QPointF way : {QPointF(-1, -1), QPointF(0, -1), QPointF(1, -1), QPointF(-1, 0), QPointF(1, 0),
                            QPointF(-1, 1), QPointF(0, 1), QPointF(1, 1)}) {
    painter.drawText(anchor + way, text);
  }
  painter.setPen(color);
  painter.drawText(anchor, text);
}

RoleStyle styleOf(const OverlayShape& shape, const Theme& theme) {
  RoleStyle style = theme.role(shape.role);
  const bool plain = shape.role == OverlayRole::kSketch || shape.role == OverlayRole::kSelected ||
                     shape.role == OverlayRole::kHandle || shape.role == OverlayRole::kLabel;
  if (plain && shape.colour_rgb >= 0) style.color = QColor(static_cast<QRgb>(shape.colour_rgb));
  return style;
}

void paintOverlay(QPainter& painter, const vision::Overlay& overlay, const Theme& theme,
                  const PixelToWidget& to_widget, const OverlayLook& look) {
  painter.save();
  painter.setRenderHint(QPainter::Antialiasing);
  std::vector<QRectF> ticks;
  for (const auto& shape : overlay.shapes) {
    const RoleStyle style = styleOf(shape, theme);
    switch (shape.kind) {
      case OverlayShape::Kind::kPolyline: paintPolyline(painter, shape, style, to_widget, look); break;
      case OverlayShape::Kind::kMarker: paintMarker(painter, shape, style, to_widget, look); break;
      case OverlayShape::Kind::kArea: paintArea(painter, shape, style, to_widget, look); break;
      case OverlayShape::Kind::kText:
        if (look.labels) paintText(painter, shape, style, to_widget, ticks);
        break;
    }
  }
  painter.restore();
}

}  // namespace longarm::widgets
