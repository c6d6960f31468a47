// The window's end of openConsole(); in the executable, so that the verbs link without Qt Widgets.
#include "app/open_console.h"
#include "ui/console.h"

namespace longarm::app {

int openConsole(int& argc, char** argv, const ConsoleArguments& arguments) {
  ui::ConsoleOptions options;
  options.workcell = arguments.workcell;
  options.scenario = arguments.scenario.empty() ? "grab_pipe" : arguments.scenario;
  options.variant = arguments.variant;
  options.views = arguments.views;
  options.theme = arguments.theme;
  options.screenshots = arguments.screenshots;
  options.perform = arguments.perform;
  options.reset_layout = arguments.reset_layout;
  return ui::runConsole(argc, argv, options);
}

}  // namespace longarm::app
