#include "ui/console_application.h"

#include <cstdio>
#include <exception>

namespace longarm::ui {

bool ConsoleApplication::notify(QObject* receiver, QEvent* event) {
  QString what;
  try {
    return QApplication::notify(receiver, event);
  } catch (const std::exception& problem) {
    what = QString::fromLocal8Bit(problem.what());
  } catch (...) {
    what = tr("something unknown");
  }
  const QString sentence = tr("A part of the window failed and went on: %1").arg(what);
  std::fprintf(stderr, "longarm: %s\n", qPrintable(sentence));
  Q_EMIT caught(sentence);
  return true;
}

}  // namespace longarm::ui
