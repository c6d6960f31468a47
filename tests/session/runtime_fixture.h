#pragma once

/// @file
/// A runtime in lockstep over simulated devices: three joints, no process, no network.

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/text.h"
#include "hardware/sim/simulated_arm.h"
#include "hardware/sim/simulated_gripper.h"
#include "hardware/sim/simulated_imu.h"
#include "hardware/sim/simulated_pan_tilt.h"
#include "session/robot/robot_runtime.h"
#include "tests/planning/player_fixture.h"

namespace longarm::testing {

inline std::shared_ptr<const planning::Workcell> threeJointWorkcell() {
  const char* urdf = R"(<robot name="three">
    <link name="base_link"/><link name="a"/><link name="b"/><link name="tool_tip"/>
    <joint name="joint_1" type="revolute"><parent link="base_link"/><child link="a"/><axis xyz="0 0 1"/>
      <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
    <joint name="joint_2" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
      <limit lower="-3" upper="3" velocity="1" effort="1"/></joint>
    <joint name="joint_3" type="revolute"><parent link="b"/><child link="tool_tip"/><origin xyz="0 0 0.05"/>
      <axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="1" effort="1"/></joint></robot>)";
  const std::string path = ::testing::TempDir() + "runtime_three_joints.urdf";
  EXPECT_TRUE(writeFileAtomically(path, urdf).ok());
  auto workcell = std::make_shared<planning::Workcell>();
  auto model = planning::RobotModel::load(path);
  EXPECT_TRUE(model.ok()) << model.error().message;
  workcell->model = *model;
  workcell->arm = *workcell->model->chain("base_link", "tool_tip");
  workcell->arm_limits = limitsOf(3, 1, 5);
  return workcell;
}

class RuntimeFixture : public ::testing::Test {
 protected:
  void start(session::RuntimeOptions options = {}) {
    options.make_devices = [this](const planning::Workcell& workcell, const std::string&,
                                  const Clock& clock) { return devices(workcell, clock); };
    startWith(options);
  }
  // With devices of the test's own.
  void startWith(session::RuntimeOptions options) {
    options.lockstep = true;
    options.gui_watchdog = m_watchdog;
    auto started = session::RobotRuntime::start(m_workcell, options);
    ASSERT_TRUE(started.ok()) << started.error().message;
    m_runtime = std::move(*started);
    m_runtime->onEvent([this](const session::RuntimeEvent& event) { m_events.push_back(event); });
    ASSERT_TRUE(m_runtime->waitUntilUp(5).ok());
    ASSERT_TRUE(m_runtime->resetStop().ok());
  }

  Result<session::DeviceSet> devices(const planning::Workcell& workcell, const Clock& clock) {
    session::DeviceSet set;
    m_arm = std::make_shared<hardware::SimulatedArm>("arm", workcell.armJointNames(), m_home,
                                                     workcell.arm_limits.stop_deceleration, clock);
    set.arm = m_arm;
    m_gripper = std::make_shared<hardware::SimulatedGripper>("gripper", 0.0, 0.05, 0.05, clock);
    m_imu = std::make_shared<hardware::SimulatedImu>("imu", clock);
    set.gripper = m_gripper;
    set.imu = m_imu;
    set.pan_tilts["head"] = std::make_shared<hardware::SimulatedPanTilt>("head", 1.5, 1.0, clock);
    set.alive_until_s = m_alive_until;
    return set;
  }

  // A motion from home, within what the planner leaves at speed 1.
  Trajectory motion(unsigned seed = 1) const {
    auto path = SmoothMotion(m_workcell->arm_limits, seed).timed(m_workcell->arm_limits, {0.44, 0.125});
    const Eigen::VectorXd shift = m_home - path.points.front().positions;
    for (auto& p : path.points) p.positions += shift;
    path.joint_names = m_workcell->armJointNames();
    return path;
  }

  void loadAndPlay() {
    ASSERT_TRUE(m_runtime->load(motion()).ok());
    const auto played = m_runtime->play();
    ASSERT_TRUE(played.ok()) << played.error().message;
  }
  void step(double seconds) { ASSERT_TRUE(m_runtime->step(seconds).ok()); }
  Eigen::VectorXd measured() const { return m_runtime->jointState()->positions; }
  double speedNow() const {
    const auto joints = m_runtime->jointState();
    return joints->velocities.size() > 0 ? joints->velocities.cwiseAbs().maxCoeff() : 0;
  }
  const session::RuntimeEvent* event(const std::string& kind) const {
    for (const auto& e : m_events) {
      if (e.kind == kind) return &e;
    }
    return nullptr;
  }

  bool m_watchdog = false;
  Eigen::VectorXd m_home = Eigen::Vector3d(0.1, -0.2, 0.3);
  std::shared_ptr<const planning::Workcell> m_workcell = threeJointWorkcell();
  std::shared_ptr<std::atomic<double>> m_alive_until = std::make_shared<std::atomic<double>>(0);
  std::shared_ptr<hardware::SimulatedArm> m_arm;
  std::shared_ptr<hardware::SimulatedGripper> m_gripper;
  std::shared_ptr<hardware::SimulatedImu> m_imu;
  std::vector<session::RuntimeEvent> m_events;  // Outlives the runtime, which tells its end.
  std::unique_ptr<session::RobotRuntime> m_runtime;
};

}  // namespace longarm::testing
