#pragma once

/// @file
/// Boxes from triads: three edges that meet in a corner.

#include <vector>

#include "core/result.h"
#include "vision/sketch/feature.h"
#include "vision/stereo/triangulate.h"

namespace longarm::vision {

struct BoxOptions {
  double min_edge_px = 20;           ///< Each edge must be as long as this in two views.
  double min_volume = 0.3;           ///< Determinant of the unit edges.
  double min_length_sigmas = 3;      ///< An edge must be longer than this many of its own sigma.
};

/// Fits a box (corner, rotation, three lengths) to all picks of a triad, so that the right angles enter the estimate:
/// three to four times better lengths than from the free points for the same clicks.
/// @param vertices  Sightings of the common corner and of the three ends, two or more views each.
/// @param points    The same, triangulated freely.
/// @param feature   Its vertices are replaced by those of the box, unless the picks reject right angles (chi-square,
///   95 %): then they stay free, a warning says so, and BoxShape::is_box is false.
/// @returns kDegenerate: edges nearly in one plane, an edge too short in the pictures (it points at a camera), or no
///   longer than its uncertainty.  The message names edge and view and says what to do.  Pure function.
Status fitBox(const std::vector<std::vector<Sighting>>& vertices, const std::vector<TriangulatedPoint>& points,
              Feature* feature, const BoxOptions& options = {});

}  // namespace longarm::vision
