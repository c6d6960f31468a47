#include "widgets/stop_button.h"

#include <algorithm>
#include <cmath>

#include <QMouseEvent>
#include <QPainter>

namespace longarm::widgets {

namespace {

QPolygonF octagon(const QPointF& centre, double radius) {
  QPolygonF polygon;
  for (int i = 0; i < 8; ++i) {
    const double angle = (i + 0.5) * M_PI / 4;
    polygon << centre + QPointF(radius * std::cos(angle), radius * std::sin(angle));
  }
  return polygon;
}

}  // namespace

StopButton::StopButton(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
  setCursor(Qt::PointingHandCursor);
  setAccessibleName(tr("Stop"));
  setToolTip(tr("STOP the robot now (Space, Pause).\nIt brakes at its stop deceleration and stays stopped until you reset.\n"
                "This is not the robot's own emergency stop."));
}

void StopButton::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

void StopButton::setState(State state) {
  if (state == m_state) return;
  m_state = state;
  update();
}

void StopButton::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const double radius = std::min(width(), height()) / 2.0 / std::cos(M_PI / 8) - 3;
  const QPointF centre = QRectF(rect()).center();
  painter.setPen(QPen(m_theme.on_stop, 3));
  painter.setBrush(m_theme.stop);
  painter.drawPolygon(octagon(centre, radius));
  if (m_state != State::kReady) {
    painter.setPen(Qt::NoPen);
    painter.setBrush(QBrush(QColor(0, 0, 0, 120), Qt::BDiagPattern));
    painter.drawPolygon(octagon(centre, radius - 2));
  }
  const QRectF box(centre.x() - radius, centre.y() - radius, 2 * radius, 2 * radius);
  QFont font = painter.font();
  font.setBold(true);
  font.setPixelSize(static_cast<int>(radius * (m_state == State::kReady ? 0.52 : 0.34)));
  painter.setFont(font);
  painter.setPen(m_theme.on_stop);
  const QString words = m_state == State::kReady       ? QStringLiteral("STOP")
                        : m_state == State::kRequested ? QStringLiteral("STOPPING")
                                                       : QStringLiteral("STOPPED");
  painter.drawText(box.translated(0, -radius * 0.1), Qt::AlignCenter, words);
  font.setPixelSize(std::max(10, static_cast<int>(radius * 0.22)));
  painter.setFont(font);
  painter.drawText(box.translated(0, radius * 0.42), Qt::AlignCenter, tr("Space"));
}

void StopButton::mousePressEvent(QMouseEvent*) { Q_EMIT stopPressed(); }

void StopButton::mouseDoubleClickEvent(QMouseEvent*) { Q_EMIT stopPressed(); }

}  // namespace longarm::widgets
