#pragma once

/// @file
/// What light and sensors do to a picture.

#include <opencv2/core/mat.hpp>

namespace longarm::virtual_robot {

/// Image noise from a bank of normal numbers made once; a seed chooses where in the bank a picture's noise begins.
/// Thread-compatible.
class NoiseBank {
 public:
  /// Adds noise of `sigma` grey levels to an 8-bit BGR picture; nothing at 0.
  void addTo(cv::Mat& picture, double sigma, unsigned seed);

 private:
  cv::Mat m_bank;                        // CV_16SC3, kScale per sigma
};

/// A lamp shining into the lens: a burnt-out spot in the upper part and a veil over everything.  8-bit BGR.
void addGlare(cv::Mat& picture);
/// As with the lens cap on: hardly anything is left.  8-bit BGR.
void darken(cv::Mat& picture);

}  // namespace longarm::virtual_robot
