#include "tests/hardware/device_rigs.h"

#include <chrono>
#include <optional>
#include <thread>

#include "hardware/drivers/rosbridge/rosbridge_arm.h"
#include "hardware/drivers/rosbridge/rosbridge_base.h"
#include "hardware/drivers/rosbridge/rosbridge_camera.h"
#include "hardware/drivers/rosbridge/rosbridge_gripper.h"
#include "hardware/drivers/rosbridge/rosbridge_pan_tilt.h"
#include "hardware/drivers/skeleton/skeleton_pan_tilt.h"
#include "hardware/sim/simulated_base.h"
#include "hardware/sim/simulated_camera.h"
#include "tests/hardware/bridge_server.h"
#include "tests/hardware/gate_rig.h"

namespace longarm::hardware::tests {
namespace {

Horizon longHorizon(const RobotArm& arm, double now_s) {
  Horizon out = restToRest(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.3, -0.2, 0.1), 1.0);
  const auto state = arm.jointState();
  const auto here = state ? state->positionsOf(out.joint_names) : Result<Eigen::VectorXd>(ErrorCode::kStale, "");
  if (here) {
    for (auto& p : out.points) p.positions += *here;
  }
  out.start_s = now_s;
  return out;
}

// A simulator on a clock that the test moves.
template <typename Kind>
class SimRig : public DeviceRig {
 public:
  Device& device() override { return *m_device; }
  void destroyDevice() override { m_device.reset(); }
  void pass(double seconds) override { m_clock.advance(seconds); }

 protected:
  ManualClock m_clock{10};
  std::unique_ptr<Kind> m_device;
};

class SimArmRig final : public SimRig<SimulatedArm> {
 public:
  SimArmRig() {
    m_device = std::make_unique<SimulatedArm>("arm", jointNames(3), Eigen::Vector3d::Zero(),
                                              Eigen::Vector3d(12, 12, 12), m_clock);
  }
  Status command() override { return m_device->send(longHorizon(*m_device, m_clock.now_s())); }
  std::optional<bool> moves() override {
    const auto state = m_device->jointState();
    return state && state->velocities.cwiseAbs().maxCoeff() > 1e-6;
  }
  bool breakIt() override {
    m_device->injectFault("drive 3 is too hot");
    return true;
  }
};

class SimGripperRig final : public SimRig<SimulatedGripper> {
 public:
  SimGripperRig() { m_device = std::make_unique<SimulatedGripper>("gripper", 0.0, 0.05, 0.05, m_clock); }
  Status command() override { return m_device->setOpening(0.0); }
  std::optional<bool> moves() override {
    const double before = m_device->position();
    m_clock.advance(0.01);
    return m_device->position() != before;
  }
  bool breakIt() override {
    m_device->injectFault("the air is gone");
    return true;
  }
};

class SimPanTiltRig final : public SimRig<SimulatedPanTilt> {
 public:
  SimPanTiltRig() { m_device = std::make_unique<SimulatedPanTilt>("head", 1.5, 0.5, m_clock); }
  Status command() override { return m_device->moveTo(0.5, -0.3); }
  std::optional<bool> moves() override { return m_device->moving(); }
  bool breakIt() override {
    m_device->injectFault("the cable is torn");
    return true;
  }
};

class SimBaseRig final : public SimRig<SimulatedBase> {
 public:
  SimBaseRig() { m_device = std::make_unique<SimulatedBase>("base", BaseLimits(), m_clock); }
  Status command() override { return m_device->drive({0.2, 0, 0.1}); }
  std::optional<bool> moves() override { return !m_device->odometry()->twist.still(); }
  bool breakIt() override {
    m_device->injectFault("a track has come off");
    return true;
  }
};

class SimCameraRig final : public SimRig<SimulatedCamera> {
 public:
  SimCameraRig() {
    m_device = std::make_unique<SimulatedCamera>("camera", 15, "jpeg", [](std::uint64_t) { return "picture"; }, m_clock);
  }
  Status command() override { return m_device->setZoom(0.5); }
  bool commandIsConfiguration() const override { return true; }
  bool breakIt() override {
    m_device->injectFault("the sensor does not answer");
    return true;
  }
};

class SkeletonRig final : public DeviceRig {
 public:
  Device& device() override { return *m_device; }
  void destroyDevice() override { m_device.reset(); }
  Status command() override { return m_device->moveTo(0.2, 0.1); }
  void pass(double seconds) override { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }
  bool breakIt() override { return false; }

