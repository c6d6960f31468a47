#pragma once

/// @file
/// Re-registration: what was measured before the base was driven, moved to where it is now by marks made
/// again.

#include <string>
#include <vector>

#include "core/pose.h"
#include "core/result.h"
#include "session/commands/sketch_commands.h"
#include "session/document/document.h"

namespace longarm::session {

/// One vertex that was marked before and again.
struct MarkedTwice {
  std::string name;
  Eigen::Vector3d then, now;                        ///< In the robot's frame at each time [m].
  Eigen::Matrix3d covariance_then, covariance_now;  ///< [m^2]
};

/// The motion that takes coordinates of then to coordinates of now, as 1 or more of three marks tell it.
struct Registration {
  BaseState then;
  Pose X_now_then = Pose::Identity();
  /// Of (rotvec [rad], translation [m]), rotation and translation apart as View::pose_covariance.
  Matrix6d covariance = Matrix6d::Zero();
  double residual_rms = 0;      ///< Of the marks [m].
  int marks = 0, features = 0;  ///< Marks used; stale features that it moves.
};

/// What was marked again: items with picks in old and new pictures, and new items that bear name and kind of
/// a stale one.
/// @param then One place of the base that pictures were taken from.
std::vector<MarkedTwice> markedTwice(const Document& document, const BaseState& then);

/// Weighted least squares over rotation and translation (Gauss-Newton from the closed form of Umeyama,
/// "Least-squares estimation of transformation parameters", PAMI 13(4), 1991).  Where the marks fit worse
/// than their covariances say, the answer's covariance grows by that.
/// @returns kRefused with fewer than 3 marks; kDegenerate when they lie nearly in a line; kNoSolution when
/// they do not
///   fit by 50 mm: two of them are not the same spot.  Pure function.
Result<Registration> fitMarks(const std::vector<MarkedTwice>& marks);

/// For the old place with the most marks.  @returns kRefused when nothing is stale, else as fitMarks().
Result<Registration> findRegistration(const Document& document);

/// One undo step: every picture and body from there gets its place relative to where the robot is now.
CommandPtr applyRegistration(const Document& document, const Registration& registration);

}  // namespace longarm::session
