#pragma once

/// @file
/// SimulatedHand: a mouse and a keyboard that no person holds, for the demonstration and for tests.

#include <functional>

#include <QPointF>
#include <Qt>

class QAbstractButton;
class QWidget;

namespace longarm::ui {

/// Sends ordinary Qt events, so that the window cannot tell the difference.  GUI thread only.
class SimulatedHand final {
 public:
  /// @param pause_ms Rest after each act, during which the event loop runs; 0: none.
  explicit SimulatedHand(int pause_ms = 0) : m_pause_ms(pause_ms) {}

  void move(QWidget* widget, const QPointF& at, Qt::KeyboardModifiers modifiers = {});
  void press(QWidget* widget, const QPointF& at, Qt::MouseButton button = Qt::LeftButton, Qt::KeyboardModifiers modifiers = {});
  /// Moves with the left button held.
  void dragTo(QWidget* widget, const QPointF& at, Qt::KeyboardModifiers modifiers = {});
  void release(QWidget* widget, const QPointF& at, Qt::MouseButton button = Qt::LeftButton, Qt::KeyboardModifiers modifiers = {});
  void click(QWidget* widget, const QPointF& at, Qt::MouseButton button = Qt::LeftButton, Qt::KeyboardModifiers modifiers = {});
  void click(QAbstractButton* button);
  void doubleClick(QWidget* widget, const QPointF& at);
  /// Presses at `from`, moves in `steps` and lets go at `to`.
  void drag(QWidget* widget, const QPointF& from, const QPointF& to, Qt::KeyboardModifiers modifiers = {}, int steps = 12);
  /// Presses a button until `until` holds, at most `seconds`.  @returns whether it did.
  bool hold(QAbstractButton* button, const std::function<bool()>& until, double seconds);
  /// A key to this widget; shortcuts do not see it (use QTest::keyClick for those).
  void key(QWidget* widget, int key, Qt::KeyboardModifiers modifiers = {}, const QString& text = {});

  /// Lets the event loop run until `condition` holds.  @returns whether it did within `seconds`.
  static bool waitFor(const std::function<bool()>& condition, double seconds);
  static void pump(int milliseconds);

 private:
  int m_pause_ms;
};

}  // namespace longarm::ui
