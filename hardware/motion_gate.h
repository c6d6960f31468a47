#pragma once

/// @file
/// MotionGate: the one way to arm and base.  Refuses stale state, jumps, broken limits and unowned motion.

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/clock.h"
#include "core/motion.h"
#include "core/result.h"
#include "hardware/device.h"

namespace longarm::hardware {

struct GateOptions {
  double max_state_age_s = 0.2;          ///< Joint state older than this refuses motion.
  double max_start_error = 0.02;         ///< Start from rest against the measured joints [rad or m].
  double max_continuation_error = 0.005; ///< Start in motion against the commanded position [rad or m].
  double max_velocity_jump = 0.05;       ///< Start against the commanded velocity [rad/s or m/s].
  double max_start_offset_s = 0.25;      ///< Between now and the horizon's start, either way.
  double max_horizon_s = 0.5;            ///< Longest horizon (STOP excepted).
  double min_point_spacing_s = 1e-4;     ///< Least time between two points.
  double limit_margin = 0;               ///< Kept from the position limits [rad or m].
  double max_tracking_error = 0.10;      ///< Measured against commanded, held for tracking_time_s: stop [rad or m].
  double tracking_time_s = 0.1;
};

/// What the gate asks of the room it knows nothing of.  Called on the thread that submits, in the order of the
/// arm's joints; an exception refuses the horizon.  Left empty: not checked.
struct GateChecks {
  std::function<Eigen::Vector3d(const Eigen::VectorXd& q)> tool_position;   ///< In the root link [m].
  double max_tool_speed = std::numeric_limits<double>::infinity();          ///< [m/s]
  std::function<double(const Eigen::VectorXd& q)> clearance;                ///< To the nearest obstacle [m].
  double min_clearance = 0;                                                 ///< [m]
};

/// Everything the gate knows; a copy for displays.
struct GateStatus {
  bool stopped = true;                   ///< STOP is latched; reset() lets motion through again.
  std::string reason;                    ///< Why it is stopped, or why it refused last.
  std::string source;                    ///< Who stopped it ("operator", "link", "watchdog", ...).
  std::string owner;                     ///< Who may move the arm, empty: nobody.
  std::uint64_t accepted = 0, refused = 0;
};

/// Thread-safe.  stop() takes no lock that a planner, logger or window could hold: the only one it shares is held
/// elsewhere for copying a few pointers, never across a call, a wait or I/O.
class MotionGate {
 public:
  /// STOP is latched at first.  @pre limits have one entry per joint
  MotionGate(std::shared_ptr<RobotArm> arm, std::vector<std::string> joints, MotionLimits limits,
             const Clock& clock, GateOptions options = {}, GateChecks checks = {});
  ~MotionGate();

  /// Takes the arm for one owner; kRefused when another has it or STOP is latched.  Again by the same: no effect.
  Status acquire(const std::string& owner);
  /// Gives it back; no effect when somebody else has it.  What was sent is finished.
  void release(const std::string& owner);

  /// Checks a horizon and passes it on.  kRefused / kStale / kOutOfLimits / kInvalidInput with joint and value;
  /// whatever is refused is not sent, and the arm finishes the horizon it has.
  /// Beyond checkHorizon(): ownership, growing sequence, start time near now, fresh joint state, start that
  /// continues what is commanded in position and velocity (or, from rest, the measured joints), `checks`.
  Status submit(const Horizon& horizon);

  /// A base that the gate also guards; without one drive() is refused.  Call before anything moves.
  void setBase(std::shared_ptr<MobileBase> base, const BaseLimits& limits);
  /// Checks a velocity and passes it on.  Arm and base have one owner between them, so that one stands while
  /// the other moves.  kRefused: no base, no owner, STOP latched, the arm still moves; kStale: odometry older
  /// than max_state_age_s; else as checkTwist().  Stopping (a twist of zero) by the owner is never refused
  /// for staleness.
  Status drive(const std::string& owner, const BaseTwist& twist);
  /// Whether the base moves, or was told to within the last quarter of a second.
  bool driving() const;

  /// Compares measured with commanded joints and stops when they are apart for too long.  submit() does it, too;
  /// call it in every cycle of the motion thread so that it also holds when nothing is sent.
  void watch();

  /// STOP: latches, brakes at stop_deceleration along the path from the last commanded state, takes the arm from
  /// its owner.  Never fails, never waits.  The first source and reason stay until reset().
  void stop(const std::string& source, const std::string& reason) noexcept;
  /// Lets motion through again; moves nothing.  Makes the arm active if it is idle.  kRefused while it still
  /// brakes, or the arm is closed or in fault.
  Status reset();

  GateStatus status() const;
  bool stopped() const;
  /// Last commanded joint state at `now`, extrapolated along the horizon in force; measured if none (kStale when
  /// there is no measured state either).  `t` of the answer is `now`.
  Result<TrajectoryPoint> commandedAt(double now_s) const;
  /// Called on every STOP, from the thread that stopped.
  void onStop(std::function<void(const std::string& source, const std::string& reason)> callback);

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::hardware
