#pragma once

/// @file
/// Levenberg-Marquardt for problems of arrow shape: a few shared parameters, and six of each view that no other
/// view sees.  Every calibration of this room is one of these.

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"

namespace longarm::calibration {

/// Normal equations H = [G W; W^T diag(B)] and gradient (g, b) of half the weighted sum of squares.
struct ArrowNormal {
  ArrowNormal(int globals, int blocks);
  void setZero();

  Eigen::MatrixXd G;                 ///< globals x globals
  Eigen::VectorXd g;                 ///< (globals)
  std::vector<Matrix6d> B;           ///< One per block.
  std::vector<Vector6d> b;
  std::vector<Eigen::MatrixXd> W;    ///< globals x 6 each
};

/// A change of all parameters.
struct ArrowStep {
  Eigen::VectorXd global;
  std::vector<Vector6d> blocks;
};

/// What is minimised.  Holds an accepted state and one on trial.
class ArrowModel {
 public:
  virtual ~ArrowModel() = default;
  virtual int globals() const = 0;
  virtual int blocks() const = 0;
  /// Fills the normal equations at the accepted state; gradient signs are those of J^T r with r = measured - model,
  /// so that the Gauss-Newton step is H^-1 g.  @returns the cost (sum of weighted squares).
  virtual double linearise(ArrowNormal* normal) = 0;
  /// Moves the trial state; its cost, or nothing where the model cannot be evaluated (a point behind a camera).
  virtual std::optional<double> costAfter(const ArrowStep& step) = 0;
  /// Makes the trial state the accepted one.
  virtual void accept() = 0;
};

struct ArrowOptions {
  int max_iterations = 100;
  /// Ends when the predicted decrease falls below this part of the cost.
  double relative_decrease = 1e-13;
  /// Or below this, whatever the cost [px^2 or sigma^2].
  double absolute_decrease = 1e-22;
};

struct ArrowOutcome {
  double cost = 0;                   ///< Sum of weighted squares at the end.
  int iterations = 0;                ///< Accepted steps.
  bool converged = false;
};

/// Gauss-Newton, damped (Marquardt) only after a step that failed.
ArrowOutcome minimise(ArrowModel& model, const ArrowOptions& options = {});

/// Inverse of the normal equations, by blocks; scale with the variance of one residual.
struct ArrowCovariance {
  Eigen::MatrixXd global;                    ///< globals x globals
  std::vector<Matrix6d> blocks;
  std::vector<Eigen::MatrixXd> cross;        ///< globals x 6: shared parameters against each block.
};
/// @returns nothing when the equations are singular.
std::optional<ArrowCovariance> inverseOf(const ArrowNormal& normal);

/// Information left about the shared parameters once every block is eliminated (Schur complement).
Eigen::MatrixXd reducedInformation(const ArrowNormal& normal);

}  // namespace longarm::calibration
