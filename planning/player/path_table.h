#pragma once

/// @file
/// The loaded path as polynomials: derivatives by the path parameter, and whether a rate keeps the joint
/// limits.

#include <array>
#include <vector>

#include "core/motion.h"

namespace longarm::planning::internal {

/// Path q(tau) of a trajectory, with tau its own time.  Playing it at rate r = tau', u = tau'' moves the
/// joints at
///   velocity     q'(tau) r
///   acceleration q''(tau) r^2 + q'(tau) u.
/// Immutable; thread-compatible.
class PathTable {
 public:
  PathTable() = default;
  /// @pre validate(trajectory) and sizes of limits equal the trajectory's.
  PathTable(const Trajectory& trajectory, const MotionLimits& limits);

  double duration() const { return m_times.empty() ? 0 : m_times.back(); }
  /// Whether velocity and acceleration keep `share` of the limits.
  bool keepsLimits(double tau, double r, double u, double share) const;

 private:
  using Quintic = std::array<double, 6>;  // Coefficients of s^0 ... s^5, s from the segment's start.
  std::size_t segmentOf(double tau) const;

  std::vector<double> m_times;
  std::vector<Quintic> m_segments;  // Segment-major: [segment * joints + joint].
  std::vector<double> m_max_velocity, m_max_acceleration;
};

}  // namespace longarm::planning::internal
