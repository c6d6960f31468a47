#pragma once

/// @file
/// Overlay shapes for what vision computes: epipolar curves, error ellipses, paths, features.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "vision/sketch/feature.h"
#include "vision/sketch/pointer_event.h"
#include "vision/snapshot/view.h"
#include "vision/stereo/epipolar.h"

namespace longarm::vision {

/// The curve, and a marker and a label ("0.5 m") at every depth tick.
void addEpipolarCurve(const EpipolarCurve& curve, Overlay* overlay);

/// The band of +- 2 sigma about the curve, as areas.  @param sigma_px One per point of the curve (epipolarBand).
void addEpipolarBand(const EpipolarCurve& curve, const std::vector<double>& sigma_px, Overlay* overlay);

/// Outline of the region of the picture that holds the point with 95 % probability (axes 2.448 sigma), as a
/// closed polyline of raw pixels; empty when the point cannot be seen.
std::vector<Eigen::Vector2d> errorEllipse(const View& view, const Eigen::Vector3d& xyz,
                                          const Eigen::Matrix3d& covariance, int samples = 48);

/// The box of a triad or the surface of a pipe; nothing for other features.
void addSolid(const Feature& feature, const View& view, OverlayRole role, Overlay* overlay);

/// A measured feature as the view sees it: edges, vertices and their 95 % ellipses, and its box or pipe.
void addFeature(const Feature& feature, const View& view, OverlayRole role, Overlay* overlay);

/// A path in the view's parent frame, as far as it can be seen.
void addPath(const std::vector<Eigen::Vector3d>& points_W, const View& view, OverlayRole role,
             Overlay* overlay);

}  // namespace longarm::vision
