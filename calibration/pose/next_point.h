#pragma once

/// @file
/// Advice: which point to click next, and from where another picture would help.

#include <optional>
#include <vector>

#include "calibration/pose/single_pose.h"

namespace longarm::calibration {

/// The candidate that adds most to log det of the information on the unknown transform, given those already observed.
/// @param T The unknown as it is thought to be now, in the form that PoseObservation multiplies (T_obj: its inverse).
/// @returns its index; empty when none is in front of the camera and in the picture.  Pure function.
std::optional<std::size_t> nextPoint(const vision::CameraModel& camera, const std::vector<PoseObservation>& have,
                                     const std::vector<PoseObservation>& candidates, const Pose& T);

/// What another picture would add.
struct NextPicture {
  std::size_t index = 0;                   ///< Of the candidate.
  int points = 0;                          ///< Of it that would be in the picture.
  double turn_before = 0, turn_after = 0;  ///< 1 sigma of the unknown's turn [rad] ...
  double shift_before = 0, shift_after = 0;   ///< ... and of its shift [m], for the stated noise.
};

/// The candidate picture that adds most, when `most` of its points are clicked.
/// @param candidates The points of each; those outside the picture are not counted.
/// @param sigma_px Noise of a click.
/// @returns nothing when no candidate has a point in the picture, or the points so far leave the unknown open.  Pure function.
std::optional<NextPicture> nextPicture(const vision::CameraModel& camera, const std::vector<PoseObservation>& have,
                                       const std::vector<std::vector<PoseObservation>>& candidates, const Pose& T, int most, double sigma_px);

}  // namespace longarm::calibration
