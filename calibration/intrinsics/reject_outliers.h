#pragma once

/// @file
/// Finding views and corners that do not belong.

#include <string>
#include <vector>

#include "calibration/intrinsics/intrinsics_model.h"

namespace longarm::calibration {

/// Sets weights to zero: first of whole views, worst first, whose residuals stand out (median more than three times
/// that of the others, at most a third of the views), then of single corners beyond 4 sigma.  Solves the model
/// between (with Huber's loss) and leaves it at a robust optimum, Huber off.
/// @param why One per view; receives the reason of each view left out.
void rejectOutliers(IntrinsicsModel* model, const std::vector<BoardView>& views, std::vector<std::string>* why);

/// Pairs of corners of one view whose pixels fit each other's place and not their own (swapped labels), as
/// sentences that name the view and the lines.
std::vector<std::string> swappedLabels(const IntrinsicsModel& model, const std::vector<BoardView>& views);

}  // namespace longarm::calibration
