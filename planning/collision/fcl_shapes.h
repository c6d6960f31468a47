#pragma once

/// @file
/// Our shapes as FCL's.  Private to planning: heavy includes.

#include <memory>

#include <fcl/geometry/collision_geometry.h>

#include "planning/world/shape.h"

namespace longarm::planning::internal {

using FclGeometry = std::shared_ptr<fcl::CollisionGeometry<double>>;

/// A box, cylinder or sphere as a primitive, a mesh as a tree of oriented boxes.  Null for a shape below 0.1 mm, not
/// finite, or a mesh without triangles: such shapes make FCL's solvers fail and touch nothing.
FclGeometry toFcl(const Shape& shape);

/// Distance of two bodies, unsigned and at most `cap` [m] (a larger one may come back as anything >= cap); 0 when
/// they touch and when FCL fails in any way.  Thread-safe.
double fclDistance(const fcl::CollisionGeometry<double>& a, const Pose& X_A, const fcl::CollisionGeometry<double>& b,
                   const Pose& X_B, double cap);

/// Whether two bodies touch; true when FCL fails in any way.  Thread-safe.
bool fclTouch(const fcl::CollisionGeometry<double>& a, const Pose& X_A, const fcl::CollisionGeometry<double>& b,
              const Pose& X_B);

}  // namespace longarm::planning::internal
