#pragma once

/// @file
/// SimulatedImu: tells the attitude that it was given.

#include <mutex>
#include <string>

#include "core/clock.h"
#include "hardware/device_runner.h"

namespace longarm::hardware {

/// Deterministic on a ManualClock.  Thread-safe.
class SimulatedImu final : public RunnerDevice<Imu> {
 public:
  /// `clock` outlives the device.
  SimulatedImu(std::string name, const Clock& clock);
  ~SimulatedImu() override;

  std::shared_ptr<const Attitude> attitude() const override;

  /// @param up  Against gravity, in the sensor's frame; any length but 0.
  void tilt(const Eigen::Vector3d& up);
  void freeze(bool on);  ///< Tells nothing new, as a lost link does.

 private:
  const Clock& m_clock;
  mutable std::mutex m_mutex;
  Eigen::Vector3d m_up = Eigen::Vector3d::UnitZ();
  std::shared_ptr<const Attitude> m_frozen;
};

}  // namespace longarm::hardware
