#pragma once

/// @file
/// The frame that a template is dropped into: how a marked feature looks to the robot.

#include <array>
#include <optional>

#include "core/pose.h"
#include "core/result.h"
#include "vision/sketch/feature.h"

namespace longarm::session {

/// Origin in the middle of what is seen, x to its right, y up, z out of it towards the robot.
struct FaceFrame {
  Pose X_WT = Pose::Identity();                    ///< In the feature's frame, whose z is up.
  std::array<std::optional<double>, 3> extent;     ///< Along x, y and behind the face [m]; empty where it is not marked.
};

/// Of a point: square to the way to the robot's axis.  Of a line: along it.  Of a plane: its face, x and y along its edges.
/// Of a box: the face that looks at the robot most.
/// @returns kInvalidInput for a triad that is no box or a plane without its shape.
Result<FaceFrame> faceFrameOf(const vision::Feature& feature);

}  // namespace longarm::session
