#include "ui/stop_keys.h"

#include <utility>

#include <QAbstractSpinBox>
#include <QApplication>
#include <QComboBox>
#include <QKeyEvent>
#include <QLineEdit>
#include <QPlainTextEdit>
#include <QTextEdit>

namespace longarm::ui {

bool takesText(const QWidget* widget) {
  if (widget == nullptr) widget = QApplication::focusWidget();
  const auto* combo = qobject_cast<const QComboBox*>(widget);
  return qobject_cast<const QLineEdit*>(widget) != nullptr || qobject_cast<const QPlainTextEdit*>(widget) != nullptr ||
         qobject_cast<const QTextEdit*>(widget) != nullptr || qobject_cast<const QAbstractSpinBox*>(widget) != nullptr ||
         (combo != nullptr && combo->isEditable());
}

StopKeys::StopKeys(std::function<bool()> armed, QObject* parent) : QObject(parent), m_armed(std::move(armed)) {
  qApp->installEventFilter(this);
}

StopKeys::~StopKeys() { qApp->removeEventFilter(this); }

bool StopKeys::isStop(int key, const QObject* receiver) const {
  if (key == Qt::Key_Pause) return true;
  // Keys come to the window first, and then to the widget that has the focus.
  const auto* widget = qobject_cast<const QWidget*>(receiver);
  return key == Qt::Key_Space && (m_armed() || !takesText(widget));
}

bool StopKeys::eventFilter(QObject* watched, QEvent* event) {
  const bool press = event->type() == QEvent::KeyPress;
  if (!press && event->type() != QEvent::KeyRelease && event->type() != QEvent::ShortcutOverride) {
    return QObject::eventFilter(watched, event);
  }
  auto* key = static_cast<QKeyEvent*>(event);
  if (!isStop(key->key(), watched)) return QObject::eventFilter(watched, event);
  key->accept();
  // A key held down stops once; its release must not press the button that has the focus.
  if (press && !key->isAutoRepeat()) Q_EMIT stopPressed();
  return true;
}

}  // namespace longarm::ui
