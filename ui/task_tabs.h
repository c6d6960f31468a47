#pragma once

/// @file
/// TaskTabs: which of the tasks the window serves.

#include <QTabBar>

#include "ui/actions.h"

namespace longarm::ui {

enum class Task { kTarget, kCalibrate };

/// One tab per task that is built; each is an action too.  GUI thread only.
class TaskTabs final : public QTabBar {
  Q_OBJECT

 public:
  explicit TaskTabs(Actions& actions, QWidget* parent = nullptr);
  Task task() const { return static_cast<Task>(currentIndex()); }
  void setTask(Task task) { setCurrentIndex(static_cast<int>(task)); }

 Q_SIGNALS:
  void taskChanged(longarm::ui::Task task);
};

}  // namespace longarm::ui
