#pragma once

/// @file
/// RosbridgeGripper: one finger joint, commanded by position.

#include <atomic>
#include <mutex>
#include <optional>

#include "hardware/drivers/rosbridge/linked_device.h"
#include "hardware/drivers/rosbridge/topic_names.h"

namespace longarm::hardware {

struct GripperSettings {
  std::string joint;                     ///< As the robot's joint states name it.
  double closed = 0, open = 0;           ///< [m or rad]
};

/// stop() halts fingers that move and leaves a grip as it is.  Thread-safe.
class RosbridgeGripper final : public LinkedDevice<Gripper> {
 public:
  RosbridgeGripper(std::string name, RosbridgeRobot robot, GripperSettings settings, const TopicNames& topics);
  ~RosbridgeGripper() override;

  /// @returns kDisconnected, kRefused unless kActive, kOutOfLimits.
  Status setOpening(double position) override;
  double position() const override;
  bool holding() const override { return m_holding; }

 protected:
  Status onOpen() override;
  Status onClose() override;
  Status onStop() override;
  void onLinkLost() override { m_holding = false; }

 private:
  const GripperSettings m_settings;
  const std::string m_command_topic, m_holding_topic;
  std::atomic<bool> m_holding{false};
  std::uint64_t m_subscription = 0;
};

}  // namespace longarm::hardware
