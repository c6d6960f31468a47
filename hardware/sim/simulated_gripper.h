#pragma once

/// @file
/// SimulatedGripper: opens and closes at constant speed, holds what is between its fingers.

#include <optional>
#include <string>

#include "core/clock.h"
#include "hardware/device_runner.h"
#include "hardware/sim/ramp.h"

namespace longarm::hardware {

/// Deterministic on a ManualClock.  Thread-safe.
class SimulatedGripper final : public RunnerDevice<Gripper> {
 public:
  /// Joint range and speed [m or rad, per s]; `clock` outlives the gripper.
  SimulatedGripper(std::string name, double closed, double open, double speed, const Clock& clock);
  ~SimulatedGripper() override;

  Status setOpening(double position) override;
  double position() const override;
  bool holding() const override;

  /// Puts something between the fingers that stops them at this position; nullopt takes it away.
  void setObject(std::optional<double> stops_at);
  void injectFault(const std::string& why);

 protected:
  Status onStop() override;

 private:
  const double m_closed, m_open;
  const Clock& m_clock;
  mutable std::mutex m_mutex;
  Ramp m_ramp;
  std::optional<double> m_object;
};

}  // namespace longarm::hardware
