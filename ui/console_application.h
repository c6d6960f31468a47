#pragma once

/// @file
/// ConsoleApplication: a QApplication that no exception gets past.


#include <QApplication>

namespace longarm::ui {

/// An exception that leaves a slot would end the program while a robot moves: it is caught and told instead.
class ConsoleApplication final : public QApplication {
  Q_OBJECT

 public:
  ConsoleApplication(int& argc, char** argv) : QApplication(argc, argv) {}
  bool notify(QObject* receiver, QEvent* event) override;

 Q_SIGNALS:
  /// A sentence with what was thrown.
  void caught(const QString& sentence);
};

}  // namespace longarm::ui
