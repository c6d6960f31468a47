#pragma once

/// @file
/// Closed-form starts for a camera and the target's poses.

#include <optional>
#include <string>
#include <vector>

#include "calibration/intrinsics/board_view.h"
#include "core/pose.h"
#include "core/result.h"
#include "vision/camera/camera_model.h"

namespace longarm::calibration {

struct InitialGuess {
  vision::CameraModel camera;
  std::vector<Pose> X_CK;                  ///< One per view; identity for those with a reason.
  std::vector<std::string> why_unusable;   ///< One per view; empty for usable ones.
  int usable() const;
};

/// Planar views give focal lengths by Zhang's constraints with the principal point in the middle of the picture
/// (Zhang, "A flexible new technique for camera calibration", TPAMI 22(11), 2000), others by the linear solution.
/// @param width, height Of the picture [px]; 0 where unknown (the middle of the corners serves).
/// @param known Uses these intrinsics instead and finds only the poses.
InitialGuess guessCamera(const std::vector<BoardView>& views, int width, int height,
                         const std::optional<vision::CameraModel>& known = {});

/// Pose of a view's target for given intrinsics (lens distortion included).
/// @returns kDegenerate: fewer than 4 corners, on a line, or not in front of the camera.
Result<Pose> guessPose(const BoardView& view, const vision::CameraModel& camera);

}  // namespace longarm::calibration
