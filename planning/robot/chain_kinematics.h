#pragma once

/// @file
/// Forward kinematics and Jacobian of one chain, precompiled for speed.

#include <array>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "planning/robot/robot_model.h"

namespace longarm::planning {

/// Forward kinematics of a group's tip in the robot's root frame.  Fixed joints are folded into constants, and each
/// joint frame is turned so that its axis is z and what follows it is a translation and a turn about x: a step
/// costs 33 multiplications and one sine-cosine pair, without the ill-conditioned parallel case that
/// Denavit-Hartenberg parameters have.  Immutable; const methods are thread-safe and do not allocate.
class ChainKinematics {
 public:
  static constexpr int kMaxJoints = 32;

  /// @param reference  Full configuration that the joints outside the group keep (a torso below the arm, say).
  /// @pre The group belongs to the model and has 1 ... kMaxJoints joints; reference.size() == model.dof().
  ChainKinematics(const RobotModel& model, const JointGroup& group, const Eigen::VectorXd& reference);

  /// Number of joints of the group.
  int size() const { return m_size; }

  /// X_root_tip at the group's joint values.  @pre q holds size() numbers.
  Pose forward(const double* q) const;

  /// Pose of the tip and its geometric Jacobian in the root frame, columns of six: angular, then linear.
  /// @pre q holds size() numbers; J holds 6 * size() numbers, column after column.
  void forwardAndJacobian(const double* q, Eigen::Matrix3d& R, Eigen::Vector3d& p, double* J) const;

 private:
  /// One moving joint: turn by x_cos, x_sin about x, then the joint's motion about or along z.
  struct Step {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();   ///< Before the turn about x, in the frame so far.
    double x_cos = 1, x_sin = 0;
    double offset = 0;                                 ///< Added to the angle (constant angle if prismatic).
    double multiplier = 1, value_offset = 0;           ///< Joint value = multiplier * q[column] + value_offset.
    int column = 0;
    bool prismatic = false;
    bool adds = false;                                 ///< Mimic: adds to a column instead of setting it.
  };

  template <bool kWithAxes>
  void walk(const double* q, Eigen::Matrix3d& R, Eigen::Vector3d& p, Eigen::Vector3d* axes,
            Eigen::Vector3d* origins) const;

  int m_size = 0;
  Eigen::Matrix3d m_base = Eigen::Matrix3d::Identity(), m_tail = Eigen::Matrix3d::Identity();
  Eigen::Vector3d m_base_shift = Eigen::Vector3d::Zero(), m_tail_shift = Eigen::Vector3d::Zero();
  bool m_has_tail = false;
  std::vector<Step> m_steps;
};

}  // namespace longarm::planning
