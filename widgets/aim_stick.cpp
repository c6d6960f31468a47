#include "widgets/aim_stick.h"

#include <algorithm>
#include <cmath>

#include <QEvent>
#include <QMouseEvent>
#include <QPainter>

namespace longarm::widgets {

namespace {

constexpr double kDeadZone = 0.1;

double afterDeadZone(double value) {
  const double size = std::abs(value);
  return size < kDeadZone ? 0 : std::copysign((size - kDeadZone) / (1 - kDeadZone), value);
}

}  // namespace

AimStick::AimStick(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Fixed, QSizePolicy::Fixed);
  setCursor(Qt::OpenHandCursor);
}

void AimStick::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

double AimStick::travel() const { return std::min(width(), height()) * 0.34; }

QPointF AimStick::deflection() const { return {afterDeadZone(m_knob.x()), afterDeadZone(-m_knob.y())}; }

void AimStick::moveTo(const QPointF& position) {
  QPointF wanted = (position - QRectF(rect()).center()) / travel();
  const double length = std::hypot(wanted.x(), wanted.y());
  if (length > 1) wanted /= length;
  const QPointF before = deflection();
  m_knob = wanted;
  update();
  if (deflection() != before) Q_EMIT deflected(deflection().x(), deflection().y());
}

void AimStick::release() {
  if (!m_held) return;
  m_held = false;
  m_knob = {0, 0};
  update();
  Q_EMIT deflected(0, 0);
}

void AimStick::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton) return;
  m_held = true;
  moveTo(event->localPos());
}

void AimStick::mouseMoveEvent(QMouseEvent* event) {
  if (m_held) moveTo(event->localPos());
}

void AimStick::mouseReleaseEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) release();
}

void AimStick::hideEvent(QHideEvent* event) {
  QWidget::hideEvent(event);
  release();
}

void AimStick::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::EnabledChange) {
    if (!isEnabled()) release();
    update();
  }
}

void AimStick::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const QPointF centre = QRectF(rect()).center();
  const double outer = std::min(width(), height()) / 2.0 - 2;
  painter.setPen(QPen(m_theme.border, 1.5));
  painter.setBrush(m_theme.window);
  painter.drawEllipse(centre, outer, outer);
  painter.setPen(QPen(isEnabled() ? m_theme.muted : m_theme.border, 2, Qt::SolidLine, Qt::RoundCap, Qt::RoundJoin));
  for (int quarter = 0; quarter < 4; ++quarter) {
    painter.save();
    painter.translate(centre);
    painter.rotate(90.0 * quarter);
    painter.drawPolyline(QVector<QPointF>{{-5, -outer + 11}, {0, -outer + 6}, {5, -outer + 11}});
    painter.restore();
  }
  painter.setPen(QPen(m_theme.border, 1.5));
  painter.setBrush(m_held ? m_theme.selection : isEnabled() ? m_theme.muted : m_theme.raised);
  painter.drawEllipse(centre + m_knob * travel(), outer * 0.34, outer * 0.34);
}

}  // namespace longarm::widgets
