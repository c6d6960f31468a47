#include "ui/zoom_curve.h"

#include <algorithm>
#include <cmath>

#include <QPainter>
#include <QPainterPath>

namespace longarm::ui {

namespace {

constexpr int kLeft = 58, kRight = 14, kTop = 14, kBottom = 30, kSamples = 200;

}  // namespace

ZoomCurve::ZoomCurve(Appearance& appearance, QWidget* parent) : QWidget(parent), m_appearance(appearance) {
  setMinimumHeight(160);
  connect(&appearance, &Appearance::changed, this, qOverload<>(&QWidget::update));
}

void ZoomCurve::setTable(const vision::ZoomCamera& table, double setting) {
  m_table = table;
  m_setting = setting;
  update();
}

void ZoomCurve::paintEvent(QPaintEvent*) {
  const auto& theme = m_appearance.theme();
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.fillRect(rect(), theme.canvas);
  painter.setPen(theme.text);
  if (m_table.nodes.size() < 2) {
    painter.drawText(rect(), Qt::AlignCenter | Qt::TextWordWrap, tr("The focal length over the zoom appears with the second setting."));
    return;
  }
  double low = 1e300, high = 0;
  for (const auto& node : m_table.nodes) {
    low = std::min(low, node.interior[0]);
    high = std::max(high, node.interior[0]);
  }
  if (high <= low) high = low * 1.01;
  const QRectF box(kLeft, kTop, width() - kLeft - kRight, height() - kTop - kBottom);
  const auto place = [&](double zoom, double focal) {
    return QPointF(box.left() + zoom * box.width(), box.bottom() - std::log(focal / low) / std::log(high / low) * box.height());
  };
  painter.setPen(QPen(theme.border, 1));
  painter.drawRect(box);
  painter.setPen(theme.text);
  painter.drawText(QRectF(0, box.bottom() + 6, width(), 20), Qt::AlignHCenter, tr("zoom 0 ... 1"));
  painter.drawText(QRectF(0, box.top() - 4, kLeft - 6, 18), Qt::AlignRight, QString::number(high, 'f', 0));
  painter.drawText(QRectF(0, box.bottom() - 12, kLeft - 6, 18), Qt::AlignRight, QString::number(low, 'f', 0));
  painter.drawText(QRectF(0, box.center().y() - 9, kLeft - 6, 18), Qt::AlignRight, tr("fx px"));
  QPainterPath path;
  for (int i = 0; i <= kSamples; ++i) {
    const auto node = vision::zoomAt(m_table, m_table.nodes.front().zoom + (m_table.nodes.back().zoom - m_table.nodes.front().zoom) * i / kSamples);
    if (!node) continue;
    const QPointF at = place(node->zoom, node->interior[0]);
    if (path.elementCount() == 0) path.moveTo(at);
    else path.lineTo(at);
  }
  painter.setPen(QPen(theme.text, 1.6));
  painter.drawPath(path);
  for (const auto& node : m_table.nodes) {
    painter.setBrush(vision::isNominal(node) ? QBrush(Qt::NoBrush) : QBrush(theme.text));
    painter.drawEllipse(place(node.zoom, node.interior[0]), 4, 4);
  }
  painter.setPen(QPen(theme.selection, 1.5, Qt::DashLine));
  painter.drawLine(QPointF(box.left() + m_setting * box.width(), box.top()), QPointF(box.left() + m_setting * box.width(), box.bottom()));
}

}  // namespace longarm::ui
