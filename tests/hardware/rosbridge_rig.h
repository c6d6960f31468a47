#pragma once

/// @file
/// A robot's devices and a small robot, with a bad link between them when wanted.

#include <atomic>
#include <map>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "hardware/drivers/rosbridge/rosbridge_arm.h"
#include "hardware/drivers/rosbridge/rosbridge_base.h"
#include "hardware/drivers/rosbridge/rosbridge_camera.h"
#include "hardware/drivers/rosbridge/rosbridge_gripper.h"
#include "hardware/drivers/rosbridge/rosbridge_imu.h"
#include "hardware/drivers/rosbridge/rosbridge_pan_tilt.h"
#include "hardware/fault_proxy/fault_proxy.h"
#include "tests/hardware/bridge_server.h"
#include "tests/hardware/gate_rig.h"

namespace longarm::hardware::tests {

struct RigOptions {
  BridgeOptions server;
  std::map<std::string, std::string> topics;   ///< Replacements.
  bool through_proxy = false;
};

class RosbridgeRig {
 public:
  explicit RosbridgeRig(const RigOptions& options = {}) : server(options.server) {
    const TopicNames topics(options.topics);
    ConnectionSettings settings;
    settings.url = server.url();
    if (options.through_proxy) {
      auto started = FaultProxy::start(settings.url);
      EXPECT_TRUE(started.ok()) << (started.ok() ? "" : started.error().message);
      proxy = std::move(*started);
      settings.url = proxy->url();
    }
    settings.alive_until_s = alive_until_s;
    robot.link = std::make_shared<Connection>(settings, clock());
    robot.state = std::make_shared<RobotState>(robot.link, topics.jointStates());
    robot.clock = &clock();
    arm = std::make_shared<RosbridgeArm>("arm", robot, topics);
    gripper = std::make_shared<RosbridgeGripper>("gripper", robot, GripperSettings{"finger", 0, 0.05}, topics);
    head = std::make_shared<RosbridgePanTilt>(
        "head", robot, PanTiltSettings{{"pan", -1.5, 1.5}, {"tilt", -1.5, 1.5}}, topics);
    base = std::make_shared<RosbridgeBase>("base", robot, BaseLimits(), topics);
    imu = std::make_shared<RosbridgeImu>("imu", robot, topics.imu());
    camera = std::make_shared<RosbridgeCamera>("head_left", robot, CameraSettings{}, topics);
  }

  void open() {
    for (Device* device : all()) ASSERT_TRUE(device->open().ok());
    for (Device* device : all()) {
      ASSERT_TRUE(eventually([&] { return device->state() == DeviceState::kIdle; })) << device->message();
    }
    ASSERT_TRUE(eventually([&] { return arm->jointState() != nullptr; })) << "no joint state came";
  }
  void activate() {
    for (Device* device : all()) {
      const auto status = device->activate();
      ASSERT_TRUE(status.ok()) << status.error().message;
    }
  }
  void openAndActivate() {
    open();
    activate();
  }

  /// From where it stands to `way` from there.
  Horizon horizon(const Eigen::Vector3d& way, double duration) const {
    Horizon out = restToRest(Eigen::Vector3d::Zero(), way, duration);
    const auto here = arm->jointState()->positionsOf(out.joint_names);
    for (auto& p : out.points) p.positions += *here;
    out.start_s = steady.now_s();
    return out;
  }
  bool robotStands() { return server.arm().jointState()->velocities.cwiseAbs().maxCoeff() < 1e-9; }
  std::vector<Device*> all() const {
    return {arm.get(), gripper.get(), head.get(), camera.get(), base.get()};
  }
  const Clock& clock() const { return steady; }

  SteadyClock steady;
  std::shared_ptr<std::atomic<double>> alive_until_s = std::make_shared<std::atomic<double>>(1e300);
  BridgeServer server;
  std::unique_ptr<FaultProxy> proxy;
  RosbridgeRobot robot;
  std::shared_ptr<RosbridgeArm> arm;
  std::shared_ptr<RosbridgeGripper> gripper;
  std::shared_ptr<RosbridgePanTilt> head;
  std::shared_ptr<RosbridgeCamera> camera;
  std::shared_ptr<RosbridgeBase> base;
  std::shared_ptr<RosbridgeImu> imu;     // opened by who wants it
};

}  // namespace longarm::hardware::tests
