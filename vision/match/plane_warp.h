#pragma once

/// @file
/// How the neighbourhood of a pick looks in another view, for an assumed depth.

#include <optional>

#include <Eigen/Core>

#include "vision/snapshot/view.h"

namespace longarm::vision::internal {

/// Maps pixels around a place of the second view to pixels around the pick, to first order.
struct LocalWarp {
  Eigen::Vector2d from, to;             ///< The pick and its image [px].
  Eigen::Matrix2d from_by_to = Eigen::Matrix2d::Identity();

  /// How many pixels of `to` a pixel of `from` becomes, by length.
  double magnification() const;
};

/// Warps induced by planes that face both cameras (normal half-way between the optical axes; Hartley & Zisserman,
/// Multiple View Geometry, 13.1), through both lenses.
class PlaneWarp {
 public:
  /// @pre `pixel` has a ray in `from`; the views share a parent.
  PlaneWarp(const View& from, const Eigen::Vector2d& pixel, const View& to);

  /// For the pick at depth z in the first camera; nothing where the place or its neighbourhood cannot be seen.
  std::optional<LocalWarp> at(double depth) const;

 private:
  std::optional<Eigen::Vector2d> fromPixel(const Eigen::Vector2d& to_pixel, const Eigen::Vector3d& through) const;

  const View& m_from;
  const View& m_to;
  Eigen::Vector2d m_pixel;
  Eigen::Vector3d m_ray, m_normal;      // in the parent; the ray has z = 1 in the first camera
};

}  // namespace longarm::vision::internal
