#pragma once

/// @file
/// MotionGate: the one way to the arm.  Refuses stale state, jumps, broken limits and unowned motion.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "core/clock.h"
#include "core/motion.h"
#include "core/result.h"
#include "hardware/device.h"

namespace longarm::hardware {

struct GateOptions {
  double max_state_age_s = 0.2;          ///< Joint state older than this refuses motion.
  double max_start_error = 0.05;         ///< Horizon start against the last commanded or measured state [rad or m].
  double max_horizon_s = 0.5;            ///< Longest horizon (STOP excepted).
  double max_tracking_error = 0.10;      ///< Measured against commanded, held for 0.1 s: stop [rad or m].
};

/// Everything the gate knows; a copy for displays.
struct GateStatus {
  bool stopped = true;                   ///< STOP is latched; release() lets motion through again.
  std::string reason;                    ///< Why it is stopped, or why it refused last.
  std::string source;                    ///< Who stopped it ("operator", "link", "watchdog", ...).
  std::string owner;                     ///< Who may move the arm, empty: nobody.
  std::uint64_t accepted = 0, refused = 0;
};

/// Thread-safe.  stop() takes no lock that a planner, logger or window could hold.
class MotionGate {
 public:
  MotionGate(std::shared_ptr<RobotArm> arm, std::vector<std::string> joints, MotionLimits limits,
             const Clock& clock, GateOptions options = {});
  ~MotionGate();

  /// Takes the arm for one owner; kRefused when another has it or STOP is latched.
  Status acquire(const std::string& owner);
  void release(const std::string& owner);

  /// Checks a horizon and passes it on.  kRefused / kStale / kOutOfLimits / kInvalidInput with joint and value;
  /// whatever is refused is not sent, and the arm finishes the horizon it has.
  Status submit(const Horizon& horizon);

  /// STOP: latches, brakes at stop_deceleration from the last commanded state.  Never fails, never waits.
  void stop(const std::string& source, const std::string& reason) noexcept;
  /// Lets motion through again; moves nothing.
  Status reset();

  GateStatus status() const;
  /// Last commanded joint state at `now`, extrapolated along the horizon in force; measured if none.
  Result<TrajectoryPoint> commandedAt(double now_s) const;
  /// Called on every STOP, from the thread that stopped.
  void onStop(std::function<void(const std::string& source, const std::string& reason)> callback);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::hardware
