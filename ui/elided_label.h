#pragma once

/// @file
/// ElidedLabel: one line of plain text that takes the room there is.

#include <QLabel>

namespace longarm::ui {

/// Shows "..." where the text does not fit, and then the whole text as tooltip.  GUI thread only.
class ElidedLabel final : public QLabel {
  Q_OBJECT

 public:
  explicit ElidedLabel(QWidget* parent = nullptr, Qt::TextElideMode mode = Qt::ElideRight);
  void setFullText(const QString& text);
  QString fullText() const { return m_text; }
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 protected:
  void resizeEvent(QResizeEvent* event) override;

 private:
  void elide();

  Qt::TextElideMode m_mode;
  QString m_text;
};

}  // namespace longarm::ui
