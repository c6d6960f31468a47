#pragma once

/// @file
/// A picture made ready for matching: grey, in floats, with its noise.

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "core/result.h"

namespace longarm::vision {

/// Value and derivatives of a picture between its pixels.
struct GreySample {
  float value = 0, du = 0, dv = 0;       ///< [grey levels], [grey levels/px]
};

/// Immutable once made; copies share the pixels.  Const members are thread-safe.
class MatchPicture {
 public:
  /// @param image 8-bit grey or BGR.
  /// @returns kInvalidInput for an empty picture or another kind of pixel.  Never throws.
  static Result<MatchPicture> from(const cv::Mat& image);

  int width() const { return m_grey.cols; }
  int height() const { return m_grey.rows; }
  /// Standard deviation of the pixel noise of the picture as taken [grey levels], at least 0.5.
  double noise() const { return m_noise; }
  /// What smoothing has left of it.
  double noiseLeft() const { return m_noise_left; }
  /// The same picture blurred by a Gaussian of `sigma_px`, for comparing with a coarser one.
  MatchPicture blurred(double sigma_px) const;
  const cv::Mat& grey() const { return m_grey; }          ///< CV_32FC1

  /// Bilinear; beyond the edge the edge's pixel is repeated.
  float linear(float u, float v) const;
  /// Bicubic (Catmull-Rom) with its exact derivatives.
  GreySample cubic(float u, float v) const;

 private:
  cv::Mat m_grey;
  double m_noise = 0.5, m_noise_left = 0.5;
};

}  // namespace longarm::vision
