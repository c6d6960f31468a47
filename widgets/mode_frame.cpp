#include "widgets/mode_frame.h"

#include <QPainter>
#include <QVBoxLayout>

namespace longarm::widgets {

ModeFrame::ModeFrame(QWidget* parent) : QWidget(parent) {
  setObjectName(QStringLiteral("frame"));
  m_content = new QVBoxLayout(this);
  m_content->setContentsMargins(kWidth, kWidth, kWidth, kWidth);
  m_content->setSpacing(0);
}

void ModeFrame::setTheme(const Theme& theme) {
  m_theme = theme;
  update();
}

void ModeFrame::setMode(ModeLook mode) {
  if (mode == m_mode) return;
  m_mode = mode;
  update();
}

void ModeFrame::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.fillRect(rect(), m_theme.window);
  QRegion border(rect());
  border -= rect().adjusted(kWidth, kWidth, -kWidth, -kWidth);
  painter.setClipRegion(border);
  switch (m_mode) {
    case ModeLook::kLive: painter.fillRect(rect(), m_theme.neutral); break;
    case ModeLook::kVirtual: {
      painter.fillRect(rect(), QColor(0x10, 0x10, 0x10));
      painter.setRenderHint(QPainter::Antialiasing);
      painter.setPen(QPen(m_theme.role(vision::OverlayRole::kSelected).color, 7));
      for (int x = -height(); x < width() + height(); x += 20) painter.drawLine(x, height(), x + height(), 0);
      break;
    }
    case ModeLook::kReplay:
      painter.fillRect(rect(), m_theme.border);
      painter.fillRect(rect(), QBrush(m_theme.text, Qt::Dense5Pattern));
      break;
  }
}

}  // namespace longarm::widgets
