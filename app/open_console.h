#pragma once

/// @file
/// What `longarm` without a verb does: opens the window, or says that this build has none.

#include <string>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace longarm::app {

struct ConsoleArguments {
  std::string workcell;        ///< Empty: the built-in robot.
  std::string scenario;        ///< Training scenario of the virtual robot; empty: grab_pipe.
  std::string variant;         ///< Of the built-in robot: empty or "ptz".
  std::string views;           ///< A views.yaml whose pictures are opened at the start; empty: none.
  std::string theme;           ///< "dark", "light", empty: as last time.
  std::string screenshots;     ///< Folder for pictures of the demonstration.
  bool perform = false;        ///< The console performs the task by itself, then ends.
  bool reset_layout = false;
};

void addConsoleOptions(CLI::App& app, ConsoleArguments& arguments);
/// @returns the exit status of the program.
int openConsole(int& argc, char** argv, const ConsoleArguments& arguments);

}  // namespace longarm::app
