#pragma once

/// @file
/// RobotState: what the joint states of a connection tell, for all of its devices.

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "core/clock.h"
#include "core/latest_value.h"
#include "core/motion.h"
#include "hardware/drivers/rosbridge/clock_offset.h"
#include "hardware/drivers/rosbridge/connection.h"
#include "hardware/drivers/rosbridge/joint_history.h"

namespace longarm::hardware {

/// Subscribes to the joint states for its whole life.  Stamps given out are on the console's clock.  Thread-safe.
class RobotState {
 public:
  RobotState(std::shared_ptr<Connection> link, const std::string& topic);
  ~RobotState();

  /// Null before the first.
  std::shared_ptr<const JointState> newest() const { return m_newest.get(); }
  /// Interpolated; kStale outside the last seconds.
  Result<JointState> at(double stamp_s) const;
  /// Console's time = robot's time + offset [s].
  std::optional<double> offset() const;

  /// Newest position of one joint [rad or m]; kStale before the first, kNotFound for a joint the robot does not tell.
  Result<double> position(const std::string& joint) const;
  /// Its velocity as told, or else by its last 0.1 s [rad/s or m/s]; 0 when unknown.
  double velocity(const std::string& joint) const;

 private:
  Status take(const rosbridge::Publish& message, double received_s);

  const std::shared_ptr<Connection> m_link;
  LatestValue<JointState> m_newest;
  mutable std::mutex m_mutex;            // guards what follows
  ClockOffset m_offset;
  JointHistory m_history;
  std::uint64_t m_subscription = 0;
};

}  // namespace longarm::hardware
