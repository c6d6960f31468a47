#pragma once

/// @file
/// StatusLamp: one state by shape, colour and words.

#include <QWidget>

#include "widgets/theme.h"

namespace longarm::widgets {

/// Ok: grey disc; busy: blue ring; degraded: amber triangle; lost: magenta cross; fault: red square.
class StatusLamp final : public QWidget {
  Q_OBJECT

 public:
  enum class Level { kOk, kBusy, kDegraded, kLost, kFault };

  explicit StatusLamp(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  /// `text` beside the shape, plain; `detail` as tooltip.
  void setStatus(Level level, const QString& text, const QString& detail = {});
  Level level() const { return m_level; }
  QString text() const { return m_text; }
  /// Keeps this much room for text whatever it says, so that the strip does not jump.
  void setReserve(const QString& widest);
  /// The shape alone, filling a square.
  static void paintShape(QPainter& painter, const QRectF& square, Level level, const Theme& theme);
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return sizeHint(); }

 Q_SIGNALS:
  void clicked();                          ///< For those that lead somewhere.

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;

 private:
  Theme m_theme = Theme::dark();
  Level m_level = Level::kOk;
  QString m_text, m_reserve;
};

}  // namespace longarm::widgets
