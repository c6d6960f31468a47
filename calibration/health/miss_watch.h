#pragma once

/// @file
/// Whether a camera was knocked, from what is seen anyway: how far lines of sight pass each other, and known points.

#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace longarm::calibration {

/// One point picked freely (not along its epipolar curve) in pictures of two cameras.
struct MissSample {
  std::string camera_a, camera_b;
  double miss_px = 0;                    ///< Signed distance of the two lines of sight, in pixels at the point.
  double sigma_px = 0.7;                 ///< What picks and calibrations explain of it.
};

/// One point whose place is known, seen by one camera.
struct LandmarkSample {
  std::string camera;
  Eigen::Vector2d residual_px = Eigen::Vector2d::Zero();   ///< Picked minus predicted.
  double sigma_px = 0.7;                 ///< Per axis.
};

enum class HealthLevel { kUnknown, kGood, kDoubtful, kKnocked };

struct HealthLimits {
  /// Chance of calling a camera that was not touched doubtful, or knocked.
  double doubtful = 0.02, knocked = 0.002;
  double least_px = 1.0;                 ///< A mean offset below this is never called knocked: it does no harm.
  int least_samples = 2;                 ///< Fewer say nothing.
};

struct CameraHealth {
  HealthLevel level = HealthLevel::kUnknown;
  int samples = 0;
  double off_px = 0;                     ///< Length of the mean offset.
  std::string why;                       ///< A sentence for the operator; empty when good or unknown.
};

/// Judges every camera that has samples.  The mean offset and the scatter are each tested against what the stated
/// sigmas allow (chi-square).  A turn in the plane of the two lines of sight leaves no miss: only known points show it.
/// Where two cameras disagree and nothing else tells which, both are named.  Pure function.
std::map<std::string, CameraHealth> healthOf(const std::vector<MissSample>& misses, const std::vector<LandmarkSample>& landmarks,
                                             const HealthLimits& limits = {});

/// Value that chi-square with `dof` degrees of freedom exceeds with this probability (Wilson and Hilferty, PNAS 17, 1931;
/// within 2 % for dof >= 1 and 1e-4 <= probability <= 0.5).
double chiSquareLimit(int dof, double probability);

}  // namespace longarm::calibration
