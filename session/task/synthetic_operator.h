#pragma once

/// @file
/// SyntheticOperator: eyes and hand of the operator who is not there.
///
/// It alone may use the judge's knowledge (TaskTruth): where a person would look and click.  What is measured, planned
/// and played from those clicks is the console's own.

#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/motion.h"
#include "core/result.h"
#include "planning/world/workcell.h"
#include "session/task/task_truth.h"
#include "vision/camera/camera_model.h"

namespace longarm::session {

/// The two cameras a workcell measures with: a stereo head, or else two pan-tilt cameras.
/// @returns kNotFound.
Result<std::pair<std::string, std::string>> measuringPair(const planning::Workcell& workcell);

struct AimWish {
  std::string pan_tilt;
  double pan = 0, tilt = 0;              ///< [rad]
};
/// The angles that turn the cameras to a point, one wish for each pan-tilt that carries one of them.  Angles stay within
/// the joints' limits.  @returns kNotFound for a camera that no pan-tilt aims.
Result<std::vector<AimWish>> aimAt(const planning::Workcell& workcell, const std::vector<std::string>& cameras,
                                   const Eigen::Vector3d& p_R, const JointState& now);

/// Clicks on a point that is truly at p_W with a hand that trembles.
class SyntheticHand {
 public:
  /// @param sigma_px  1 sigma of every click, per axis.
  SyntheticHand(unsigned seed, double sigma_px) : m_random(seed), m_sigma_px(sigma_px) {}

  /// @param X_WC  True pose of the camera.
  /// @returns kDegenerate when the point is not in the picture.
  Result<Eigen::Vector2d> click(const vision::CameraModel& camera, const Pose& X_WC, const Eigen::Vector3d& p_W);

 private:
  std::mt19937 m_random;
  double m_sigma_px;
};

}  // namespace longarm::session
