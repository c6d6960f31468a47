// longarm-virtual-robot: the built-in robot as a program of its own, spoken to as a real one is.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <clocale>
#include <cstdio>

#include <CLI/CLI.hpp>
#include <QCoreApplication>
#include <QSocketNotifier>
#include <QTimer>

#include "app/virtual_robot/robot_server.h"

namespace {

using longarm::virtual_robot::RobotOptions;
using longarm::virtual_robot::RobotServer;

constexpr int kExitUsage = 2, kExitInput = 3;
constexpr int kParentCheckMs = 500;

int g_signal_pipe[2] = {-1, -1};

void onSignal(int) {
  const char byte = 0;
  (void)!write(g_signal_pipe[1], &byte, 1);
}

// SIGTERM, SIGINT and SIGHUP end the program through its event loop.
void quitOnSignals(QCoreApplication& app) {
  if (pipe2(g_signal_pipe, O_CLOEXEC | O_NONBLOCK) != 0) return;
  auto* notifier = new QSocketNotifier(g_signal_pipe[0], QSocketNotifier::Read, &app);
  QObject::connect(notifier, &QSocketNotifier::activated, &app, [] { QCoreApplication::quit(); });
  struct sigaction action = {};
  action.sa_handler = onSignal;
  for (const int number : {SIGTERM, SIGINT, SIGHUP}) sigaction(number, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

// The one who started it keeps its standard input open; when that closes, or the parent is gone, so is the robot.
void quitWithParent(QCoreApplication& app) {
  auto* input = new QSocketNotifier(STDIN_FILENO, QSocketNotifier::Read, &app);
  QObject::connect(input, &QSocketNotifier::activated, &app, [input] {
    char buffer[256];
    if (read(STDIN_FILENO, buffer, sizeof buffer) > 0) return;
    input->setEnabled(false);
    QCoreApplication::quit();
  });
  auto* timer = new QTimer(&app);
  QObject::connect(timer, &QTimer::timeout, &app, [parent = getppid()] {
    if (getppid() != parent) QCoreApplication::quit();
  });
  timer->start(kParentCheckMs);
}

int serve(int argc, char** argv, const RobotOptions& options, int port) {
  QCoreApplication app(argc, argv);
  std::setlocale(LC_ALL, "C");           // Qt has set the desktop's; numbers have a point
  quitOnSignals(app);
  quitWithParent(app);
  RobotServer server;
  QObject::connect(&server, &RobotServer::quitAsked, &app, &QCoreApplication::quit, Qt::QueuedConnection);
  if (auto status = server.start(options, static_cast<quint16>(port)); !status) {
    std::fprintf(stderr, "longarm-virtual-robot: %s\n", status.error().message.c_str());
    return kExitInput;
  }
  std::printf("{\"url\": \"ws://127.0.0.1:%d\"}\n", server.port());
  std::fflush(stdout);
  return QCoreApplication::exec();
}

}  // namespace

int main(int argc, char** argv) {
  RobotOptions options;
  int port = 0;
  CLI::App cli("The built-in virtual robot: speaks rosbridge v2 over a WebSocket on 127.0.0.1.\n"
               "Ends when its standard input closes.  Example:\n"
               "  longarm-virtual-robot --scenario grab_pipe --seed 7 < /dev/tty",
               "longarm-virtual-robot");
  cli.add_option("--scenario", options.scenario, "Built-in name or file (longarm list scenarios)")
      ->capture_default_str();
  cli.add_option("--variant", options.variant, "Variant of the robot (ptz); default: the scenario's")
      ->check(CLI::IsMember({"", "ptz"}));
  cli.add_option("--port", port, "TCP port; 0: any that is free")->check(CLI::Range(0, 65535))->capture_default_str();
  cli.add_option("--seed", options.seed, "Draws the world, the robot's hidden errors and all noise; 0: as in the file")
      ->capture_default_str();
  cli.add_flag("--lockstep", options.lockstep, "Time passes only by the service /virtual_robot/step");
  cli.add_flag("--ideal", options.ideal, "No joint offsets, backlash, latency or noise");
  bool no_cameras = false;
  cli.add_flag("--no-cameras", no_cameras, "Take no pictures");
  cli.set_version_flag("--version", LONGARM_VERSION);
  try {
    cli.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return cli.exit(e) == 0 ? 0 : kExitUsage;
  }
  options.cameras = !no_cameras;
  return serve(argc, argv, options, port);
}
