#pragma once

/// @file
/// Joint states, limits, timed trajectories and the short horizons that are streamed to an arm.
/// Shared by the player (planning) and the gate (hardware), which know nothing of each other.

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"

namespace longarm {

/// Measured joints at one instant.
struct JointState {
  double stamp_s = 0;                ///< When it was measured, on the console's monotonic clock [s].
  std::vector<std::string> names;    ///< n joint names.
  Eigen::VectorXd positions;         ///< (n) [rad or m].
  Eigen::VectorXd velocities;        ///< (n) [rad/s or m/s]; may be empty.

  /// Position of a joint by name, or kNotFound.
  Result<double> position(const std::string& name) const;
  /// Positions of these joints in this order, or kNotFound naming the first that is missing.
  Result<Eigen::VectorXd> positionsOf(const std::vector<std::string>& wanted) const;
};

/// Limits of n joints, in the order of a trajectory's joint names.
struct MotionLimits {
  Eigen::VectorXd lower, upper;          ///< [rad or m]
  Eigen::VectorXd max_velocity;          ///< > 0 [rad/s or m/s]
  Eigen::VectorXd max_acceleration;      ///< > 0, for planned motion [rad/s^2 or m/s^2]
  Eigen::VectorXd stop_deceleration;     ///< >= max_acceleration, for STOP only
};

/// One instant of a trajectory or horizon.
struct TrajectoryPoint {
  double t = 0;                                        ///< [s]
  Eigen::VectorXd positions, velocities, accelerations;  ///< (n) each
};

/// A timed path: t starts at 0 and increases strictly; it begins and ends at rest.
struct Trajectory {
  std::vector<std::string> joint_names;
  std::vector<TrajectoryPoint> points;

  bool empty() const { return points.empty(); }
  double duration() const { return points.empty() ? 0 : points.back().t; }
  /// State at time t (clamped to the ends) by quintic Hermite interpolation of the two points around it.
  /// Passes through every point with its velocity and acceleration.
  /// @pre !empty()
  TrajectoryPoint sample(double t) const;
};

/// Whether a trajectory is well formed: names unique, sizes equal, all finite, t from 0 and strictly increasing,
/// at rest at both ends.  The message names joint, point and value.
Status validate(const Trajectory& trajectory);

/// A short piece of motion that ends at rest; the only thing that is ever sent to an arm.
struct Horizon {
  std::uint64_t sequence = 0;            ///< Increases with each horizon of one owner.
  std::string owner;                     ///< "player", "jog", "servo", "stop".
  double start_s = 0;                    ///< Monotonic time that t = 0 stands for.
  bool is_stop = false;                  ///< Braking at the STOP deceleration instead of the planned one.
  std::vector<std::string> joint_names;
  std::vector<TrajectoryPoint> points;   ///< t from 0; last velocity is zero.

  double duration() const { return points.empty() ? 0 : points.back().t; }
};

}  // namespace longarm
