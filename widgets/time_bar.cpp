#include "widgets/time_bar.h"

#include <algorithm>
#include <utility>

#include <QMouseEvent>
#include <QPainter>

namespace longarm::widgets {

namespace {

constexpr double kMargin = 9;
constexpr double kBarTop = 4, kBarHeight = 22;

}  // namespace

TimeBar::TimeBar(QWidget* parent) : QWidget(parent) {
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

void TimeBar::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

void TimeBar::setStages(std::vector<TimeStage> stages, double duration_s) {
  m_stages = std::move(stages);
  m_duration = std::max(0.0, duration_s);
  m_cursor = std::clamp(m_cursor, 0.0, m_duration);
  update();
}

void TimeBar::setCursorTime(double t_s) {
  const double next = std::clamp(t_s, 0.0, m_duration);
  if (next == m_cursor) return;
  m_cursor = next;
  update();
}

void TimeBar::setScrubbable(bool on) {
  m_scrubbable = on && m_duration > 0;
  setCursor(m_scrubbable ? Qt::SizeHorCursor : Qt::ArrowCursor);
}

double TimeBar::xOf(double t_s) const {
  return m_duration > 0 ? kMargin + (width() - 2 * kMargin) * t_s / m_duration : kMargin;
}

void TimeBar::scrubTo(double x) {
  if (!m_scrubbable || m_duration <= 0 || width() <= 2 * kMargin) return;
  const double t = std::clamp((x - kMargin) / (width() - 2 * kMargin), 0.0, 1.0) * m_duration;
  setCursorTime(t);
  Q_EMIT scrubbed(t);
}

void TimeBar::mousePressEvent(QMouseEvent* event) {
  if (event->button() == Qt::LeftButton) scrubTo(event->localPos().x());
}

void TimeBar::mouseMoveEvent(QMouseEvent* event) {
  if (event->buttons().testFlag(Qt::LeftButton)) scrubTo(event->localPos().x());
}

void TimeBar::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const QRectF bar(kMargin, kBarTop, width() - 2 * kMargin, kBarHeight);
  painter.setPen(QPen(m_theme.border, 1));
  painter.setBrush(m_theme.window);
  painter.drawRect(bar);
  if (m_duration <= 0) {
    painter.setPen(m_theme.muted);
    painter.drawText(bar, Qt::AlignCenter, tr("No motion planned"));
    return;
  }
  bool shaded = false;
  for (const auto& stage : m_stages) {
    const QRectF part(xOf(stage.start_s), kBarTop, std::max(1.0, xOf(stage.end_s) - xOf(stage.start_s)), kBarHeight);
    painter.setPen(QPen(m_theme.border, 1));
    painter.setBrush(shaded ? m_theme.raised : m_theme.neutral);
    painter.drawRect(part);
    painter.setPen(shaded ? m_theme.text : m_theme.on_neutral);
    if (part.width() > 30) {
      painter.drawText(part.adjusted(4, 0, -4, 0), Qt::AlignCenter,
                       painter.fontMetrics().elidedText(stage.name, Qt::ElideRight, static_cast<int>(part.width()) - 8));
    }
    shaded = !shaded;
  }
  const double x = xOf(m_cursor);
  painter.fillRect(QRectF(kMargin, kBarTop + kBarHeight - 5, x - kMargin, 5), m_theme.selection);
  painter.setPen(QPen(m_theme.text, 2));
  painter.setBrush(m_theme.text);
  painter.drawLine(QPointF(x, kBarTop - 2), QPointF(x, kBarTop + kBarHeight + 2));
  painter.drawPolygon(QVector<QPointF>{{x - 5, kBarTop + kBarHeight + 8}, {x + 5, kBarTop + kBarHeight + 8}, {x, kBarTop + kBarHeight + 1}});
  painter.setPen(m_theme.muted);
  const QRectF under(kMargin, kBarTop + kBarHeight + 2, bar.width(), height() - kBarTop - kBarHeight - 2);
  painter.drawText(under, Qt::AlignRight | Qt::AlignTop, tr("%1 s").arg(QString::number(m_duration, 'f', 1)));
  const QString now = tr("%1 s").arg(QString::number(m_cursor, 'f', 1));
  const double left = std::clamp(x + 9, kMargin, std::max(kMargin, width() - kMargin - 90.0));
  painter.setPen(m_theme.text);
  painter.drawText(QRectF(left, under.top(), 60, under.height()), Qt::AlignLeft | Qt::AlignTop, now);
}

}  // namespace longarm::widgets
