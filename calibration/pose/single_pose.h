#pragma once

/// @file
/// One unknown transform anywhere in the loop: the report's nPnP problem, and its fast solver.

#include <vector>

#include <Eigen/Core>

#include "calibration/pose/transform_loop.h"
#include "core/pose.h"
#include "core/result.h"
#include "vision/camera/camera_model.h"

namespace longarm::calibration {

/// A correspondence reduced to what the unknown sees: the point in the camera is A T y.
struct PoseObservation {
  Pose A;                        ///< All transforms left of the unknown.
  Eigen::Vector3d y;             ///< The point after all transforms right of it.
  Eigen::Vector2d pixel;         ///< Raw pixel.
  double weight = 1;             ///< 0 leaves it out.
  int view = 0, point = 0;       ///< Where it came from.
};

/// Observations of the problem for one unknown transform (T_obj: for its inverse), in an order that depends on their
/// values only.  @pre unknown is not kIntrinsics.
std::vector<PoseObservation> observationsOf(const LoopProblem& problem, LoopUnknown unknown);

struct PoseFit {
  Pose T = Pose::Identity();
  double cost = 0;               ///< Sum of weighted squares, or of the robust loss [px^2].
  int iterations = 0;
  bool in_front = false;         ///< Every point with a weight is in front of the camera.
};

/// Refines a start on pixels, by Gauss-Newton with composed rotation increments (the report adds them to the rotation
/// vector, equation (49), which converges slower the larger the rotation and not at all beyond 133 degrees), damped
/// after a step that fails.
/// @param cauchy_px Residuals much longer than this are forgotten; 0: plain least squares.
PoseFit refinePose(const vision::CameraModel& camera, const std::vector<PoseObservation>& observations,
                   const Pose& start, double cauchy_px = 0, int max_iterations = 30);

/// Distinct minima on pixels (rotations more than a degree apart), best first, found from nothing and, if given,
/// from `start` too.  Those with a point behind the camera are left out.
/// @returns kDegenerate when a pixel has no ray (the message names it), kNoSolution when there is no minimum.
Result<std::vector<PoseFit>> findPoses(const vision::CameraModel& camera,
                                       const std::vector<PoseObservation>& observations, const Pose* start = nullptr);

/// The transform that most observations agree on: random samples of four (seeded), then Cauchy's loss.
/// @param threshold_px Residual of an observation that agrees.
/// @param inliers Receives which agree.
Result<PoseFit> findPoseAmongOutliers(const vision::CameraModel& camera,
                                      const std::vector<PoseObservation>& observations, double threshold_px,
                                      std::vector<bool>* inliers);

/// Length of the residual [px]; infinite behind the camera.
double missOf(const vision::CameraModel& camera, const PoseObservation& observation, const Pose& T);

}  // namespace longarm::calibration
