#pragma once

/// @file
/// RosbridgeArm: an arm that follows trajectory_msgs/JointTrajectory horizons.

#include "hardware/drivers/rosbridge/linked_device.h"
#include "hardware/drivers/rosbridge/topic_names.h"

namespace longarm::hardware {

/// After a lost link it is kIdle: motion needs an activate(), which only an operator's reset does.  Thread-safe.
class RosbridgeArm final : public LinkedDevice<RobotArm> {
 public:
  RosbridgeArm(std::string name, RosbridgeRobot robot, const TopicNames& topics);
  ~RosbridgeArm() override;

  std::shared_ptr<const JointState> jointState() const override;
  Result<JointState> jointStateAt(double stamp_s) const override;
  /// @returns kDisconnected, kRefused unless kActive or when too much waits to be sent, kStale before the robot's
  ///   clock is known.
  Status send(const Horizon& horizon) override;

 protected:
  Status onActivate() override;
  Status onStop() override;
  void onLinkLost() override;

 private:
  const std::string m_trajectory_topic, m_stop_topic;
};

}  // namespace longarm::hardware
