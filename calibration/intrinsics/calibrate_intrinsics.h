#pragma once

/// @file
/// Intrinsics of a camera from pictures of known points: boards, or anything else in a corners file.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "calibration/intrinsics/board_view.h"
#include "calibration/intrinsics/choose_lens.h"
#include "core/result.h"

namespace longarm::calibration {

struct IntrinsicsOptions {
  LensChoice lens;
  /// Leaves out views that do not belong (mis-detected or wrongly measured boards) and corners beyond 4 sigma.
  /// Without it every corner counts alike.
  bool robust = true;
};

/// How well one view fits.
struct ViewReport {
  std::string name;
  double rms_px = 0;                 ///< sqrt(sum |r|^2 / (2 n)) over all its corners, used or not.
  bool used = false;
  std::string why;                   ///< Of a view that is not used; else empty or a remark.
  int corners = 0, outliers = 0;     ///< Corners left out.
  Pose X_CK = Pose::Identity();      ///< Target in the camera.
  Matrix6d covariance = Matrix6d::Zero();  ///< Of the split increment of X_CK.
};

/// A calibrated camera.
struct IntrinsicsResult {
  vision::CameraModel camera;
  LensMask estimated;                ///< Which parameters were estimated; the others are zero.
  double rms_px = 0;                 ///< sqrt(sum |r|^2 / (2 n)) over the corners used: per component.
  double sigma_px = 0;               ///< The same over the degrees of freedom: the noise of one coordinate.
  LensMatrix covariance = LensMatrix::Zero();  ///< Of the ten parameters; zero where not estimated.
  Eigen::Matrix<double, kLensParameters, 6> lens_pose = Eigen::Matrix<double, kLensParameters, 6>::Zero();
                                     ///< Covariance of the lens against the first used view's X_CK.
  LensMatrix information = LensMatrix::Zero();  ///< Inverse of the covariance over the estimated ones.
  std::vector<ViewReport> views;     ///< In the order given.
  int iterations = 0;
  std::vector<std::string> warnings;
};

/// Estimates the camera and the target's pose in each view.
/// @param width, height Of the pictures [px]; 0 where unknown.
/// @returns
///   - kInvalidInput: a pixel outside the picture or a coordinate that is not finite (the message names view and line);
///   - kDegenerate: the views do not determine the camera (too few, all parallel to the picture, ...).
/// Few, similar or badly spread views are told in `warnings`.  Pure function.
Result<IntrinsicsResult> calibrateIntrinsics(const std::vector<BoardView>& views, int width, int height,
                                             const IntrinsicsOptions& options = {});

}  // namespace longarm::calibration
