#include "app/open_console.h"

#include <cstdio>


namespace longarm::app {

void addConsoleOptions(CLI::App& app, ConsoleArguments& arguments) {
  app.add_option("--workcell", arguments.workcell, "Workcell file to open (default: the built-in robot)");
  app.add_option("--scenario", arguments.scenario, "Training scenario of the virtual robot (default: grab_pipe)")
      ->take_last();               // run.sh gives one, and its caller may give another
  app.add_option("--variant", arguments.variant, "Variant of the built-in robot: ptz carries two pan-tilt zoom cameras");
  app.add_option("--views", arguments.views, "A views.yaml whose pictures are opened at the start");
  app.add_option("--theme", arguments.theme, "dark or light")->check(CLI::IsMember({"dark", "light"}));
  app.add_option("--screenshots", arguments.screenshots, "Folder for the pictures that --perform takes");
  app.add_flag("--perform", arguments.perform, "Perform the scenario's task in the window, unattended, then end");
  app.add_flag("--reset-layout", arguments.reset_layout, "Start with the factory layout of the window");
}

#ifndef LONGARM_HAS_GUI
int openConsole(int&, char**, const ConsoleArguments&) {
  std::fprintf(stderr, "longarm: this build has no window (LONGARM_BUILD_GUI=OFF); give a verb, see longarm --help\n");
  return 2;
}
#endif

}  // namespace longarm::app
