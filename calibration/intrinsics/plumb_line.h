#pragma once

/// @file
/// Distortion from lines that are straight in the world and bent in the picture.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/solve/lens_parameters.h"
#include "core/result.h"

namespace longarm::calibration {

/// Points along one straight edge, raw pixels.
using PlumbLine = std::vector<Eigen::Vector2d>;

struct PlumbLineResult {
  vision::CameraModel camera;                      ///< Focal lengths and principal point as given.
  int coefficients = 0;                            ///< How many of k1 k2 p1 p2 were estimated.
  double rms_before_px = 0, rms_px = 0;            ///< Of the distances of all points from the images of their lines.
  double sigma_px = 0;                             ///< Noise of a point across its line.
  LensMatrix covariance = LensMatrix::Zero();      ///< Of the coefficients, all else taken as exact.
  std::vector<double> line_rms_px;                 ///< One per line.
  int iterations = 0;
  std::vector<std::string> warnings;
};

/// Distance of each point from the image of the straight line that fits its set best [px], signed.  Empty where a point has
/// no ray through this lens.  @pre Two points or more.
std::vector<double> straightness(const vision::CameraModel& camera, const PlumbLine& line);

/// Finds the distortion that makes the lines straight (after D. C. Brown, "Close-range camera calibration", Photogrammetric
/// Engineering 37(8), 1971).  Lines through the middle of the picture tell nothing of k1 and k2.
/// @param start Focal lengths and principal point, which the lines cannot tell, and where the search begins.
/// @param coefficients 1 (k1), 2 (k1 k2) or 4 (k1 k2 p1 p2).
/// @returns kInvalidInput (another number of coefficients), kDegenerate: too few lines or points (a line needs three), or
///   lines that do not determine the coefficients.  Pure function.
Result<PlumbLineResult> straightenLines(const vision::CameraModel& start, const std::vector<PlumbLine>& lines, int coefficients);

}  // namespace longarm::calibration
