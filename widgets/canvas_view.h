#pragma once

/// @file
/// CanvasView: where a picture stands in a widget.  The only place that knows both pixel conventions.

#include <Eigen/Core>
#include <QPointF>
#include <QSizeF>

namespace longarm::widgets {

/// Zoom and pan of one picture.  Qt's coordinates have their origin at a corner (the first pixel covers
/// 0 ... 1); ours at the centre of the first pixel (it covers -0.5 ... 0.5).  Thread-compatible value.
class CanvasView {
 public:
  static constexpr double kMinScale = 0.02, kMaxScale = 64;

  /// Screen pixels per picture pixel.
  double scale() const { return m_scale; }
  /// Widget position of the outer corner of the first picture pixel.
  QPointF offset() const { return m_offset; }

  /// Widget position of a picture pixel (centre origin).
  QPointF toWidget(const Eigen::Vector2d& pixel) const;
  /// Picture pixel (centre origin, fractional) under a widget position.
  Eigen::Vector2d toPicture(const QPointF& position) const;

  /// Whole picture, centred, as large as the widget allows.
  void fit(const QSizeF& picture, const QSizeF& widget);
  /// Multiplies the scale (clamped) keeping the picture point under `about` where it is.
  void zoomAbout(const QPointF& about, double factor);
  void setScaleAbout(const QPointF& about, double scale);
  void pan(const QPointF& by) { m_offset += by; }
  /// Keeps at least `margin` screen pixels of the picture inside the widget.
  void keepReachable(const QSizeF& picture, const QSizeF& widget, double margin);
  /// Rounds the offset to whole device pixels, so that 100 % needs no resampling.
  void snapOffset(double device_pixel_ratio);

 private:
  double m_scale = 1;
  QPointF m_offset{0, 0};
};

}  // namespace longarm::widgets
