#pragma once

/// @file
/// Lines from picks: matched ends, or the planes that a line spans with two cameras.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/sketch/feature.h"
#include "vision/stereo/triangulate.h"

namespace longarm::vision {

/// Two picks anywhere on a line in one view.
struct LineSighting {
  const View* view = nullptr;
  Eigen::Vector2d pixel_a, pixel_b;      ///< Raw pixels, well apart.
};

/// All that was marked of a line.
struct LinePicks {
  std::vector<Sighting> end0, end1;      ///< The same two ends, matched between views; either may be empty.
  std::vector<LineSighting> along;       ///< Views in which the line was marked somewhere.
};

/// The line that fits all of its picks: matched ends count in both directions, picks along the line only across it.
/// An end that was matched nowhere lies on the ray of the first view of `along` (its pixel_a for end 0, pixel_b for
/// end 1).  Reprojection-optimal; with picks along the line in two views alone this is the meeting of their planes.
/// @returns kInvalidInput as triangulate(); kDegenerate as triangulate(), or when an end hangs on the planes alone and
///   these meet at less than a sine of 0.08 (see lineFromPlanes).  Pure function.
Result<Feature> estimateLine(const std::string& name, const LinePicks& picks, const TriangulationOptions& options = {});

/// Line whose two ends were picked in two or more views each (algorithms: matched ends, independent of how
/// the line lies to the baseline).  Pick noise is independent between the ends; the pose covariance of a view
/// that saw both is common to them, so that it hardly changes the length: see Feature::cross_covariance.
/// @returns kInvalidInput as triangulate(), kDegenerate as triangulate() (the message says which end), or when
///   the two ends coincide.  Pure function.
Result<Feature> estimateLine(const std::string& name, const std::vector<Sighting>& end0,
                             const std::vector<Sighting>& end1, const TriangulationOptions& options = {});

/// An endless line, cut where the first view's two picks see it.
struct PlaneLine {
  Eigen::Vector3d point_a, point_b;      ///< In the parent frame [m], on the rays of the first view's picks.
  double quality = 0;                    ///< Sine of the angle between the two planes; errors grow as 1/quality.
};

/// Meets the two planes that a line spans with two cameras: for lines whose ends do not correspond.
/// @returns kDegenerate when quality < 0.08 (the line runs along the baseline: mark its ends instead, or move
///   the camera across the line), or when an end lies behind a camera; kInvalidInput as triangulate().
Result<PlaneLine> lineFromPlanes(const LineSighting& first, const LineSighting& second);

}  // namespace longarm::vision
