#pragma once

/// @file
/// Advice: which point to click next.

#include <optional>
#include <vector>

#include "calibration/pose/single_pose.h"

namespace longarm::calibration {

/// The candidate that adds most to log det of the information on the unknown transform, given those already observed.
/// @param T The unknown as it is thought to be now, in the form that PoseObservation multiplies (T_obj: its inverse).
/// @returns its index; empty when none is in front of the camera and in the picture.  Pure function.
std::optional<std::size_t> nextPoint(const vision::CameraModel& camera, const std::vector<PoseObservation>& have,
                                     const std::vector<PoseObservation>& candidates, const Pose& T);

}  // namespace longarm::calibration
