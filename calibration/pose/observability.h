#pragma once

/// @file
/// What a set of observations cannot tell, in figures and in words.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"

namespace longarm::calibration {

struct Observability {
  Eigen::VectorXd figures;         ///< Singular values of the column-scaled Jacobian over the largest, largest first.
  Eigen::VectorXd null_direction;  ///< The weakest direction, as an increment of the parameters.
  int rank = 0;                    ///< Figures above 1e-6.
};

/// From the information J^T J on the parameters.
Observability observabilityOf(const Eigen::MatrixXd& information);

/// A split increment of a transform as "a turn about the axis (..) through the point (..)" or "a shift along (..)",
/// in the transform's left-hand frame.
/// @param through A place where the points are, in that frame: a turn whose axis passes far from it is told as a shift.
std::string motionInWords(const Vector6d& increment, const Pose& T, const Eigen::Vector3d& through);

}  // namespace longarm::calibration
