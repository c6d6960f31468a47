#include "ui/simulated_hand.h"

#include <QAbstractButton>
#include <QApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QKeyEvent>
#include <QMouseEvent>
#include <QTimer>

namespace longarm::ui {

namespace {

void send(QWidget* widget, QEvent::Type type, const QPointF& at, Qt::MouseButton button, Qt::MouseButtons buttons,
          Qt::KeyboardModifiers modifiers) {
  const QPointF window = widget->mapTo(widget->window(), at.toPoint()) + (at - at.toPoint());
  const QPointF global = widget->mapToGlobal(at.toPoint()) + (at - at.toPoint());
  QMouseEvent event(type, at, window, global, button, buttons, modifiers);
  QApplication::sendEvent(widget, &event);
}

}  // namespace

void SimulatedHand::pump(int milliseconds) {
  QEventLoop loop;
  QTimer::singleShot(milliseconds, &loop, &QEventLoop::quit);
  loop.exec();
}

bool SimulatedHand::waitFor(const std::function<bool()>& condition, double seconds) {
  QElapsedTimer since;
  since.start();
  while (!condition()) {
    if (since.elapsed() > seconds * 1000) return false;
    pump(10);
  }
  return true;
}

void SimulatedHand::move(QWidget* widget, const QPointF& at, Qt::KeyboardModifiers modifiers) {
  send(widget, QEvent::MouseMove, at, Qt::NoButton, Qt::NoButton, modifiers);
}

void SimulatedHand::press(QWidget* widget, const QPointF& at, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) {
  send(widget, QEvent::MouseButtonPress, at, button, button, modifiers);
}

void SimulatedHand::dragTo(QWidget* widget, const QPointF& at, Qt::KeyboardModifiers modifiers) {
  send(widget, QEvent::MouseMove, at, Qt::NoButton, Qt::LeftButton, modifiers);
}

void SimulatedHand::release(QWidget* widget, const QPointF& at, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) {
  send(widget, QEvent::MouseButtonRelease, at, button, Qt::NoButton, modifiers);
  if (m_pause_ms > 0) pump(m_pause_ms);
}

void SimulatedHand::click(QWidget* widget, const QPointF& at, Qt::MouseButton button, Qt::KeyboardModifiers modifiers) {
  press(widget, at, button, modifiers);
  release(widget, at, button, modifiers);
}

void SimulatedHand::click(QAbstractButton* button) { click(button, QRectF(button->rect()).center()); }

void SimulatedHand::doubleClick(QWidget* widget, const QPointF& at) {
  click(widget, at);
  send(widget, QEvent::MouseButtonDblClick, at, Qt::LeftButton, Qt::LeftButton, {});
  release(widget, at);
}

void SimulatedHand::drag(QWidget* widget, const QPointF& from, const QPointF& to, Qt::KeyboardModifiers modifiers, int steps) {
  move(widget, from, modifiers);
  press(widget, from, Qt::LeftButton, modifiers);
  for (int i = 1; i <= steps; ++i) {
    dragTo(widget, from + (to - from) * i / steps, modifiers);
    if (m_pause_ms > 0) pump(std::max(1, m_pause_ms / steps));
  }
  release(widget, to, Qt::LeftButton, modifiers);
}

bool SimulatedHand::hold(QAbstractButton* button, const std::function<bool()>& until, double seconds) {
  const QPointF middle = QRectF(button->rect()).center();
  press(button, middle);
  const bool done = waitFor(until, seconds);
  release(button, middle);
  return done;
}

void SimulatedHand::key(QWidget* widget, int key, Qt::KeyboardModifiers modifiers, const QString& text) {
  QKeyEvent down(QEvent::KeyPress, key, modifiers, text);
  QApplication::sendEvent(widget, &down);
  QKeyEvent up(QEvent::KeyRelease, key, modifiers, text);
  QApplication::sendEvent(widget, &up);
  if (m_pause_ms > 0) pump(m_pause_ms);
}

}  // namespace longarm::ui
