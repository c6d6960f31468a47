#pragma once

/// @file
/// Points from picks in two or more views, by maximum likelihood, with covariance.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/snapshot/view.h"
#include "vision/stereo/calibration_effect.h"

namespace longarm::vision {

/// One pick.  `view` is borrowed and must outlive the call.
struct Sighting {
  const View* view = nullptr;
  Eigen::Vector2d pixel;             ///< Raw pixel.
  double sigma_px = 0;               ///< 0: the view's own sigma.
};

struct TriangulationOptions {
  double refuse_parallax = 0.3 * 0.017453292519943295;   ///< [rad], algorithms: "refuse, offer direction only".
  double warn_parallax = 1.0 * 0.017453292519943295;     ///< [rad]
  /// With three or more views: residuals beyond this many sigma count linearly (Huber), so that one wrong pick
  /// does less harm; 0 is plain least squares.  1.345 keeps 95 % efficiency.
  double huber_sigmas = 0;
};

/// A measured point Q.
struct TriangulatedPoint {
  Eigen::Vector3d xyz;                          ///< In the views' parent frame [m].
  Eigen::Matrix3d covariance;                   ///< Pick noise plus the views' calibration [m^2].
  double miss_m = 0;                            ///< Largest distance between any two viewing rays near Q [m].
  double reprojection_rms_px = 0;               ///< sqrt(sum |r|^2 / (2 N)) over N views.
  double parallax = 0;                          ///< Largest angle between two rays [rad].
  std::vector<CalibrationEffect> effects;       ///< Of every calibration whose covariance is known.
  std::vector<std::string> warnings;
};

/// Covariance between two points that share views: what their common calibration does to both [m^2].
Eigen::Matrix3d crossCovariance(const TriangulatedPoint& a, const TriangulatedPoint& b);

/// Finds the point that makes the picks most likely.
/// @returns kInvalidInput (fewer than two views, different parents, pick not finite or with no ray), or
///   kDegenerate (rays parallel within refuse_parallax, point behind a camera; the message names the view).
/// Pure function.
Result<TriangulatedPoint> triangulate(const std::vector<Sighting>& sightings,
                                      const TriangulationOptions& options = {});

}  // namespace longarm::vision
