#pragma once

/// @file
/// RosbridgeImu: an attitude sensor that is listened to.

#include "core/latest_value.h"
#include "hardware/drivers/rosbridge/linked_device.h"

namespace longarm::hardware {

/// Thread-safe.
class RosbridgeImu final : public LinkedDevice<Imu> {
 public:
  RosbridgeImu(std::string name, RosbridgeRobot robot, std::string topic);
  ~RosbridgeImu() override;

  std::shared_ptr<const Attitude> attitude() const override { return m_newest.get(); }

 protected:
  Status onOpen() override;
  Status onClose() override;

 private:
  Status take(const rosbridge::ImuMessage& message, double received_s);

  const std::string m_topic;
  LatestValue<Attitude> m_newest;
  std::uint64_t m_subscription = 0;
};

}  // namespace longarm::hardware
