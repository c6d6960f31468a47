#pragma once

/// @file
/// ArmMotion: the arm's trajectory controller; where its motors are told to be at every instant.

#include <deque>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/motion.h"
#include "core/result.h"

namespace longarm::virtual_robot {

/// What a controller refuses a horizon for.
struct ArmMotionOptions {
  double latency_s = 0;                  ///< From receiving a command to acting on it.
  double max_jump = 0.02;                ///< Between where the arm is and where the horizon has it [rad or m].
  double max_horizon_s = 2;              ///< Longest horizon.
  double max_wait_s = 0.5;               ///< Latest start after its arrival.
  double max_bridge_s = 0.12;            ///< Longest way onto a horizon that does not quite continue the motion.
};

/// Follows horizons exactly.  A horizon replaces what is left of the one before from its start on, or from its arrival
/// when that is later; it is then followed on its own schedule from there, so that a late one does not lag.  The whole
/// motion runs latency_s behind its stamps, as behind a bus.  A horizon that does not quite continue the motion is
/// joined by a quintic within the velocity and stop limits; one that would need more than max_bridge_s is a jump and
/// is refused, and the arm keeps what it had.
///
/// Times are seconds of the robot's clock and must not decrease from call to call.  A pure function of the calls;
/// thread-compatible.
class ArmMotion {
 public:
  /// @param limits  hard limits of the joints; accelerations up to stop_deceleration are followed.
  /// @pre one start and one limit per joint
  ArmMotion(std::vector<std::string> joints, const Eigen::VectorXd& start, MotionLimits limits,
            const ArmMotionOptions& options = {});

  /// Takes a horizon that arrives at now_s; its start_s is on the robot's clock, 0: on arrival.  Its joints may come in
  /// any order.  @returns kInvalidInput (joints, sizes, numbers, times, not at rest at the end), kOutOfLimits, kStale
  /// (over before it arrived, or too far ahead), kRefused (a jump).
  Status accept(const Horizon& horizon, double now_s);
  /// Brakes along the path in force at the stop deceleration and drops what was to follow; acts latency_s later.
  void stop(double now_s);
  /// The same without latency: what the controller does by itself when its client is gone.
  void brake(double now_s);

  /// Commanded state at now_s; `t` of the answer is now_s.
  TrajectoryPoint commandedAt(double now_s) const;
  bool moving(double now_s) const;
  const std::vector<std::string>& joints() const { return m_joints; }

 private:
  struct Leg {
    Trajectory path;
    double start_s = 0;
  };

  Result<Trajectory> ordered(const Horizon& horizon) const;
  Status checkPoint(const TrajectoryPoint& point, std::size_t index) const;
  bool withinLimits(const Trajectory& bridge) const;
  Result<Trajectory> joined(const TrajectoryPoint& from, const Trajectory& path, double elapsed_s) const;
  void put(Leg leg, double now_s);
  void brakeFrom(double at_s, double now_s);

  const std::vector<std::string> m_joints;
  const MotionLimits m_limits;
  const ArmMotionOptions m_options;
  std::deque<Leg> m_legs;                // by start; the last one that has started is in force
};

}  // namespace longarm::virtual_robot
