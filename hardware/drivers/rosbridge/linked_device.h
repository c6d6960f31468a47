#pragma once

/// @file
/// LinkedDevice: the life cycle of a device that shares a Connection with others.

#include <functional>
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

  /// Listens to a topic for as long as the device is open; what cannot be read is a trouble of this device and no other's.
  /// @param take  Called on the connection's thread with each message and when it came on the console's clock [s].
  template <typename Message>
  std::uint64_t listen(const std::string& topic, std::function<Status(const Message&, double)> take) {
    rosbridge::Subscribe what;
    what.topic = topic;
    what.type = Message::kType;
    return link().subscribe(std::move(what), [this, take](const rosbridge::Publish& message, double received_s) -> Status {
      const auto read = rosbridge::readAs<Message>(message.message);
      if (const Status taken = read ? take(*read, received_s) : Status(read.error()); !taken) this->runner().trouble(taken.error());
      return {};
    });
  }
  /// A stamp of the robot on the console's clock, whose offset the joint states tell; before the first of them arrival counts.
  double onOurClock(double stamp_s, double received_s) const {
    const auto offset = joints().offset();
    return offset ? stamp_s + *offset : received_s;
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
