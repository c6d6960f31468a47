#pragma once

/// @file
/// Starts for the unknowns of the loop, from nothing or from what the operator placed.

#include <vector>

#include "calibration/pose/loop_model.h"
#include "calibration/pose/single_pose.h"
#include "calibration/pose/solve_loop.h"
#include "core/result.h"

namespace longarm::calibration {

/// The unknowns that are transforms.
std::vector<LoopUnknown> unknownPoses(const LoopOptions& options);

/// Where the search begins: states (the intrinsics included) in the order in which they should be tried, and for one
/// unknown transform its distinct minima.
struct LoopStarts {
  std::vector<LoopState> states;
  std::vector<PoseFit> minima;                  ///< Of a single unknown transform.
  std::vector<std::vector<bool>> agree;         ///< By view and point; empty when all are taken to agree.
};

/// @returns kInvalidInput (a start is needed and missing), kDegenerate or kNoSolution as findPoses.
Result<LoopStarts> loopStarts(const LoopProblem& problem, const LoopOptions& options);

/// The residual beyond which an observation does not belong [px].
/// @param lengths Residuals of all observations.
double outlierLimit(const std::vector<double>& lengths, const std::optional<double>& sigma_px);

}  // namespace longarm::calibration
