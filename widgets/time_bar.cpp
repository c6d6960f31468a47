#include "widgets/time_bar.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <QHelpEvent>
#include <QMouseEvent>
#include <QPainter>
#include <QToolTip>

namespace longarm::widgets {

namespace {

constexpr double kMargin = 9;
constexpr double kStripTop = 2, kStripHeight = 11;         // of clearance
constexpr double kBarTop = 16, kBarHeight = 22;
constexpr double kLeastHeight = 2;                         // so that touching shows too

}  // namespace

QString clearanceText(double metres) {
  if (metres >= planning::kClearanceTold) return TimeBar::tr("%1 mm or more").arg(std::lround(planning::kClearanceTold * 1000));
  return TimeBar::tr("%1 mm").arg(static_cast<int>(std::floor(metres * 1000 + 1e-9)));
}

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

void TimeBar::setClearance(planning::ClearanceProfile clearance) {
  m_clearance = std::move(clearance);
  update();
}

QString TimeBar::textAt(double t_s) const {
  if (m_duration <= 0) return {};
  QString text = tr("%1 s").arg(QString::number(t_s, 'f', 1));
  for (const auto& stage : m_stages) {
    if (t_s < stage.start_s || t_s > stage.end_s) continue;
    text += tr(", %1").arg(stage.name);
    if (!stage.then.isEmpty()) text += tr(" (then %1)").arg(stage.then);
    break;
  }
  if (!m_clearance.empty()) text += tr(": clearance %1").arg(clearanceText(planning::clearanceAt(m_clearance, t_s)));
  return text;
}

bool TimeBar::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip || m_duration <= 0) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  QToolTip::showText(help->globalPos(), textAt(timeOf(help->pos().x())).toHtmlEscaped(), this);
  return true;
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

double TimeBar::timeOf(double x) const {
  return width() > 2 * kMargin ? std::clamp((x - kMargin) / (width() - 2 * kMargin), 0.0, 1.0) * m_duration : 0;
}

void TimeBar::scrubTo(double x) {
  if (!m_scrubbable || m_duration <= 0 || width() <= 2 * kMargin) return;
  const double t = timeOf(x);
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
  paintClearance(painter);
  paintStages(painter);
  paintCursor(painter);
}

// Columns of a pixel, their height and colour by the least that was seen within them.
void TimeBar::paintClearance(QPainter& painter) const {
  if (m_clearance.empty()) return;
  painter.setRenderHint(QPainter::Antialiasing, false);
  for (int x = static_cast<int>(kMargin); x < width() - kMargin; ++x) {
    const double from = timeOf(x), to = timeOf(x + 1);
    double least = std::min(planning::clearanceAt(m_clearance, from), planning::clearanceAt(m_clearance, to));
    for (auto sample = std::lower_bound(m_clearance.begin(), m_clearance.end(), from, [](const auto& s, double t) { return s.t_s < t; });
         sample != m_clearance.end() && sample->t_s <= to; ++sample) {
      least = std::min(least, sample->distance);
    }
    const double share = std::min(1.0, least / planning::kClearanceTold), height = kLeastHeight + (kStripHeight - kLeastHeight) * share;
    painter.fillRect(QRectF(x, kStripTop + kStripHeight - height, 1, height), clearanceColour(planning::bandOf(least)));
  }
  painter.setRenderHint(QPainter::Antialiasing);
  const auto& tightest = planning::leastClearance(m_clearance);
  const QString text = tr("least %1").arg(clearanceText(tightest.distance));
  const double x = xOf(tightest.t_s), room = painter.fontMetrics().horizontalAdvance(text) + 4;
  painter.setPen(QPen(m_theme.text, 1));
  painter.drawLine(QPointF(x, kStripTop - 1), QPointF(x, kBarTop));
  const double left = std::clamp(m_cursor < m_duration / 2 ? width() - kMargin - room - 60 : kMargin, kMargin, std::max(kMargin, width() - kMargin - room));
  painter.drawText(QRectF(left, kBarTop + kBarHeight + 2, room, height() - kBarTop - kBarHeight - 2), Qt::AlignLeft | Qt::AlignTop, text);
}

void TimeBar::paintStages(QPainter& painter) const {
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
  // Where the arm waits for the gripper.
  painter.setPen(QPen(m_theme.window, 1));
  painter.setBrush(m_theme.text);
  for (const auto& stage : m_stages) {
    if (!stage.then.isEmpty()) painter.drawEllipse(QPointF(xOf(stage.end_s), kBarTop + kBarHeight / 2), 4, 4);
  }
}

void TimeBar::paintCursor(QPainter& painter) const {
  const double x = xOf(m_cursor);
  painter.fillRect(QRectF(kMargin, kBarTop + kBarHeight - 5, x - kMargin, 5), m_theme.selection);
  painter.setPen(QPen(m_theme.text, 2));
  painter.setBrush(m_theme.text);
  painter.drawLine(QPointF(x, kBarTop - 2), QPointF(x, kBarTop + kBarHeight + 2));
  painter.drawPolygon(QVector<QPointF>{{x - 5, kBarTop + kBarHeight + 8}, {x + 5, kBarTop + kBarHeight + 8}, {x, kBarTop + kBarHeight + 1}});
  painter.setPen(m_theme.muted);
  const QRectF under(kMargin, kBarTop + kBarHeight + 2, width() - 2 * kMargin, height() - kBarTop - kBarHeight - 2);
  painter.drawText(under, Qt::AlignRight | Qt::AlignTop, tr("%1 s").arg(QString::number(m_duration, 'f', 1)));
  const QString now = tr("%1 s").arg(QString::number(m_cursor, 'f', 1));
  const double left = std::clamp(x + 9, kMargin, std::max(kMargin, width() - kMargin - 90.0));
  painter.setPen(m_theme.text);
  painter.drawText(QRectF(left, under.top(), 60, under.height()), Qt::AlignLeft | Qt::AlignTop, now);
}

}  // namespace longarm::widgets
