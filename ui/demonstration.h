#pragma once

/// @file
/// Demonstration: does the scenario's task in the real window with a simulated mouse, and takes pictures of it.

#include <string>

#include <QString>

#include "core/result.h"
#include "ui/main_window.h"
#include "ui/simulated_operator.h"

namespace longarm::ui {

struct DemonstrationOptions {
  QString folder;                          ///< For the pictures; empty: none are taken.
  QString scenario = QStringLiteral("grab_pipe");
  double link_timeout_s = 30;
};

/// Works the window as an operator would (SimulatedOperator): nothing is called behind it.  VIRTUAL only. GUI
/// thread only.
class Demonstration final {
 public:
  Demonstration(MainWindow& window, DemonstrationOptions options);

  /// Runs the event loop until the task is done.  @returns what failed, as a sentence; success only if the gripper
  /// holds the pipe in the end.
  Status run();
  int picturesTaken() const { return m_pictures; }

 private:
  Status waitForLink();
  Status aim();
  Status takePair();
  Status drawLine();
  Status planGrab();
  Status release();
  Status play();
  Status grip();
  Status showSizes();
  Result<SimulatedOperator::Points> ends() const;
  Status shoot(const char* name);
  Status shootAt(const QSize& size, const char* name);

  MainWindow& m_window;
  Workbench& m_bench;
  DemonstrationOptions m_options;
  SimulatedOperator m_operator;
  int m_pictures = 0;
};

}  // namespace longarm::ui
