#pragma once

/// @file
/// Solving the transform loop for what is unknown in it.

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calibration/intrinsics/choose_lens.h"
#include "calibration/pose/loop_model.h"
#include "calibration/pose/transform_loop.h"
#include "core/result.h"

namespace longarm::calibration {

struct LoopOptions {
  std::vector<LoopUnknown> unknowns;       ///< The first is the one asked for.
  /// Starts of T_ext, T_dev, T_obj; one more start beside those found from nothing, never the only one.
  std::array<std::optional<Pose>, 3> starts;
  /// Of several poses that fit, the one that the operator recognised: the answer is the optimum beside it, and the others are
  /// the alternatives.  For a single unknown transform only; as LoopResult::T.
  std::optional<Pose> chosen;
  bool has_camera_start = true;            ///< Whether LoopProblem::camera holds intrinsics.
  std::optional<double> sigma_px;          ///< Pick noise per axis; else estimated from the residuals [px].
  std::optional<KinPrior> kin_prior;       ///< Lets T_kin of each view err; needs sigma_px (0.5 otherwise).
  LensChoice lens;                         ///< For kIntrinsics.
  bool robust = true;                      ///< Leaves out observations that do not belong.
};

/// What became of one correspondence.
struct LoopObservation {
  int view = 0, point = 0;                 ///< Index in the problem.
  Eigen::Vector2d residual_px = Eigen::Vector2d::Zero();  ///< Measured minus projected.
  double leverage = 0;                     ///< 0 ... 1 per component on average: 1 means it alone decides something.
  double leave_one_out_px = 0;             ///< Length of its residual if it had not been used.
  bool used = true;
};

/// Another pose that fits about as well.
struct LoopAlternative {
  Pose T;
  double rms_px = 0;
};

struct LoopResult {
  std::array<Pose, 3> T = {Pose::Identity(), Pose::Identity(), Pose::Identity()};  ///< T_ext, T_dev, T_obj; as solved.
  vision::CameraModel camera;
  LensMask lens;                           ///< What was estimated of it.
  /// Of the unknowns in the order of LoopOptions::unknowns: split increments of each transform, the free lens
  /// parameters for kIntrinsics.
  Eigen::MatrixXd covariance;
  Eigen::VectorXd observability;           ///< Six figures per transform; see Observability::figures.
  std::string weakest;                     ///< The least certain motion in words.
  double rms_px = 0;                       ///< Per component, of the observations used.
  double sigma_px = 0;                     ///< Noise per component that the covariance assumes.
  double reduced_chi2 = 0;                 ///< Cost in units of sigma_px^2 over the degrees of freedom.
  int iterations = 0;
  std::vector<LoopObservation> observations;   ///< By view and point, in the problem's order.
  std::vector<LoopAlternative> alternatives;   ///< Of a single unknown transform; best first, without the answer.
  std::vector<std::string> warnings;
};

/// @returns
///   - kInvalidInput: unknowns given twice or none, a value that is not finite;
///   - kDegenerate: the observations do not determine the unknowns; the message says which motion is free, in words;
///     mirrored coordinates and swapped labels too;
///   - kNoSolution: nothing fits.
/// The result does not depend on the order of views and points beyond rounding.  Pure function.
Result<LoopResult> solveLoop(const LoopProblem& problem, const LoopOptions& options);

}  // namespace longarm::calibration
