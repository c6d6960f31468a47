#pragma once

/// @file
/// JointErrors: between what the motors' encoders say and where the arm's joints truly are.

#include <vector>

#include <Eigen/Core>

#include "app/virtual_robot/seeded_random.h"
#include "planning/robot/robot_model.h"
#include "planning/world/scenario.h"

namespace longarm::virtual_robot {

/// Constant encoder offsets, gear backlash and reading noise of the revolute joints of an arm; prismatic ones have
/// none.  The seed fixes the offsets and the order of the noise.  Thread-compatible.
class JointErrors {
 public:
  JointErrors(const planning::RobotModel& model, const planning::JointGroup& arm,
              const planning::Imperfections& imperfections, unsigned seed);

  /// Lets the gears take up `motor` (n) and returns the true positions (n) [rad or m]: a joint is dragged along by
  /// the play's edges, and stands off its encoder by the offset.
  const Eigen::VectorXd& follow(const Eigen::VectorXd& motor);
  /// What the encoders read at `motor` (n).  Draws noise.
  Eigen::VectorXd read(const Eigen::VectorXd& motor);

  const Eigen::VectorXd& offsets() const { return m_offsets; }

 private:
  Eigen::VectorXd m_offsets, m_half_play, m_noise, m_geared, m_true;
  bool m_started = false;
  SeededRandom m_random;
};

}  // namespace longarm::virtual_robot
