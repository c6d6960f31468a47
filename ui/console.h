#pragma once

/// @file
/// The console: what `longarm` without a verb opens.

#include <string>

namespace longarm::ui {

struct ConsoleOptions {
  std::string workcell;                    ///< File; empty: the built-in robot.
  std::string scenario = "grab_pipe";      ///< Of the virtual robot: name or file.
  std::string variant;                     ///< Of the built-in robot: empty or "ptz".
  std::string views;                       ///< A views.yaml whose pictures are opened at the start; empty: none.
  std::string theme;                       ///< "dark", "light", empty: as last time.
  std::string screenshots;                 ///< Folder for the pictures of a demonstration.
  bool perform = false;                    ///< Does the scenario's task in the window unattended, then ends.
  bool reset_layout = false;               ///< Forgets where the panels stood.
};

/// Makes the application, shows the window, then starts the robot.  Call once, on the main thread.
/// @returns the exit status of the program: 0; 2 when there is no display; 4 when a demonstration failed.
int runConsole(int& argc, char** argv, const ConsoleOptions& options);

}  // namespace longarm::ui
