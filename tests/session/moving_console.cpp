// A console without a window that moves the arm from where it is to "home", until somebody kills it.
// usage: moving_console URL TRAJECTORY_OUT SPEED; prints "moving" in the middle of the motion.
#include <unistd.h>

#include <cstdio>
#include <string>

#include "core/text.h"
#include "planning/macros/macro.h"
#include "planning/trajectory/trajectory_file.h"
#include "session/robot/robot_runtime.h"

namespace longarm::session {
namespace {

Status move(const std::string& url, const std::string& out, double speed) {
  auto workcell = planning::loadBuiltInWorkcell();
  if (!workcell) return workcell.error();
  workcell->backend.url = url;
  RuntimeOptions options;
  options.mode = RobotMode::kLive;
  options.gui_watchdog = false;
  options.stream_cameras = false;
  auto runtime = RobotRuntime::start(std::make_shared<planning::Workcell>(*workcell), options);
  if (!runtime) return runtime.error();
  if (auto status = (*runtime)->waitUntilUp(15); !status) return status;
  if (auto status = (*runtime)->resetStop(); !status) return status;
  const auto q = (*runtime)->configuration();
  if (!q) return q.error();
  planning::PlanContext context;
  context.workcell = &*workcell;
  context.start = *q;
  const auto macros = planning::makeMacros(*workcell);
  const auto plan = planning::findMacro(macros, "home")->plan(context, nullptr);
  if (!plan.ok()) return {ErrorCode::kNoSolution, plan.reason};
  if (auto status = planning::writeTrajectory(out, plan.trajectory); !status) return status;
  if (auto status = (*runtime)->load(plan.trajectory); !status) return status;
  (*runtime)->setSpeed(speed);
  if (auto status = (*runtime)->play(); !status) return status;
  for (bool said = false;; usleep(2000)) {
    const auto status = (*runtime)->status();
    if (status.player == planning::PlayerState::kDone) return {ErrorCode::kRefused, "nobody has killed this console"};
    // A busy machine delivers joint states too late now and then, and the gate stops: go on.
    if (status.player != planning::PlayerState::kPlaying && (*runtime)->resetStop()) (void)(*runtime)->play().ok();
    const bool moves = status.player == planning::PlayerState::kPlaying && status.moving;
    if (said || !moves || status.cursor < 0.4 * status.duration) continue;
    said = true;
    std::puts("moving");
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace longarm::session

int main(int argc, char** argv) {
  const auto speed = argc == 4 ? longarm::parseNumber(argv[3]) : std::nullopt;
  if (!speed) return 2;
  const auto status = longarm::session::move(argv[1], argv[2], *speed);
  std::printf("%s\n", status.ok() ? "done" : status.error().message.c_str());
  return 1;
}
