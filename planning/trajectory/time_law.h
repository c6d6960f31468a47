#pragma once

/// @file
/// Time laws: the fastest way along a path within limits, and a smoothed copy of it.

#include <vector>

#include <Eigen/Core>

namespace longarm::planning {

/// What one grid point of a path allows.
struct PathConstraint {
  Eigen::VectorXd dq, ddq;               ///< Derivatives of the joints by s.
  double max_speed = 1e9;                ///< Further cap on ds/dt, e.g. from the tool's speed.
};

/// Position along the path as a function of time: ds/dt squared is piecewise linear in s, so d2s/dt2 is piecewise
/// constant.  Starts and ends at rest.  Immutable value.
class TimeLaw {
 public:
  /// @param s        Grid, increasing.
  /// @param squared  (ds/dt)^2 at each grid point, >= 0, not zero at two neighbours.
  TimeLaw(std::vector<double> s, std::vector<double> squared);
  double duration() const { return m_t.back(); }

  struct State {
    double s = 0, ds = 0, dds = 0;
  };
  /// t is clamped to [0, duration()].
  State at(double t) const;
  /// The law averaged over a window of `window` seconds around t: acceleration becomes continuous, speeds and
  /// accelerations never exceed the largest within the window, both ends are still at rest.  Runs from t = 0 to
  /// duration() + window.
  State smoothedAt(double t, double window) const;
  const std::vector<double>& squaredSpeeds() const { return m_x; }

 private:
  struct Motion {
    double integral, s, ds;                      ///< Integral of s since t = 0; s; ds/dt.
  };
  Motion motionAt(double t) const;
  std::vector<double> m_s, m_x, m_t, m_integral;
};

/// Time-optimal law from rest to rest by reachability (Pham & Pham, "A new approach to time-optimal path
/// parameterization based on reachability analysis", T-RO 2018).
///
/// With x = (ds/dt)^2 and u = d2s/dt2, constant on each cell: |dq u + ddq x| <= a holds at both ends of each cell (the
/// paper's "interpolation" scheme), x <= (v / |dq|)^2 and x <= max_speed^2 at each point.
/// @pre at least two grid points; limits positive.
TimeLaw fastestTimeLaw(const std::vector<double>& s, const std::vector<PathConstraint>& constraints,
                       const Eigen::VectorXd& max_velocity, const Eigen::VectorXd& max_acceleration);

}  // namespace longarm::planning
