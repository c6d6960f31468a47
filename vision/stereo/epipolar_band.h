#pragma once

/// @file
/// How far off its epipolar curve a match may lie, and what clicks off it say about the calibration.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/stereo/epipolar.h"

namespace longarm::vision {

/// Standard deviation across the curve at each of its points, from the calibration of both views and the noise of the first
/// pick [px]; the band to draw is two of them to either side.
/// @returns kInvalidInput: pixel without a ray, different parents.  Pure function.
Result<std::vector<double>> epipolarBand(const View& from, const Eigen::Vector2d& pixel, const View& to, const EpipolarCurve& curve);

/// Signed distance by which two picks miss each other, in pixels (Sampson's: shared by both pictures in the way that moves
/// the picks least), through both lenses.
/// @returns kInvalidInput (a pixel without a ray, different parents), or kDegenerate (both views from one place).
Result<double> epipolarMiss(const View& a, const Eigen::Vector2d& pixel_a, const View& b, const Eigen::Vector2d& pixel_b);

/// Running statistics of the misses of one pair of cameras: a knocked camera shows here first.
class MissStatistic {
 public:
  explicit MissStatistic(double warn_rms_px = 3) : m_warn_rms_px(warn_rms_px) {}

  void add(double miss_px);
  int count() const { return m_count; }
  double rmsPx() const;                  ///< 0 before the first.
  double meanPx() const;                 ///< Signed: a camera that tilted shows a mean, poor picks do not.
  /// A sentence for the operator, or nothing while fewer than three picks were made or their RMS is within the limit.
  std::string warning() const;

 private:
  double m_warn_rms_px;
  int m_count = 0;
  double m_sum = 0, m_squares = 0;
};

}  // namespace longarm::vision
