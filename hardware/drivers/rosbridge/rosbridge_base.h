#pragma once

/// @file
/// RosbridgeBase: a base that takes velocities and tells its odometry.

#include "core/latest_value.h"
#include "hardware/drivers/rosbridge/linked_device.h"
#include "hardware/drivers/rosbridge/topic_names.h"

namespace longarm::hardware {

/// stop() sends a velocity of zero before whatever waits; the robot stops by itself when nothing comes.
/// Thread-safe.
class RosbridgeBase final : public LinkedDevice<MobileBase> {
 public:
  RosbridgeBase(std::string name, RosbridgeRobot robot, BaseLimits limits, const TopicNames& topics);
  ~RosbridgeBase() override;

  std::shared_ptr<const BaseState> odometry() const override { return m_newest.get(); }
  /// @returns kDisconnected, kRefused unless kActive, as checkTwist().
  Status drive(const BaseTwist& twist) override;

 protected:
  Status onOpen() override;
  Status onClose() override;
  Status onStop() override;

 private:
  Status take(const rosbridge::OdometryMessage& message, double received_s);

  const BaseLimits m_limits;
  const std::string m_command_topic, m_odometry_topic;
  LatestValue<BaseState> m_newest;
  std::uint64_t m_subscription = 0;
};

}  // namespace longarm::hardware
