#pragma once

/// @file
/// LensState: one setting of a camera's lens, commanded and told back.

#include <mutex>
#include <string>

#include "hardware/drivers/rosbridge/joint_history.h"
#include "hardware/drivers/rosbridge/linked_device.h"

namespace longarm::hardware {

/// A number the robot takes on one topic and tells on another, on change and a few times a second.  It comes without a
/// stamp, so that its time is that of its arrival.  Thread-safe.
class LensState {
 public:
  /// @param what  "zoom", "focus": for messages
  LensState(std::string camera, std::string what, std::string command_topic, std::string state_topic);

  void connect(Connection& link);
  void disconnect(Connection& link);

  /// @param wanted  0 ... 1, or negative where that means something to the camera
  Status command(Connection& link, double wanted, double now_s);
  Result<double> newest() const;
  /// Interpolated; after the newest it holds for a second.
  Result<double> at(double stamp_s) const;
  /// Sends it to where it is if a command of the last seconds is not reached.
  void halt(Connection& link, double now_s);

 private:
  Status take(const rosbridge::Publish& message, double received_s);

  const std::string m_camera, m_what, m_command_topic, m_state_topic;
  mutable std::mutex m_mutex;
  JointHistory m_history;
  double m_newest_s = -1, m_newest = 0;
  double m_wanted = 0, m_commanded_s = -1e9;
  std::uint64_t m_subscription = 0;      // life cycle's thread only
};

}  // namespace longarm::hardware
