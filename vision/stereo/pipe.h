#pragma once

/// @file
/// Pipes by their outlines: a round bar has no edges of its own, but two outlines in every picture.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/sketch/feature.h"
#include "vision/stereo/triangulate.h"

namespace longarm::vision {

/// The two outlines of a pipe in one view, two picks on each, raw pixels.
struct PipeSighting {
  const View* view = nullptr;
  Eigen::Vector2d first_a, first_b;      ///< On one outline, well apart.
  Eigen::Vector2d second_a, second_b;    ///< On the other; the direction may be the opposite one.
};

/// Axis and radius.  Each outline spans a tangent plane with its camera; the axis lies in the bisector plane of a view's
/// two.  The meeting of two views' bisector planes starts a reprojection-optimal fit of all outlines.
/// @param sightings Two or more views.  The axis is cut where the first view's picks end.
/// @returns a line feature with PipeShape, or kInvalidInput (fewer than two views, picks off the picture, too near to each
///   other, without a ray), or kDegenerate (outlines coincide, axis along the baseline: see lineFromPlanes, behind a
///   camera).  A spread of the radii beyond the noise is a warning.  Pure function.
Result<Feature> estimatePipe(const std::string& name, const std::vector<PipeSighting>& sightings);

}  // namespace longarm::vision
