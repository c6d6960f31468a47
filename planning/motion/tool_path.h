#pragma once

/// @file
/// Paths of the tool in space: straight lines and arcs, by length.

#include <vector>

#include "core/pose.h"

namespace longarm::planning {

/// Poses X_RT of the tool in the root frame, as a function of the way s in [0, length()] [m].
///
/// A piece that hardly moves the tool's origin counts 0.1 m of way per radian that it turns, so that s always grows.
/// Neighbouring pieces need not be tangent; whoever times the path decides what to do about corners.
/// Value type; const methods are thread-safe.
class ToolPath {
 public:
  explicit ToolPath(const Pose& start = Pose::Identity()) : m_start(start), m_end(start) {}

  /// Straight to a pose; the orientation takes the shortest turn.  A step of nothing is left out.
  ToolPath& lineTo(const Pose& X_RT);
  /// Straight to a point [m], orientation kept.
  ToolPath& lineTo(const Eigen::Vector3d& p_RT);
  /// About an axis by the right-hand rule.
  /// @param point, axis  In the root frame [m]; the axis is unit.  @param angle  [rad], either sign, not 0.
  /// @param turns_tool   Whether the tool turns rigidly with the arc, or keeps its orientation.
  ToolPath& arc(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle, bool turns_tool);

  bool empty() const { return m_pieces.empty(); }
  double length() const { return m_pieces.empty() ? 0 : m_pieces.back().from + m_pieces.back().length; }
  const Pose& start() const { return m_start; }
  const Pose& end() const { return m_end; }
  /// s is clamped to [0, length()].
  Pose at(double s) const;

  /// Values of s from 0 to length(), all ends of pieces among them, at most `step` [m] and `turn` [rad] apart.
  std::vector<double> stations(double step, double turn) const;

 private:
  struct Piece {
    double from = 0, length = 0;             ///< Way.
    double turn = 0;                         ///< Of the tool or of the direction of travel [rad].
    Pose X_start = Pose::Identity(), X_end = Pose::Identity();
    bool arc = false, turns_tool = false;
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), axis = Eigen::Vector3d::UnitZ();
    double angle = 0;
    Pose at(double share) const;
  };
  void append(Piece piece);

  Pose m_start, m_end;
  std::vector<Piece> m_pieces;
};

}  // namespace longarm::planning
