#pragma once

/// @file
/// HoldButton: acts only after it was held down for a while.

#include <QElapsedTimer>
#include <QPushButton>
#include <QTimer>

#include "widgets/theme.h"

namespace longarm::widgets {

/// A push button that fills while it is held and emits held() when it is full.  clicked() means nothing here.
class HoldButton final : public QPushButton {
  Q_OBJECT

 public:
  explicit HoldButton(const QString& text, int hold_ms, QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  /// 0 ... 1 of the hold time.
  double filled() const;

 Q_SIGNALS:
  void held();

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  void begin();
  void end();
  void tick();

  int m_hold_ms;
  Theme m_theme = Theme::dark();
  QElapsedTimer m_since;
  QTimer m_timer;
};

}  // namespace longarm::widgets
