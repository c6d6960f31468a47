#pragma once

/// @file
/// Robust statistics of residuals.

#include <vector>

namespace longarm::calibration {

/// The middle value (mean of the two middle ones); 0 for none.
double median(std::vector<double> values);
/// Standard deviation per component from lengths of 2-vectors, by their median: unharmed by up to half outliers.
double sigmaFromLengths(const std::vector<double>& lengths);

/// Huber's loss of a residual vector's squared length; `weight` receives the factor of its normal equations.
double huberCost(double squared_length, double threshold, double* weight);

/// Variance of one residual component for scaling a covariance: sum / (dof - 2), the variance of Student's t, whose
/// expectation is honest (mean of error^2 / variance is 1) also for few residuals.  With dof <= 4 that does not
/// exist: the larger of sum / dof and `prior_sigma`^2 is taken.
double residualVariance(double sum_of_squares, int dof, double prior_sigma);

}  // namespace longarm::calibration
