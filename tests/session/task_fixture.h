#pragma once

/// @file
/// Tasks on the virtual robot, where it is built.

#include <unistd.h>

#include <cstdlib>
#include <map>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "planning/world/workcell.h"
#include "session/robot/robot_runtime.h"
#include "session/robot/virtual_robot_process.h"
#include "session/task_runner.h"

namespace longarm::testing {

/// Path of longarm-virtual-robot, or empty.
inline std::string virtualRobot() {
#ifdef LONGARM_VIRTUAL_ROBOT_PATH
  const bool chosen = std::getenv("LONGARM_VIRTUAL_ROBOT") != nullptr;
  const auto found = session::VirtualRobotProcess::find(chosen ? "" : LONGARM_VIRTUAL_ROBOT_PATH);
  return found ? *found : std::string();
#else
  return {};
#endif
}

inline const planning::Workcell& builtInWorkcell(const std::string& variant = {}) {
  static std::map<std::string, planning::Workcell> cells;
  auto& cell = cells[variant];
  if (cell.model == nullptr) {
    auto loaded = planning::loadBuiltInWorkcell(variant);
    EXPECT_TRUE(loaded.ok()) << (loaded.ok() ? "" : loaded.error().message);
    if (loaded) cell = std::move(*loaded);
  }
  return cell;
}

/// A robot in lockstep that is up, its STOP released; null when it does not come up.
inline std::unique_ptr<session::RobotRuntime> robotInLockstep(std::shared_ptr<const planning::Workcell> cell,
                                                              session::RuntimeOptions options) {
  options.lockstep = true;
  options.gui_watchdog = false;
  options.virtual_robot = virtualRobot();
  auto started = session::RobotRuntime::start(std::move(cell), std::move(options));
  EXPECT_TRUE(started.ok()) << (started.ok() ? "" : started.error().message);
  if (!started) return nullptr;
  EXPECT_TRUE((*started)->waitUntilUp(20).ok());
  EXPECT_TRUE((*started)->resetStop().ok());
  return std::move(*started);
}

inline nlohmann::json truthOf(session::RobotRuntime& robot) {
  const auto answer = robot.callService("/virtual_robot/truth", "{}");
  EXPECT_TRUE(answer.ok()) << (answer.ok() ? "" : answer.error().message);
  return answer.ok() ? nlohmann::json::parse(*answer) : nlohmann::json::object();
}

inline void expectGoals(session::RobotRuntime& robot) {
  const auto told = truthOf(robot);
  for (const auto& goal : told.at("goals")) EXPECT_TRUE(goal.at("reached").get<bool>()) << goal.dump();
  EXPECT_TRUE(told.at("contacts").empty()) << told.at("contacts").dump();
}

inline std::string tableOf(const session::TaskReport& report) {
  std::string out;
  for (const auto& s : report.stages) {
    out += s.name + (s.ok ? " ok " : " FAILED ") + std::to_string(s.seconds) + " s: " + s.detail + "\n";
  }
  for (const auto& s : report.stops) out += "stopped at " + std::to_string(s.t) + " s by " + s.source + ": " + s.reason + "\n";
  return out;
}

}  // namespace longarm::testing

#define LONGARM_SKIP_WITHOUT_VIRTUAL_ROBOT() \
  if (::longarm::testing::virtualRobot().empty()) GTEST_SKIP() << "skipped: longarm-virtual-robot is not built"
