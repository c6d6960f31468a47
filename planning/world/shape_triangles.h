#pragma once

/// @file
/// Triangles of shapes, for whoever draws or exports them without a renderer.

#include <memory>

#include "planning/world/shape.h"

namespace longarm::planning {

/// Vertices in the shape's own frame [m], triangles counter-clockwise from outside.  A mesh is given as it is, an absent
/// one without triangles.
/// @param around Sides of a cylinder or sphere, 3 or more.
/// Pure function.
std::shared_ptr<const TriangleMesh> trianglesOf(const Shape& shape, int around = 32);

}  // namespace longarm::planning
