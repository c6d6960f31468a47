#pragma once

/// @file
/// RosbridgePanTilt: two joints that aim cameras, commanded by absolute angles.

#include <mutex>

#include "hardware/drivers/rosbridge/linked_device.h"
#include "hardware/drivers/rosbridge/topic_names.h"

namespace longarm::hardware {

struct PanTiltSettings {
  struct Axis {
    std::string joint;                   ///< As the robot's joint states name it.
    double lower = 0, upper = 0;         ///< [rad]
  };
  Axis pan, tilt;
};

/// Thread-safe.
class RosbridgePanTilt final : public LinkedDevice<PanTilt> {
 public:
  RosbridgePanTilt(std::string name, RosbridgeRobot robot, PanTiltSettings settings, const TopicNames& topics);
  ~RosbridgePanTilt() override;

  /// @returns kDisconnected, kRefused unless kActive, kOutOfLimits naming the joint.
  Status moveTo(double pan, double tilt) override;
  double pan() const override { return joints().position(m_settings.pan.joint).valueOr(0); }
  double tilt() const override { return joints().position(m_settings.tilt.joint).valueOr(0); }
  /// By measured speed, and for a short while after a command that is not reached yet.
  bool moving() const override;

 protected:
  Status onStop() override;

 private:
  rosbridge::Operation command(double pan, double tilt) const;
  bool turns() const;

  const PanTiltSettings m_settings;
  const std::string m_topic;
  mutable std::mutex m_mutex;            // guards the last command
  double m_wanted_pan = 0, m_wanted_tilt = 0, m_commanded_s = -1e9;
};

}  // namespace longarm::hardware
