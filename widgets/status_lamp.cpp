#include "widgets/status_lamp.h"

#include <algorithm>

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

void StatusLamp::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const QRectF shape(1, (height() - kShape) / 2, kShape, kShape);
  painter.setPen(Qt::NoPen);
  switch (m_level) {
    case Level::kOk:
      painter.setBrush(m_theme.muted);
      painter.drawEllipse(shape.adjusted(2, 2, -2, -2));
      break;
    case Level::kBusy:
      painter.setPen(QPen(m_theme.role(vision::OverlayRole::kSelected).color, 3));
      painter.drawEllipse(shape.adjusted(2, 2, -2, -2));
      break;
    case Level::kDegraded: {
      painter.setBrush(m_theme.amber);
      painter.drawPolygon(QVector<QPointF>{{shape.center().x(), shape.top()}, shape.bottomRight(), shape.bottomLeft()});
      break;
    }
    case Level::kLost:
      painter.setPen(QPen(m_theme.magenta, 3, Qt::SolidLine, Qt::RoundCap));
      painter.drawLine(shape.adjusted(2, 2, -2, -2).topLeft(), shape.adjusted(2, 2, -2, -2).bottomRight());
      painter.drawLine(shape.adjusted(2, 2, -2, -2).topRight(), shape.adjusted(2, 2, -2, -2).bottomLeft());
      break;
    case Level::kFault:
      painter.setBrush(m_theme.stop);
      painter.setPen(QPen(m_theme.on_stop, 1));
      painter.drawRect(shape.adjusted(1, 1, -1, -1));
      break;
  }
  painter.setPen(m_theme.text);
  painter.drawText(QRectF(kShape + kGap, 0, width() - kShape - kGap, height()), Qt::AlignVCenter | Qt::AlignLeft, m_text);
}

}  // namespace longarm::widgets
