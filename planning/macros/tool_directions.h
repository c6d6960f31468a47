#pragma once

/// @file
/// Directions and orientations to try, nearest to the wanted one first.

#include <vector>

#include <Eigen/Core>

namespace longarm::planning {

/// A unit direction and how many rings of tilt it lies from the wanted one.
struct ToolDirection {
  Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  int ring = 0;
};

/// The axis, then rings around it every `step` up to `most` [rad], eight directions each, by ring.
std::vector<ToolDirection> directionsAround(const Eigen::Vector3d& axis, double most, double step = 15 * 3.14159265358979323846 / 180);

/// 0, +step, -step, +2 step ... up to `most`, both included [rad].
std::vector<double> anglesAround(double most, double step);

}  // namespace longarm::planning
