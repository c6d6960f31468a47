#pragma once

/// @file
/// The loupe: 8 screen pixels per picture pixel around one pixel, with its coordinates to 0.1 px.

#include <Eigen/Core>
#include <QPainter>
#include <QRectF>
#include <QString>

#include "vision/sketch/pointer_event.h"
#include "widgets/overlay_painter.h"
#include "widgets/theme.h"

namespace longarm::widgets {

constexpr double kLoupeMagnification = 8;
constexpr double kLoupeSize = 136;             ///< Edge of the magnified part [screen px].

/// "u 123.4  v 56.7": always a point, one decimal.
QString pixelReadOut(const Eigen::Vector2d& raw);

/// Where the loupe stands: beside `about`, inside the widget, never over `about`.
QRectF loupeRect(const QPointF& about, const QSizeF& widget);

/// What the loupe shows.
struct LoupeContent {
  const QImage* picture = nullptr;             ///< As shown; borrowed.
  Eigen::Vector2d centre = {0, 0};             ///< In `picture`, centre origin [px].
  Eigen::Vector2d raw = {0, 0};                ///< For the read-out [raw px].
};

/// `shown_of_raw` maps raw pixels into `content.picture`; used for the overlays.
void paintLoupe(QPainter& painter, const QRectF& where, const LoupeContent& content, const vision::Overlay& overlay,
                const Theme& theme,
                const std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)>& shown_of_raw);

}  // namespace longarm::widgets
