#pragma once

/// @file
/// How far the uncertainty of a lens moves pixels: the heat map over the picture.

#include <vector>

#include <Eigen/Core>

#include "calibration/solve/lens_parameters.h"
#include "core/result.h"

namespace longarm::calibration {

/// One sigma of the place of a ray at infinity, over a grid of the picture.
struct LensUncertainty {
  int columns = 0, rows = 0;
  std::vector<Eigen::Vector2d> pixels;   ///< (rows * columns), row by row; the first and last lie on the picture's rim.
  std::vector<double> sigma_px;          ///< Per component; -1 where the lens has no inverse.
  double mean_px = 0, max_px = 0;        ///< Over the places with a value.

  /// The same for a point square to the axis at a distance [m], through focal length f [px].
  static double millimetres(double sigma_px, double depth_m, double focal_px) { return 1e3 * sigma_px * depth_m / focal_px; }
};

/// First-order propagation of the lens covariance.  What a turn of the camera explains is taken out, because pose and
/// lens trade it between them and every use of a camera estimates or calibrates its pose too.
/// @returns kInvalidInput for a camera of unknown size or fewer than 2 columns or rows; kDegenerate where no place of
///   the grid has a ray.  Pure function.
Result<LensUncertainty> lensUncertainty(const vision::CameraModel& camera, const LensMatrix& covariance, int columns = 33,
                                        int rows = 25);

}  // namespace longarm::calibration
