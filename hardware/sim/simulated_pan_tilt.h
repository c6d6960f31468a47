#pragma once

/// @file
/// SimulatedPanTilt: two axes at constant speed.

#include <string>

#include "core/clock.h"
#include "hardware/device_runner.h"
#include "hardware/sim/ramp.h"

namespace longarm::hardware {

/// Deterministic on a ManualClock.  Thread-safe.
class SimulatedPanTilt final : public RunnerDevice<PanTilt> {
 public:
  /// Reach either way of both axes [rad] and speed [rad/s]; `clock` outlives the device.
  SimulatedPanTilt(std::string name, double reach, double speed, const Clock& clock);
  ~SimulatedPanTilt() override;

  Status moveTo(double pan, double tilt) override;
  double pan() const override;
  double tilt() const override;
  bool moving() const override;

  void injectFault(const std::string& why);

 protected:
  Status onStop() override;

 private:
  const double m_reach;
  const Clock& m_clock;
  mutable std::mutex m_mutex;
  Ramp m_pan, m_tilt;
};

}  // namespace longarm::hardware
