#include "widgets/camera_strip.h"

#include <QMouseEvent>
#include <QPainter>
#include <QVBoxLayout>

#include "widgets/image_canvas.h"

namespace longarm::widgets {

CameraTile::CameraTile(const QString& camera, int number, QWidget* parent)
    : QWidget(parent), m_camera(camera), m_number(number) {
  setCursor(Qt::PointingHandCursor);
  setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Preferred);
  setHealth(StatusLamp::Level::kOk, {});
}

void CameraTile::setHealth(StatusLamp::Level level, const QString& words) {
  QString tip = tr("Show %1 live in the left pane (key %2); with Shift or the right button in the right pane").arg(m_camera.toHtmlEscaped()).arg(m_number);
  if (!words.isEmpty()) tip += QStringLiteral("<br>") + words.toHtmlEscaped();
  setToolTip(tip);
  if (level == m_health) return;
  m_health = level;
  update();
}

void CameraTile::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

void CameraTile::setPicture(const QImage& picture) {
  m_picture = picture;
  update();
}

void CameraTile::setAge(std::optional<double> age_s) {
  const auto tenths = [](const std::optional<double>& age) { return age ? static_cast<int>(*age * 10) : -1; };
  const bool changed = tenths(age_s) != tenths(m_age);
  m_age = age_s;
  if (changed) update();
}

void CameraTile::mousePressEvent(QMouseEvent* event) {
  Q_EMIT chosen(m_camera, event->button() == Qt::RightButton || event->modifiers().testFlag(Qt::ShiftModifier));
}

void CameraTile::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const int caption = fontMetrics().height() + 2;
  const QRect frame = rect().adjusted(0, 0, -1, -caption - 1);
  painter.fillRect(frame, m_theme.canvas);
  if (!m_picture.isNull()) {
    const QSize size = m_picture.size().scaled(frame.size(), Qt::KeepAspectRatio);
    const QRect area(frame.center() - QPoint(size.width() / 2, size.height() / 2), size);
    painter.drawImage(area, m_picture);
  } else {
    painter.setPen(m_theme.text);
    painter.drawText(frame, Qt::AlignCenter | Qt::TextWordWrap, tr("no picture yet"));
  }
  const Freshness freshness = m_age ? freshnessOf(*m_age) : Freshness::kFrozen;
  if (freshness == Freshness::kFrozen && !m_picture.isNull()) {
    painter.fillRect(frame, QBrush(QColor(0, 0, 0, 120), Qt::BDiagPattern));
  }
  painter.setPen(m_theme.border);
  painter.drawRect(frame);
  painter.setPen(m_theme.text);
  const QRect line(0, height() - caption, width(), caption);
  painter.drawText(line, Qt::AlignVCenter | Qt::AlignLeft, QStringLiteral("%1 %2").arg(m_number).arg(m_camera));
  const double side = caption - 4;
  painter.setRenderHint(QPainter::Antialiasing);
  StatusLamp::paintShape(painter, {width() - side - 3, line.top() + 2.0, side, side}, m_health, m_theme);
  painter.setRenderHint(QPainter::Antialiasing, false);
  painter.setPen(m_theme.text);
  if (!m_age) return;
  const QString age = freshness == Freshness::kFrozen ? tr("FROZEN %1 s").arg(QString::number(*m_age, 'f', 1))
                                                      : tr("%1 s").arg(QString::number(*m_age, 'f', 1));
  const QRect badge(frame.right() - fontMetrics().horizontalAdvance(age) - 8, frame.top() + 3,
                    fontMetrics().horizontalAdvance(age) + 6, fontMetrics().height());
  painter.fillRect(badge, freshness == Freshness::kFresh  ? m_theme.neutral
                          : freshness == Freshness::kLate ? m_theme.amber
                                                          : m_theme.stop);
  painter.setPen(freshness == Freshness::kFresh  ? m_theme.on_neutral
                 : freshness == Freshness::kLate ? m_theme.on_amber
                                                 : m_theme.on_stop);
  painter.drawText(badge, Qt::AlignCenter, age);
}

CameraStrip::CameraStrip(QWidget* parent) : QWidget(parent) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 4);
  column->setSpacing(4);
}

void CameraStrip::setTheme(const Theme& theme) {
  m_theme = theme;
  for (const auto& [name, each] : m_tiles) each->setTheme(theme);
}

void CameraStrip::setCameras(const std::vector<QString>& cameras) {
  for (const auto& [name, each] : m_tiles) each->deleteLater();
  m_tiles.clear();
  delete layout()->takeAt(0);
  int number = 0;
  for (const auto& camera : cameras) {
    auto* added = new CameraTile(camera, ++number, this);
    added->setTheme(m_theme);
    connect(added, &CameraTile::chosen, this, &CameraStrip::chosen);
    layout()->addWidget(added);
    m_tiles[camera] = added;
  }
}

CameraTile* CameraStrip::tile(const QString& camera) const {
  const auto found = m_tiles.find(camera);
  return found == m_tiles.end() ? nullptr : found->second;
}

}  // namespace longarm::widgets
