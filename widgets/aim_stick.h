#pragma once

/// @file
/// AimStick: an on-screen stick that gives a rate while it is held.

#include <QPointF>
#include <QWidget>

#include "widgets/theme.h"

namespace longarm::widgets {

/// Right and up are positive, each -1 ... 1, with a dead zone of 10 %.  Springs back when let go, when the widget
/// is hidden or disabled: deflection() is then (0, 0) and deflected(0, 0) has been emitted.
class AimStick final : public QWidget {
  Q_OBJECT

 public:
  explicit AimStick(QWidget* parent = nullptr);
  void setTheme(const Theme& theme);
  QPointF deflection() const;
  QSize sizeHint() const override { return {96, 96}; }
  QSize minimumSizeHint() const override { return {80, 80}; }

 Q_SIGNALS:
  void deflected(double right, double up);

 protected:
  void paintEvent(QPaintEvent* event) override;
  void mousePressEvent(QMouseEvent* event) override;
  void mouseMoveEvent(QMouseEvent* event) override;
  void mouseReleaseEvent(QMouseEvent* event) override;
  void hideEvent(QHideEvent* event) override;
  void changeEvent(QEvent* event) override;

 private:
  void moveTo(const QPointF& position);
  void release();
  double travel() const;

  Theme m_theme = Theme::dark();
  QPointF m_knob{0, 0};                  // -1 ... 1, y down
  bool m_held = false;
};

}  // namespace longarm::widgets
