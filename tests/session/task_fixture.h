#pragma once

/// @file
/// Tasks on the virtual robot, where it is built.

#include <unistd.h>

#include <cstdlib>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "planning/world/workcell.h"
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
