#pragma once

/// @file
/// Snap of a pick to the corner or edge it was meant for, to a fraction of a pixel.

#include <optional>

#include <Eigen/Core>

#include "vision/match/match_picture.h"

namespace longarm::vision {

enum class SnapKind { kCorner, kEdge };

struct SnapPoint {
  SnapKind kind = SnapKind::kCorner;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::Zero();   ///< Unit direction of the edge; zero for a corner.
};

struct SnapOptions {
  double radius_px = 6;                  ///< How far the pick may move.
  double min_contrast_sigmas = 5;        ///< Slopes weaker than this many of the picture's noise are none.
  bool corners = true, edges = true;
};

/// The corner within reach of the pick, else the nearest edge, else nothing.
///
/// Corners: where all grey slopes around meet best (Forstner & Gulch, ISPRS Intercommission Workshop, 1987), iterated;
/// edges: the steepest place across the slope, by a parabola.  Pure function.
std::optional<SnapPoint> snapPick(const MatchPicture& picture, const Eigen::Vector2d& pixel, const SnapOptions& options = {});

}  // namespace longarm::vision
