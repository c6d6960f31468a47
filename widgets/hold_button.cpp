#include "widgets/hold_button.h"

#include <algorithm>

#include <QPainter>

namespace longarm::widgets {

HoldButton::HoldButton(const QString& text, int hold_ms, QWidget* parent) : QPushButton(text, parent), m_hold_ms(hold_ms) {
  m_timer.setInterval(30);
  connect(this, &QPushButton::pressed, this, &HoldButton::begin);
  connect(this, &QPushButton::released, this, &HoldButton::end);
  connect(&m_timer, &QTimer::timeout, this, &HoldButton::tick);
}

void HoldButton::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

double HoldButton::filled() const {
  return m_since.isValid() ? std::min(1.0, static_cast<double>(m_since.elapsed()) / m_hold_ms) : 0;
}

void HoldButton::begin() {
  m_since.start();
  m_timer.start();
}

void HoldButton::end() {
  m_since.invalidate();
  m_timer.stop();
  update();
}

void HoldButton::tick() {
  const bool full = filled() >= 1;
  if (full) end();
  update();
  if (full) Q_EMIT held();
}

void HoldButton::paintEvent(QPaintEvent* event) {
  QPushButton::paintEvent(event);
  if (filled() <= 0) return;
  QPainter painter(this);
  QColor fill = m_theme.selection;
  fill.setAlpha(150);
  painter.fillRect(QRectF(0, height() - 6, width() * filled(), 6), fill);
}

}  // namespace longarm::widgets
