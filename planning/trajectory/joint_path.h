#pragma once

/// @file
/// Geometric paths in joint space: where the joints go, without when.

#include <vector>

#include <Eigen/Core>

namespace longarm::planning {

/// A path at one parameter: joints and their first and second derivatives by s.
struct PathState {
  Eigen::VectorXd q, dq, ddq;
};

/// Twice continuously differentiable curve over s in [0, length()].  Immutable; thread-safe.
class JointPath {
 public:
  virtual ~JointPath() = default;
  virtual double length() const = 0;
  /// s is clamped to [0, length()].
  virtual PathState at(double s) const = 0;
  /// Grid on which the path is resolved well enough for time parameterisation: from 0 to length(), increasing.
  virtual std::vector<double> grid() const = 0;
};

/// Straight joint motions with rounded corners.
///
/// A corner is replaced, from `blend` before to `blend` after it, by the quintic Bezier curve whose control points are
/// the two ends, the two half-way points and twice the corner: it joins the lines with zero curvature, stays
/// inside the triangle of the three points and passes the corner at 0.11 |v - u| blend (u, v: directions).
class BlendedPolyline final : public JointPath {
 public:
  /// @param waypoints  At least two, neighbours apart.
  /// @param blends     One per inner waypoint, in joint-space length [rad]; clamped to just under half of the shorter
  ///                   neighbour segment and to at least 1e-4 of it.
  BlendedPolyline(std::vector<Eigen::VectorXd> waypoints, const std::vector<double>& blends);
  double length() const override { return m_length; }
  PathState at(double s) const override;
  std::vector<double> grid() const override;

 private:
  struct Piece {
    double start = 0, length = 0;
    bool corner = false;
    Eigen::VectorXd from, direction;             ///< Line.
    Eigen::VectorXd before, at, after;           ///< Corner: the triangle.
  };
  std::vector<Piece> m_pieces;
  double m_length = 0;
};

/// Natural cubic spline through waypoints at given parameters.
class SplinePath final : public JointPath {
 public:
  /// @pre at least two waypoints; parameters from 0, strictly increasing.
  SplinePath(std::vector<double> parameters, std::vector<Eigen::VectorXd> waypoints);
  double length() const override { return m_s.back(); }
  PathState at(double s) const override;
  std::vector<double> grid() const override;

 private:
  std::vector<double> m_s;
  std::vector<Eigen::VectorXd> m_q, m_second;    ///< Second derivative at each waypoint.
};

}  // namespace longarm::planning
