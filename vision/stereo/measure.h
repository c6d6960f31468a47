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
/// @returns the feature in the views' parent frame, or kInvalidInput (wrong number of vertices, and as
///   triangulate()), kDegenerate (as triangulate(); the message names the vertex), or kRefused for planes and
///   triads, which are not measured yet.  Pure function.
Result<Feature> measureFeature(const std::string& name, FeatureKind kind,
                               const std::vector<std::vector<Sighting>>& vertices,
                               const TriangulationOptions& options = {});

}  // namespace longarm::vision
