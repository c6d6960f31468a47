#pragma once

/// @file
/// Pose of the right camera in the left one, from boards seen by both.

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "calibration/intrinsics/board_view.h"
#include "calibration/solve/lens_parameters.h"
#include "core/result.h"
#include "vision/camera/camera_file.h"

namespace longarm::calibration {

/// The same board at the same instant.
struct BoardPair {
  BoardView left, right;
};

struct StereoOptions {
  /// Refines the intrinsics of both cameras too (those that are not zero), which makes the covariance whole; else they
  /// are kept and their covariance, where the files hold it, is passed on.
  bool refine = false;
  bool robust = true;             ///< Leaves out pairs and corners that do not belong.
};

struct PairReport {
  std::string left, right;
  double rms_px = 0;              ///< Per component, both pictures.
  bool used = true;
  std::string why;
};

struct StereoResult {
  Pose X_LR = Pose::Identity();               ///< Right optical frame in the left one.
  Matrix6d covariance = Matrix6d::Zero();     ///< Of its split increment.
  vision::CameraModel left, right;            ///< As given, or refined.
  LensMatrix left_covariance = LensMatrix::Zero(), right_covariance = LensMatrix::Zero();  ///< When refined.
  LensMask left_mask, right_mask;
  double rms_px = 0, sigma_px = 0;
  int iterations = 0;
  std::vector<PairReport> pairs;
  std::vector<std::string> warnings;
};

/// @param pairs Corners are matched by their place on the board.  A chessboard may be numbered from either end in
///   either picture; the numbering on which the pairs agree is found.
/// @returns kDegenerate when no pair shows enough common corners or the pairs do not agree.  Pure function.
Result<StereoResult> calibrateStereo(const std::vector<BoardPair>& pairs, const vision::CameraFile& left,
                                     const vision::CameraFile& right, const StereoOptions& options = {});

}  // namespace longarm::calibration
