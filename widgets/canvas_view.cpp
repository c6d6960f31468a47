#include "widgets/canvas_view.h"

#include <algorithm>
#include <cmath>

namespace longarm::widgets {

QPointF CanvasView::toWidget(const Eigen::Vector2d& pixel) const {
  return m_offset + QPointF((pixel.x() + 0.5) * m_scale, (pixel.y() + 0.5) * m_scale);
}

Eigen::Vector2d CanvasView::toPicture(const QPointF& position) const {
  return {(position.x() - m_offset.x()) / m_scale - 0.5, (position.y() - m_offset.y()) / m_scale - 0.5};
}

void CanvasView::fit(const QSizeF& picture, const QSizeF& widget) {
  if (picture.isEmpty() || widget.isEmpty()) return;
  m_scale = std::clamp(std::min(widget.width() / picture.width(), widget.height() / picture.height()), kMinScale,
                       kMaxScale);
  m_offset = QPointF((widget.width() - picture.width() * m_scale) / 2,
                     (widget.height() - picture.height() * m_scale) / 2);
}

void CanvasView::zoomAbout(const QPointF& about, double factor) { setScaleAbout(about, m_scale * factor); }

void CanvasView::setScaleAbout(const QPointF& about, double scale) {
  const double next = std::clamp(scale, kMinScale, kMaxScale);
  m_offset = about + (m_offset - about) * (next / m_scale);
  m_scale = next;
}

void CanvasView::keepReachable(const QSizeF& picture, const QSizeF& widget, double margin) {
  const auto clampAxis = [&](double offset, double size, double room) {
    const double low = margin - size * m_scale;
    const double high = room - margin;
    return low > high ? (low + high) / 2 : std::clamp(offset, low, high);
  };
  m_offset = QPointF(clampAxis(m_offset.x(), picture.width(), widget.width()),
                     clampAxis(m_offset.y(), picture.height(), widget.height()));
}

void CanvasView::snapOffset(double device_pixel_ratio) {
  m_offset = QPointF(std::round(m_offset.x() * device_pixel_ratio) / device_pixel_ratio,
                     std::round(m_offset.y() * device_pixel_ratio) / device_pixel_ratio);
}

}  // namespace longarm::widgets
