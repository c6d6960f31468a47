#pragma once

/// @file
/// Distances of boxes, cylinders and spheres.  Private to planning/collision.

#include <optional>

#include <Eigen/Core>

#include "core/pose.h"
#include "planning/world/shape.h"

namespace longarm::planning::internal {

/// A box or cylinder about its origin, blown up on every side by `margin`; a sphere is a point with a margin.
struct Convex {
  enum class Kind { kPoint, kBox, kCylinder } kind = Kind::kPoint;
  Eigen::Vector3d half = Eigen::Vector3d::Zero();   ///< Box: half the edges; cylinder: radius, radius, half the length [m].
  double margin = 0;                                ///< [m]
};

/// Nothing for a mesh, and for sizes below 0.1 mm or not finite (fcl_shapes.h draws the same line).
std::optional<Convex> convexOf(const Shape& shape);

/// Distance of two bodies, at most `cap` [m] (a larger one may come back as anything >= cap); 0 when they touch.
///
/// Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex objects in three-dimensional
/// space", 1988.  What comes back is never more than the true distance but for rounding: it is the distance of two planes that
/// hold the bodies apart.  @returns nothing when it did not converge, which the caller asks somebody else.  Pure function.
/// @param axis  In: where to begin, the axis of the last time if the bodies have moved little; out: the axis they are held
///              apart along.  Any vector but zero will do.  Null: none.
std::optional<double> convexDistance(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, double cap,
                                     Eigen::Vector3d* axis = nullptr);

/// The same, coarser: above `limit` it need not be all of the distance, of two boxes or cylinders nine tenths.
std::optional<double> convexClearance(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, double cap, double limit,
                                      Eigen::Vector3d* axis = nullptr);

/// Whether the distance is at most `limit`; decided as soon as a bound tells.  Nothing as above.
std::optional<bool> convexWithin(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, double limit);

}  // namespace longarm::planning::internal
