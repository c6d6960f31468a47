#include "calibration/solve/robust.h"

#include <algorithm>
#include <cmath>

namespace longarm::calibration {

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  const double upper = *middle;
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + *std::max_element(values.begin(), middle));
}

double sigmaFromLengths(const std::vector<double>& lengths) {
  return median(lengths) / 1.17741002251547;  // median of a Rayleigh distribution: sigma sqrt(2 ln 2)
}

double huberCost(double squared_length, double threshold, double* weight) {
  const double length = std::sqrt(squared_length);
  if (threshold <= 0 || length <= threshold) {
    *weight = 1;
    return squared_length;
  }
  *weight = threshold / length;
  return threshold * (2 * length - threshold);
}

double residualVariance(double sum_of_squares, int dof, double prior_sigma) {
  if (dof > 4) return sum_of_squares / (dof - 2);
  const double prior = prior_sigma * prior_sigma;
  return dof > 0 ? std::max(prior, sum_of_squares / dof) : prior;
}

}  // namespace longarm::calibration
