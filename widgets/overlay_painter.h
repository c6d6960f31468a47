#pragma once

/// @file
/// Paints a vision::Overlay by role, with pens and handles of constant size on screen.

#include <functional>
#include <optional>

#include <Eigen/Core>
#include <QFontMetricsF>
#include <QPainter>
#include <QPolygonF>
#include <QVector>

#include "vision/sketch/pointer_event.h"
#include "widgets/theme.h"

namespace longarm::widgets {

/// Widget position of a raw pixel; nothing where it cannot be shown.
using PixelToWidget = std::function<std::optional<QPointF>(const Eigen::Vector2d& raw)>;

struct OverlayLook {
  bool labels = true;
  double size_factor = 1;          ///< Of widths and handles.
  double max_step_px = 0;          ///< > 0: chords longer than this [raw px] are subdivided before mapping.
};

/// Half the width of a handle on screen [px]; what a pick radius should be compared with.
constexpr double kHandleRadius = 7;
/// How far a marker of size factor 1 reaches from its pixel, without the width of its lines [px].
constexpr double kMarkerReach = kHandleRadius * 1.25 * 1.5;

/// The look of the shape's role, in the colour the operator gave the feature where there is one.
RoleStyle styleOf(const vision::OverlayShape& shape, const Theme& theme);
/// Draws all shapes in order.  GUI thread only.
void paintOverlay(QPainter& painter, const vision::Overlay& overlay, const Theme& theme,
                  const PixelToWidget& to_widget, const OverlayLook& look = {});
/// Runs of widget positions of a polyline; a point that cannot be shown breaks the line.
QVector<QPolygonF> mapRuns(const vision::OverlayShape& shape, const PixelToWidget& to_widget, double max_step_px);

/// Where a label goes: beside `at`, not beyond `right` of the widget.
struct PlacedText {
  QString text;
  QPointF anchor;                  ///< Left end of the base line.
  QRectF box;                      ///< What it covers.
};
PlacedText placeText(const vision::OverlayShape& shape, const QPointF& at, const QFontMetricsF& metrics, double right);
/// Text with a dark edge; `anchor` is the left end of its base line.
void paintHaloText(QPainter& painter, const QPointF& anchor, const QString& text, const QColor& color);

}  // namespace longarm::widgets
