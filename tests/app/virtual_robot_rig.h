#pragma once

/// @file
/// What the virtual robot's tests share: workcells, scenarios, horizons.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/virtual_robot/robot_body.h"
#include "core/motion.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {

inline const planning::Workcell& builtIn(const std::string& variant = {}) {
  static const planning::Workcell plain = *planning::loadBuiltInWorkcell();
  static const planning::Workcell ptz = *planning::loadBuiltInWorkcell("ptz");
  return variant.empty() ? plain : ptz;
}

inline planning::Scenario emptyScenario() {
  planning::Scenario out;
  out.name = "test";
  out.imperfections = planning::Imperfections::none();
  return out;
}

inline std::unique_ptr<RobotBody> bodyOf(const planning::Scenario& scenario, unsigned seed = 1) {
  auto body = RobotBody::create(builtIn(), scenario, seed);
  EXPECT_TRUE(body.ok()) << body.error().message;
  return std::move(*body);
}

/// From rest to rest in `seconds`, one quintic with `points` intermediate points.
inline Horizon quinticTo(const std::vector<std::string>& joints, const Eigen::VectorXd& from,
                         const Eigen::VectorXd& to, double seconds, int points = 20) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(from.size());
  const Trajectory whole{joints, {{0, from, zero, zero}, {seconds, to, zero, zero}}};
  Horizon out;
  out.owner = "test";
  out.joint_names = joints;
  for (int i = 0; i <= points; ++i) out.points.push_back(whole.sample(seconds * i / points));
  return out;
}

/// Ticks with a heartbeat every 50 ms.
inline void run(RobotBody& body, double seconds) {
  const long ticks = std::lround(seconds / RobotBody::kTick_s);
  for (long i = 0; i < ticks; ++i) {
    if (i % 10 == 0) body.heartbeat();
    body.tick();
  }
}

/// A change of all six joints that the start pose leaves room for.
inline Eigen::VectorXd sweep(double by) {
  return (Eigen::VectorXd(6) << by, by, -by, by, by, by).finished();
}

/// Moves the arm's joints by `change` within `seconds` and waits until it is over.
inline void moveArm(RobotBody& body, const Eigen::VectorXd& change, double seconds) {
  body.heartbeat();
  const Eigen::VectorXd from = body.arm().commandedAt(body.time_s()).positions;
  const auto status = body.follow(quinticTo(body.arm().joints(), from, from + change, seconds));
  ASSERT_TRUE(status.ok()) << status.error().message;
  run(body, seconds + 0.1);
}

inline Eigen::VectorXd armOf(const RobotBody& body) {
  return *body.measured().positionsOf(body.arm().joints());
}

}  // namespace longarm::virtual_robot
