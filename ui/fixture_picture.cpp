#include "ui/fixture_picture.h"

#include <algorithm>
#include <cmath>

#include <QApplication>
#include <QMouseEvent>
#include <QPainter>

namespace longarm::ui {

namespace {

constexpr double kTurnPerPixel = 0.01;     // [rad]
constexpr double kReach = 14;              // of a click [px]

}  // namespace

FixturePicture::FixturePicture(Appearance& appearance, QWidget* parent) : QWidget(parent), m_appearance(appearance) {
  setMinimumHeight(130);
  setToolTip(tr("The fixture in 3-D: drag turns it, a click chooses a point"));
  connect(&appearance, &Appearance::changed, this, qOverload<>(&QWidget::update));
}

void FixturePicture::setFixture(const calibration::Fixture& fixture) {
  m_fixture = fixture;
  Eigen::Vector3d low = fixture.points.front().xyz, high = low;
  for (const auto& point : fixture.points) {
    low = low.cwiseMin(point.xyz);
    high = high.cwiseMax(point.xyz);
  }
  m_middle = (low + high) / 2;
  m_radius = std::max(1e-6, (high - low).norm() / 2);
  update();
}

void FixturePicture::setMarks(int chosen, const std::set<std::size_t>& placed) {
  m_chosen = chosen;
  m_placed = placed;
  update();
}

// x to the right, y down as in pictures, z away: turned about y, then about the screen's x.
QPointF FixturePicture::placeOf(std::size_t point) const {
  const Eigen::Vector3d p = expSO3({m_tilt, 0, 0}) * expSO3({0, -m_turn, 0}) * (m_fixture.points[point].xyz - m_middle);
  const double scale = 0.46 * std::min(width(), height()) / m_radius;
  return {width() / 2.0 + scale * p.x(), height() / 2.0 + scale * p.y()};
}

void FixturePicture::paintEvent(QPaintEvent*) {
  const auto& theme = m_appearance.theme();
  QPainter painter(this);
  painter.fillRect(rect(), theme.canvas);
  painter.setRenderHint(QPainter::Antialiasing);
  if (m_fixture.points.empty()) {
    painter.setPen(theme.text);
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, tr("No fixture yet."));
    return;
  }
  for (std::size_t i = 0; i < m_fixture.points.size(); ++i) {
    const bool placed = m_placed.count(i) != 0;
    painter.setPen(QPen(theme.text, 1.2));
    painter.setBrush(placed ? QBrush(theme.text) : QBrush(Qt::NoBrush));
    painter.drawEllipse(placeOf(i), 3, 3);
  }
  if (m_chosen < 0 || m_chosen >= static_cast<int>(m_fixture.points.size())) return;
  const auto chosen = static_cast<std::size_t>(m_chosen);
  painter.setPen(QPen(theme.selection, 3));
  painter.setBrush(Qt::NoBrush);
  painter.drawEllipse(placeOf(chosen), 8, 8);
  painter.setPen(theme.text);
  painter.drawText(placeOf(chosen) + QPointF(11, -6), QString::fromStdString(m_fixture.points[chosen].name));
}

void FixturePicture::mousePressEvent(QMouseEvent* event) { m_press = m_last = event->pos(); }

void FixturePicture::mouseMoveEvent(QMouseEvent* event) {
  const QPoint step = event->pos() - m_last;
  m_last = event->pos();
  m_turn += kTurnPerPixel * step.x();
  m_tilt = std::clamp(m_tilt - kTurnPerPixel * step.y(), -1.5, 1.5);
  update();
}

void FixturePicture::mouseReleaseEvent(QMouseEvent* event) {
  if ((event->pos() - m_press).manhattanLength() >= QApplication::startDragDistance()) return;
  int best = -1;
  double nearest = kReach;
  for (std::size_t i = 0; i < m_fixture.points.size(); ++i) {
    const QPointF off = placeOf(i) - QPointF(event->pos());
    if (std::hypot(off.x(), off.y()) >= nearest) continue;
    nearest = std::hypot(off.x(), off.y());
    best = static_cast<int>(i);
  }
  if (best >= 0) Q_EMIT chosen(best);
}

}  // namespace longarm::ui