 private:
  SteadyClock m_clock;
  std::unique_ptr<SkeletonPanTilt> m_device =
      std::make_unique<SkeletonPanTilt>("skeleton", SkeletonPanTilt::Settings{}, m_clock);
};

// A driver against a server of its own; its fault is a server that talks nonsense.
template <typename Kind>
class BridgeRig : public DeviceRig {
 public:
  BridgeRig() {
    ConnectionSettings settings;
    settings.url = m_server.url();
    settings.alive_until_s = std::make_shared<std::atomic<double>>(1e300);
    m_robot.link = std::make_shared<Connection>(settings, m_clock);
    m_robot.state = std::make_shared<RobotState>(m_robot.link, TopicNames().jointStates());
    m_robot.clock = &m_clock;
  }
  Device& device() override { return *m_device; }
  void destroyDevice() override { m_device.reset(); }
  void pass(double seconds) override { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }
  bool breakIt() override {
    m_server.setQuiet(true);
    for (int i = 0; i < 60; ++i) m_server.sendText("220 mail server ready");
    return true;
  }
  void mend() override { m_server.setQuiet(false); }

 protected:
  SteadyClock m_clock;
  BridgeServer m_server;
  RosbridgeRobot m_robot;
  std::unique_ptr<Kind> m_device;
};

class BridgeArmRig final : public BridgeRig<RosbridgeArm> {
 public:
  BridgeArmRig() { m_device = std::make_unique<RosbridgeArm>("arm", m_robot, TopicNames()); }
  Status command() override {
    // The first joint state tells the robot's clock; an operator cannot press Play earlier either.
    (void)eventually([&] { return m_device->state() != DeviceState::kActive || m_robot.state->offset(); });
    return m_device->send(longHorizon(*m_device, m_clock.now_s()));
  }
  std::optional<bool> moves() override {
    return m_server.arm().jointState()->velocities.cwiseAbs().maxCoeff() > 1e-6;
  }
};

class BridgeGripperRig final : public BridgeRig<RosbridgeGripper> {
 public:
  BridgeGripperRig() {
    m_device = std::make_unique<RosbridgeGripper>("gripper", m_robot, GripperSettings{"finger", 0, 0.05}, TopicNames());
  }
  Status command() override { return m_device->setOpening(0); }
  std::optional<bool> moves() override { return std::abs(m_robot.state->velocity("finger")) > 1e-4; }
};

class BridgePanTiltRig final : public BridgeRig<RosbridgePanTilt> {
 public:
  BridgePanTiltRig() {
    m_device = std::make_unique<RosbridgePanTilt>(
        "head", m_robot, PanTiltSettings{{"pan", -1.5, 1.5}, {"tilt", -1.5, 1.5}}, TopicNames());
  }
  Status command() override { return m_device->moveTo(0.8, -0.4); }
  std::optional<bool> moves() override { return m_server.panTilt().moving(); }
};

class BridgeBaseRig final : public BridgeRig<RosbridgeBase> {
 public:
  BridgeBaseRig() { m_device = std::make_unique<RosbridgeBase>("base", m_robot, BaseLimits(), TopicNames()); }
  Status command() override { return m_device->drive({0.2, 0, 0}); }
  std::optional<bool> moves() override { return !m_server.base().odometry()->twist.still(); }
};

class BridgeCameraRig final : public BridgeRig<RosbridgeCamera> {
 public:
  BridgeCameraRig() {
    CameraSettings settings;
    settings.zooms = true;
    m_device = std::make_unique<RosbridgeCamera>("head_left", m_robot, settings, TopicNames());
  }
  Status command() override { return m_device->setZoom(0.5); }
  bool commandIsConfiguration() const override { return true; }
};

template <typename Rig>
DeviceCase deviceCase(const char* name) {
  return {name, [] { return std::make_unique<Rig>(); }};
}

}  // namespace

std::vector<DeviceCase> allDeviceCases() {
  return {deviceCase<SimArmRig>("SimulatedArm"),
          deviceCase<SimGripperRig>("SimulatedGripper"),
          deviceCase<SimPanTiltRig>("SimulatedPanTilt"),
          deviceCase<SimCameraRig>("SimulatedCamera"),
          deviceCase<SkeletonRig>("SkeletonPanTilt"),
          deviceCase<BridgeArmRig>("RosbridgeArm"),
          deviceCase<BridgeGripperRig>("RosbridgeGripper"),
          deviceCase<BridgePanTiltRig>("RosbridgePanTilt"),
          deviceCase<BridgeCameraRig>("RosbridgeCamera"),
          deviceCase<SimBaseRig>("SimulatedBase"),
          deviceCase<BridgeBaseRig>("RosbridgeBase")};
}

}  // namespace longarm::hardware::tests
