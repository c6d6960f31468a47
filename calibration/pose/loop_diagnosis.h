#pragma once

/// @file
/// Why a transform loop cannot be solved, in sentences with the fix.

#include <string>

#include "calibration/pose/loop_model.h"
#include "calibration/pose/observability.h"
#include "calibration/pose/solve_loop.h"
#include "core/result.h"

namespace longarm::calibration {

/// The weakest direction of the unknowns: one phrase per transform that takes part, with its frame.
std::string weakestInWords(const LoopProblem& problem, const LoopOptions& options, const LoopModel& model, const Observability& seen);

/// kDegenerate: how many motions are seen, which is free, and what to add.
Error undetermined(const LoopOptions& options, const Observability& seen, const std::string& weakest);

/// kDegenerate when labels are swapped in pairs, or coordinates mirrored, so that the fit is bad for that reason.
Status refuseMislabelled(const LoopProblem& problem, const LoopOptions& options, const LoopModel& model);

/// A better sentence for an error of the search, if mirrored coordinates explain it; else the error itself.
Error explainMisfit(const LoopProblem& problem, const LoopOptions& options, const Error& error);

}  // namespace longarm::calibration
