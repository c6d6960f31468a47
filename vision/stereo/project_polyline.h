#pragma once

/// @file
/// Paths in the world drawn into a picture, bent as its lens bends them.

#include <vector>

#include <Eigen/Core>

#include "vision/snapshot/view.h"

namespace longarm::vision {

struct ProjectionOptions {
  double near_m = 0.02;           ///< Nothing nearer than this (z in the camera) is drawn [m].
  double max_sag_px = 0.25;       ///< Chords deviate less than this from the true curve.
  double margin_px = 20;          ///< Pieces reach this far beyond the picture.
};

/// The visible pieces of a polyline, each a list of raw pixels in the order of the path.  Cut where the path
/// passes behind the camera, beyond the lens' monotone range, or outside the picture.  Pure function.
std::vector<std::vector<Eigen::Vector2d>> projectPolyline(const View& view,
                                                          const std::vector<Eigen::Vector3d>& points_W,
                                                          const ProjectionOptions& options = {});

}  // namespace longarm::vision
