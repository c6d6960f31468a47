#pragma once

/// @file
/// SimulatedBase: drives as told, stops when nothing follows.

#include <atomic>
#include <mutex>
#include <string>

#include "core/clock.h"
#include "hardware/device_runner.h"

namespace longarm::hardware {

/// Reaches each velocity at once; its odometry is the truth.  Deterministic on a ManualClock.  Thread-safe.
class SimulatedBase final : public RunnerDevice<MobileBase> {
 public:
  static constexpr double kDeadline_s = 0.25;

  /// `clock` outlives the device.
  SimulatedBase(std::string name, BaseLimits limits, const Clock& clock);
  ~SimulatedBase() override;

  std::shared_ptr<const BaseState> odometry() const override;
  Status drive(const BaseTwist& twist) override;

  void injectFault(const std::string& why);
  void freeze(bool on);  ///< Tells nothing new, as a lost link does.
  /// Carries it elsewhere.
  void place(double x, double y, double yaw);

 protected:
  Status onStop() override;

 private:
  void advance() const;

  const BaseLimits m_limits;
  const Clock& m_clock;
  mutable std::mutex m_mutex;
  mutable BaseState m_state;
  double m_commanded_s = -1e9;
  std::shared_ptr<const BaseState> m_frozen;
};

}  // namespace longarm::hardware
