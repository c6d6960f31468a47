#pragma once

/// @file
/// Which boxes are near one box: the first look of the collision check, many at a time.  Private to planning/collision.

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace longarm::planning::internal {

/// Boxes along the root's axes in single precision, number by number, filled up with far ones to a multiple of 16.
struct Boxes {
  std::vector<float> x, y, z;            ///< Middles [m].
  std::vector<float> half_x, half_y, half_z;

  void resize(std::size_t count);
  std::size_t padded() const { return x.size(); }
  void set(std::size_t i, const Eigen::Vector3d& center, const Eigen::Vector3d& half);
};

/// near[i] = 1 where box i may be within `reach` of box `of` [m] and `asked[i]` is 1, else 0.
/// @pre near and asked have padded() entries
void nearBoxes(const Boxes& boxes, std::size_t of, double reach, const unsigned char* asked, unsigned char* near);

}  // namespace longarm::planning::internal
