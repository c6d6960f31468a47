#pragma once

/// @file
/// Paints a vision::Overlay by role, with pens and handles of constant size on screen.

#include <functional>
#include <optional>

#include <Eigen/Core>
#include <QPainter>

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

/// Draws all shapes in order.  GUI thread only.
void paintOverlay(QPainter& painter, const vision::Overlay& overlay, const Theme& theme,
                  const PixelToWidget& to_widget, const OverlayLook& look = {});
/// Text with a dark edge; `anchor` is the left end of its base line.
void paintHaloText(QPainter& painter, const QPointF& anchor, const QString& text, const QColor& color);

}  // namespace longarm::widgets
