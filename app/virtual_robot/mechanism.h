#pragma once

/// @file
/// Mechanism: bodies that can only turn about a hinge or slide along a rail.

#include <vector>

#include "core/pose.h"
#include "planning/world/scenario.h"

namespace longarm::virtual_robot {

/// A door with its handle, a valve wheel, a drawer.  Its value is the angle or way from where it started [rad or m].
/// Thread-compatible.
class Mechanism {
 public:
  /// @param moves Indices of the objects it carries.
  Mechanism(planning::ScenarioMechanism spec, std::vector<std::size_t> moves);

  const planning::ScenarioMechanism& spec() const { return m_spec; }
  const std::vector<std::size_t>& moves() const { return m_moves; }
  bool carries(std::size_t object) const;
  double value() const { return m_value; }

  /// Motion of its bodies in the world from the start to a value.
  Pose motion(double value) const;
  /// Follows a hand: the point `grip_W` of a body at the start is wanted at `hand_W`; goes to the nearest value within
  /// its range.  @returns how far from the hand the point then is [m].
  double follow(const Eigen::Vector3d& grip_W, const Eigen::Vector3d& hand_W);

 private:
  double nearest(const Eigen::Vector3d& grip_W, const Eigen::Vector3d& hand_W) const;

  planning::ScenarioMechanism m_spec;
  std::vector<std::size_t> m_moves;
  double m_value = 0;
};

}  // namespace longarm::virtual_robot
