#pragma once

/// @file
/// Least squares on picks: one solver for lines, boxes and pipes.

#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/result.h"
#include "vision/stereo/calibration_effect.h"

namespace longarm::vision::internal {

/// Residuals of all picks at one state, m rows; a pick gives two rows (a point) or one (across an edge).
struct FitRows {
  Eigen::VectorXd residual;               ///< (m) picked minus predicted [px].
  Eigen::VectorXd sigma;                  ///< (m) pick noise [px].
  Eigen::MatrixXd d_state;                ///< (m x n) d predicted / d state.
  Eigen::MatrixXd d_pose;                 ///< (m x 6) d predicted / d pose of the row's view.
  Eigen::MatrixXd d_intrinsics;           ///< (m x 10) d predicted / d intrinsics of the row's camera.
  std::vector<const View*> views;         ///< (m)

  void resize(int rows, int states);
};

struct FitProblem {
  /// @returns kDegenerate where a pick cannot be predicted (behind a camera).
  std::function<Result<FitRows>(const Eigen::VectorXd& state)> rows;
  /// The state moved by a small step; the state may have more numbers than the step (rotations).
  std::function<Eigen::VectorXd(const Eigen::VectorXd& state, const Eigen::VectorXd& step)> plus;
};

struct FitResult {
  Eigen::VectorXd state;
  FitRows rows;                                ///< At `state`.
  Eigen::MatrixXd picks_covariance;            ///< (n x n) of a step, from pick noise.
  std::vector<CalibrationEffect> effects;      ///< d step / d calibration.
  double chi2 = 0;                             ///< With the known calibration errors taken into account.
  int degrees_of_freedom = 0;

  /// From picks and calibration (n x n).
  Eigen::MatrixXd covariance() const;
  /// Root mean square of all residuals [px].
  double rmsPx() const;
};

/// Levenberg-Marquardt from a good start, the picks weighted by their noise.
/// @returns kDegenerate as `rows` does at the start, or where the picks do not determine the state.
Result<FitResult> fit(const FitProblem& problem, const Eigen::VectorXd& start);

}  // namespace longarm::vision::internal
