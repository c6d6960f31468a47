#pragma once

/// @file
/// AimedCamera: a camera on its pan-tilt: where it is and looks at any angles.

#include <optional>
#include <string>

#include "core/motion.h"
#include "planning/world/workcell.h"

namespace longarm::session {

struct PanTiltAngles {
  double pan = 0, tilt = 0;                ///< [rad]
};

/// A value; outlived by the workcell.
class AimedCamera {
 public:
  /// @returns kNotFound: no robot, or no pan-tilt aims the camera; kInvalidInput: a joint that does not move.
  static Result<AimedCamera> make(const planning::Workcell& workcell, const planning::CameraSpec& camera,
                                  const JointState& now);

  PanTiltAngles now() const { return {m_q(m_pan.q_index), m_q(m_tilt.q_index)}; }
  /// The camera's link at these angles, in the robot's root frame.
  Pose pose(const PanTiltAngles& angles) const;
  PanTiltAngles clamped(const PanTiltAngles& wanted) const;
  /// kOutOfLimits: the joint, what it would have to be, and its limits.
  Status checkLimits(const PanTiltAngles& wanted) const;
  /// Angles that bring a point of the root frame to where the normalised coordinates `centre` of the picture are.
  /// Newton on the two viewing angles, from where it looks and else from the best of a grid.  @returns kDegenerate when the point lies along the pan axis.
  Result<PanTiltAngles> lookingAt(const Eigen::Vector3d& p_W, const Eigen::Vector2d& centre) const;

 private:
  Eigen::Vector2d off(const PanTiltAngles& angles, const Eigen::Vector3d& p_W, const Eigen::Vector2d& centre) const;
  std::optional<PanTiltAngles> solve(PanTiltAngles angles, const Eigen::Vector3d& p_W, const Eigen::Vector2d& centre) const;

  struct Axis {
    int q_index = -1;
    double lower = 0, upper = 0;
    std::string name;
  };
  static Result<Axis> axisOf(const planning::RobotModel& model, const std::string& joint);

  const planning::RobotModel* m_model = nullptr;
  Axis m_pan, m_tilt;
  int m_link = -1;
  Eigen::VectorXd m_q;
};

}  // namespace longarm::session
