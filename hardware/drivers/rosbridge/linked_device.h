#pragma once

/// @file
/// LinkedDevice: the life cycle of a device that shares a Connection with others.

#include <memory>
#include <string>
#include <utility>

#include "hardware/device_runner.h"
#include "hardware/drivers/rosbridge/connection.h"
#include "hardware/drivers/rosbridge/robot_state.h"

namespace longarm::hardware {

/// What all devices behind one rosbridge server share.
struct RosbridgeRobot {
  std::shared_ptr<Connection> link;
  std::shared_ptr<RobotState> state;
  const Clock* clock = nullptr;          ///< Outlives the devices.
};

/// kOpening until the link stands for the first time.  A link that is lost later is a trouble that passes: commands
/// are refused with kDisconnected, what was subscribed comes again by itself, but nothing that was commanded does.
template <typename Kind>
class LinkedDevice : public RunnerDevice<Kind> {
 public:
  LinkedDevice(std::string name, RosbridgeRobot robot)
      : RunnerDevice<Kind>(std::move(name)), m_robot(std::move(robot)) {}

 protected:
  /// On the connection's thread.
  virtual void onLinkLost() {}

  const RosbridgeRobot& robot() const { return m_robot; }
  Connection& link() const { return *m_robot.link; }
  RobotState& joints() const { return *m_robot.state; }

  Status onOpen() override {
    Connection::Events events;
    events.up = [this] {
      this->runner().opened();
      this->runner().recovered();
    };
    events.down = [this](const Error& why) {
      onLinkLost();
      this->runner().trouble(why);
    };
    events.trouble = [this](const Error& what) { this->runner().trouble(what); };
    events.fault = [this](const Error& what) { this->runner().fault(what); };
    m_attached = m_robot.link->attach(std::move(events));
    return {};
  }

  Status onClose() override {
    m_robot.link->detach(m_attached);
    return {};
  }

  Status onClearFault() override { return m_robot.link->requireUp(); }

  /// For commands: kDisconnected, or kRefused unless kActive.
  Status requireLinkAndActive(const char* what) const {
    if (auto up = m_robot.link->requireUp(); !up) return {up.error().code, this->name() + ": " + up.error().message};
    return this->runner().requireActive(what);
  }

 private:
  const RosbridgeRobot m_robot;
  std::uint64_t m_attached = 0;
};

}  // namespace longarm::hardware
