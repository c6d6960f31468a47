#pragma once

/// @file
/// From the sightings of a sketch's vertices to a measured feature: the one entrance for tools and verbs.

#include <string>
#include <vector>

#include "core/result.h"
#include "vision/sketch/feature.h"
#include "vision/stereo/triangulate.h"

namespace longarm::vision {

/// Measures a sketch.
/// @param vertices One list of sightings per vertex, in the feature's vertex order; two or more views each.
/// @returns the feature in the views' parent frame, or kInvalidInput (wrong number of vertices, as
///   triangulate(), or a pick off its picture), or kDegenerate (as triangulate(), planeThrough() and fitBox());
///   the message names the vertex or edge and says what to do.  Pure function.
Result<Feature> measureFeature(const std::string& name, FeatureKind kind,
                               const std::vector<std::vector<Sighting>>& vertices,
                               const TriangulationOptions& options = {});

namespace internal {

/// A pick that is off its picture makes no feature: kInvalidInput naming place and view.
Status checkOnPicture(const Sighting& pick);
/// A vertex of a feature from its point.
FeatureVertex vertexOf(const TriangulatedPoint& point, const std::vector<Sighting>& sightings);

}  // namespace internal
}  // namespace longarm::vision
