#include "widgets/loupe.h"

#include <algorithm>

namespace longarm::widgets {

namespace {

constexpr double kTextHeight = 20;
constexpr double kGap = 28;

}  // namespace

QString pixelReadOut(const Eigen::Vector2d& raw) {
  return QStringLiteral("u %1  v %2").arg(QString::number(raw.x(), 'f', 1), QString::number(raw.y(), 'f', 1));
}

QRectF loupeRect(const QPointF& about, const QSizeF& widget) {
  const QSizeF size(kLoupeSize, kLoupeSize + kTextHeight);
  // Above right of the pixel; the other side where that would leave the widget.
  double left = about.x() + kGap;
  if (left + size.width() > widget.width()) left = about.x() - kGap - size.width();
  double top = about.y() - kGap - size.height();
  if (top < 0) top = about.y() + kGap;
  left = std::clamp(left, 0.0, std::max(0.0, widget.width() - size.width()));
  top = std::clamp(top, 0.0, std::max(0.0, widget.height() - size.height()));
  return {QPointF(left, top), size};
}

void paintLoupe(QPainter& painter, const QRectF& where, const LoupeContent& content, const vision::Overlay& overlay,
                const Theme& theme,
                const std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)>& shown_of_raw) {
  const QRectF glass(where.topLeft(), QSizeF(where.width(), where.width()));
  const QPointF middle = glass.center();
  const auto toGlass = [&](const Eigen::Vector2d& shown) {
    return middle + QPointF(shown.x() - content.centre.x(), shown.y() - content.centre.y()) * kLoupeMagnification;
  };
  painter.save();
  painter.setClipRect(glass);
  painter.fillRect(glass, QColor(0, 0, 0));
  if (content.picture != nullptr && !content.picture->isNull()) {
    const QPointF corner = toGlass({-0.5, -0.5});
    // Only the part that is seen: drawing the whole picture 8x costs its whole area.
    const QRectF part = QRectF((glass.topLeft() - corner) / kLoupeMagnification, glass.size() / kLoupeMagnification)
                            .toAlignedRect().intersected(content.picture->rect());
    painter.setRenderHint(QPainter::SmoothPixmapTransform, false);
    painter.drawImage(QRectF(corner + part.topLeft() * kLoupeMagnification, part.size() * kLoupeMagnification),
                      *content.picture, part);
  }
  OverlayLook look;
  look.labels = false;
  look.size_factor = 0.8;
  vision::Overlay lines;                       // handles would cover what the loupe is for
  for (const auto& shape : overlay.shapes) {
    if (shape.kind == vision::OverlayShape::Kind::kPolyline) lines.shapes.push_back(shape);
  }
  paintOverlay(painter, lines, theme,
               [&](const Eigen::Vector2d& raw) -> std::optional<QPointF> {
                 const auto shown = shown_of_raw(raw);
                 return shown ? std::optional<QPointF>(toGlass(*shown)) : std::nullopt;
               },
               look);
  for (const auto& [color, width] : {std::pair<QColor, double>{QColor(0, 0, 0, 170), 3}, {QColor(255, 255, 255), 1}}) {
    painter.setPen(QPen(color, width));
    for (const QPointF way : {QPointF(1, 0), QPointF(-1, 0), QPointF(0, 1), QPointF(0, -1)}) {
      painter.drawLine(QLineF(middle + way * 5, middle + way * 30));
    }
  }
  painter.setClipping(false);
  const QRectF text(glass.bottomLeft(), QSizeF(where.width(), where.height() - glass.height()));
  painter.fillRect(text, theme.panel);
  painter.setPen(theme.text);
  painter.drawText(text, Qt::AlignCenter, pixelReadOut(content.raw));
  painter.setBrush(Qt::NoBrush);
  painter.setPen(QPen(theme.border, 1));
  painter.drawRect(where);
  painter.restore();
}

}  // namespace longarm::widgets
