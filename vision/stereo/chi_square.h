#pragma once

/// @file
/// Quantiles of the chi-square distribution, for tests of residuals.

#include <cmath>

namespace longarm::vision {

constexpr double kChi2Usual = 1.6449;    ///< Normal quantile of 95 %.
constexpr double kChi2Gross = 3.0902;    ///< Normal quantile of 99.9 %.

/// Approximate quantile of chi-square (Wilson & Hilferty, PNAS 17, 1931; within 0.5 % from 3 degrees of freedom up).
/// @pre degrees_of_freedom >= 1.  Pure function.
inline double chi2Limit(int degrees_of_freedom, double normal_quantile) {
  const double v = 2.0 / (9.0 * degrees_of_freedom);
  const double root = 1 - v + normal_quantile * std::sqrt(v);
  return degrees_of_freedom * root * root * root;
}

}  // namespace longarm::vision
