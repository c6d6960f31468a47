#pragma once

/// @file
/// How well a feature is known against how well a macro needs it.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "vision/sketch/feature.h"

namespace longarm::planning {

/// 95 % along the worst direction of the worst vertex (1.96 sigma) [m]; 0 when no covariance is stated.
double uncertaintyOf(const std::vector<Eigen::Matrix3d>& covariances);
double uncertaintyOf(const vision::Feature& feature);

struct AccuracyVerdict {
  std::string go = "go";                 ///< "go" up to the need, "ask" up to three times it, "no_go" beyond.
  std::string note;                      ///< Why it is not "go", or that no uncertainty is stated; else empty.
};

/// Both in metres, 95 %.
AccuracyVerdict judgeAccuracy(double uncertainty, double need);

}  // namespace longarm::planning
