#pragma once

/// @file
/// StopButton: the one red octagon of the window.

#include <QWidget>

#include "widgets/theme.h"

namespace longarm::widgets {

/// One press, no confirmation; acts on press, not on release.  It is a soft stop and says STOP, not E-STOP: the
/// robot's own emergency stop is another thing.  Never disabled: pressing while stopped stops again.
class StopButton final : public QWidget {
  Q_OBJECT

 public:
  enum class State { kReady, kRequested, kConfirmed };

  explicit StopButton(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  /// Requested: latched, the robot may still be slowing down.  Confirmed: latched and measured at rest.
  void setState(State state);
  State state() const { return m_state; }
  QSize sizeHint() const override { return {112, 112}; }
  QSize minimumSizeHint() const override { return {96, 96}; }

 Q_SIGNALS:
  void stopPressed();

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseDoubleClickEvent(QMouseEvent* event) override;

 private:
  Theme m_theme = Theme::dark();
  State m_state = State::kReady;
};

}  // namespace longarm::widgets
