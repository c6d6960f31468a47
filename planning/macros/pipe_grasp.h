#pragma once

/// @file
/// Ways to take hold of a pipe: where along it, from which side, which way round.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "core/result.h"
#include "planning/robot/robot_model.h"
#include "vision/sketch/feature.h"

namespace longarm::planning {

/// A measured pipe in the robot's root frame.
struct Pipe {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();          ///< Unit.
  double length = 0;                                             ///< [m]
  Eigen::Matrix3d covariance_first = Eigen::Matrix3d::Zero();    ///< Of the ends [m^2].
  Eigen::Matrix3d covariance_second = Eigen::Matrix3d::Zero();

  /// Covariance of the point `along` metres from the middle; the ends are taken as independent.
  Eigen::Matrix3d covarianceAt(double along) const;
};

/// The line of a feature as a pipe.  Its parent may be the root link, "world", or any link (its pose at q).
/// @returns kInvalidInput: not a line, unknown parent, not finite; kDegenerate: shorter than 20 mm.
Result<Pipe> pipeFrom(const vision::Feature& feature, const RobotModel& model, const Eigen::VectorXd& q);

/// One way to hold it: tool x along the pipe, tool z across it from above or the side, never from below.
struct PipeGrasp {
  double along = 0;                      ///< From the middle [m].
  double tilt = 0;                       ///< About the pipe, from straight above [rad].
  bool flipped = false;                  ///< Tool x against the pipe's direction.
  Pose X_RT = Pose::Identity();          ///< Tool at the grasp, in the root frame.
};

/// All grasps at one place along the pipe, nearest to straight-from-above first, every `step` up to 90 degrees to
/// either side, both ways round.  A pipe within 12 degrees of upright has no above: its grasps start from the
/// robot's side.
std::vector<PipeGrasp> graspsAt(const Pipe& pipe, double along, double step = 7.5 * 3.14159265358979323846 / 180);

/// Places to try: the middle, then outwards to either side, keeping `margin` from the ends [m].
std::vector<double> placesAlong(const Pipe& pipe, double step = 0.04, double margin = 0.03);

}  // namespace longarm::planning
