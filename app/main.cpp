// longarm: the console without a verb, the headless verbs with one.
#include <clocale>
#include <string>

#include <CLI/Option.hpp>

#include "app/verbs/cli.h"
#include "app/open_console.h"

int main(int argc, char** argv) {
  std::setlocale(LC_ALL, "C");  // numbers in files have a point, whatever the desktop says
  longarm::app::Cli cli;
  longarm::app::addTargetVerbs(cli);
  longarm::app::addRobotVerbs(cli);
  longarm::app::addPlanVerbs(cli);
  longarm::app::addCalibrateVerbs(cli);
  longarm::app::addListVerb(cli);
  longarm::app::addRunVerb(cli);
  longarm::app::ConsoleArguments console;
  longarm::app::addConsoleOptions(cli.app(), console);
  bool opened = false;
  const int status = cli.run(argc, argv, opened);
  return opened ? longarm::app::openConsole(argc, argv, console) : status;
}
