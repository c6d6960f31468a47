#include "ui/elided_label.h"

namespace longarm::ui {

namespace {

constexpr int kLeastWidth = 20;

}  // namespace

ElidedLabel::ElidedLabel(QWidget* parent, Qt::TextElideMode mode) : QLabel(parent), m_mode(mode) {
  setTextFormat(Qt::PlainText);
  setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);
}

void ElidedLabel::setFullText(const QString& text) {
  if (text == m_text) return;
  m_text = text;
  updateGeometry();
  elide();
}

QSize ElidedLabel::sizeHint() const { return {fontMetrics().horizontalAdvance(m_text) + 4, fontMetrics().height() + 2}; }
QSize ElidedLabel::minimumSizeHint() const { return {kLeastWidth, fontMetrics().height() + 2}; }

void ElidedLabel::resizeEvent(QResizeEvent* event) {
  QLabel::resizeEvent(event);
  elide();
}

void ElidedLabel::elide() {
  const QString shown = fontMetrics().elidedText(m_text, m_mode, width());
  if (shown != text()) setText(shown);
  const QString tip = shown == m_text ? QString() : m_text.toHtmlEscaped();
  if (tip != toolTip()) setToolTip(tip);
}

}  // namespace longarm::ui
