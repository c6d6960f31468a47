#pragma once

/// @file
/// What the operator holds down to move the arm, and the joint velocities that it asks for.

#include <string>

#include <Eigen/Core>

#include "core/result.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// Whose axes the tool is moved along, by a jog or by a correction.
enum class JogFrame { kJoint, kTool, kBase, kCamera };

struct JogCommand {
  JogFrame frame = JogFrame::kBase;
  int joint = 0;                                         ///< kJoint: index in the arm.
  double turn = 0;                                       ///< kJoint: -1 ... 1.
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();      ///< Else: -1 ... 1 along the frame's axes.
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();     ///< -1 ... 1 about them, through the tool's tip.
  std::string camera;                                    ///< kCamera: whose picture right, down and forward are meant in.
  double speed = 0.5;                                    ///< 0 ... 1 of the full jog speeds.
  bool through_contact = false;                          ///< Creeps although the model says that something is touched.

  bool isIdle() const { return frame == JogFrame::kJoint ? turn == 0 : linear.isZero() && angular.isZero(); }
};

/// The axes of tool, base or a camera of the workcell in the root frame, at the full configuration q.
/// @returns kInvalidInput: no such camera, or kJoint, which has no axes.  Pure function.
Result<Eigen::Matrix3d> axesOf(const Workcell& workcell, const Eigen::VectorXd& q, JogFrame frame,
                               const std::string& camera = {});

/// Full speeds of a jog.
struct JogSpeeds {
  double linear = 0.15;            ///< Of the tool's tip [m/s].
  double angular = 0.6;            ///< [rad/s]
  double joint_share = 0.25;       ///< Of a joint's velocity limit.
  double creep = 0.01;             ///< Of the tip, next to an obstacle or in contact [m/s].
};

struct JogVelocity {
  Eigen::VectorXd joints;          ///< (n) [rad/s or m/s]
  /// 1: as wanted; less: slowed because the arm cannot move that way here (singularity); 0: not at all.
  double dexterity = 1;
};

/// Joint velocities at configuration q (full, of the workcell's model).  In a Cartesian frame by damped least squares
/// (Nakamura, Hanafusa, J. Dyn. Sys. Meas. Control 108, 1986, eq. 17-18), slowed where what the arm can do departs
/// from what is wanted; rotations weigh 0.3 m/rad.  Pure function.
/// @returns kInvalidInput: no such joint, no such camera, numbers that are not finite or beyond 1.
Result<JogVelocity> jogVelocity(const Workcell& workcell, const Eigen::VectorXd& q, const JogCommand& command,
                                const JogSpeeds& speeds);

/// The full configuration with the arm's joints replaced.
Eigen::VectorXd withArm(const Workcell& workcell, const Eigen::VectorXd& q, const Eigen::VectorXd& arm);

}  // namespace longarm::planning
