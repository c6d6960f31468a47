#include "widgets/status_lamp.h"

#include <algorithm>

#include <QMouseEvent>
#include <QPainter>

namespace longarm::widgets {

namespace {

constexpr double kShape = 14;
constexpr double kGap = 6;

}  // namespace

StatusLamp::StatusLamp(QWidget* parent) : QWidget(parent) { setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Preferred); }

void StatusLamp::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

void StatusLamp::setStatus(Level level, const QString& text, const QString& detail) {
  if (detail != toolTip()) setToolTip(detail.toHtmlEscaped());
  if (level == m_level && text == m_text) return;
  const QSize before = sizeHint();
  m_level = level;
  m_text = text;
  if (sizeHint() != before) updateGeometry();
  update();
}

void StatusLamp::setReserve(const QString& widest) {
  m_reserve = widest;
  updateGeometry();
}

QSize StatusLamp::sizeHint() const {
  const int text = std::max(fontMetrics().horizontalAdvance(m_text), fontMetrics().horizontalAdvance(m_reserve));
  return {static_cast<int>(kShape + kGap) + text + 4, std::max(20, fontMetrics().height() + 4)};
}

void StatusLamp::mouseReleaseEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton && rect().contains(event->pos())) Q_EMIT clicked();
}

void StatusLamp::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  paintShape(painter, {1, (height() - kShape) / 2, kShape, kShape}, m_level, m_theme);
  painter.setPen(m_theme.text);
  painter.drawText(QRectF(kShape + kGap, 0, width() - kShape - kGap, height()), Qt::AlignVCenter | Qt::AlignLeft, m_text);
}

void StatusLamp::paintShape(QPainter& painter, const QRectF& shape, Level level, const Theme& theme) {
  painter.setPen(Qt::NoPen);
  switch (level) {
    case Level::kOk:
      painter.setBrush(theme.muted);
      painter.drawEllipse(shape.adjusted(2, 2, -2, -2));
      break;
    case Level::kBusy:
      painter.setPen(QPen(theme.role(vision::OverlayRole::kSelected).color, 3));
      painter.drawEllipse(shape.adjusted(2, 2, -2, -2));
      break;
    case Level::kDegraded: {
      painter.setBrush(theme.amber);
      painter.drawPolygon(QVector<QPointF>{{shape.center().x(), shape.top()}, shape.bottomRight(), shape.bottomLeft()});
      break;
    }
    case Level::kLost:
      painter.setPen(QPen(theme.magenta, 3, Qt::SolidLine, Qt::RoundCap));
      painter.drawLine(shape.adjusted(2, 2, -2, -2).topLeft(), shape.adjusted(2, 2, -2, -2).bottomRight());
      painter.drawLine(shape.adjusted(2, 2, -2, -2).topRight(), shape.adjusted(2, 2, -2, -2).bottomLeft());
      break;
    case Level::kFault:
      painter.setBrush(theme.stop);
      painter.setPen(QPen(theme.on_stop, 1));
      painter.drawRect(shape.adjusted(1, 1, -1, -1));
      break;
  }
}

}  // namespace longarm::widgets
