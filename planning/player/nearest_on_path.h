#pragma once

/// @file
/// Where on a path a measured configuration lies.

#include <Eigen/Core>

#include "core/motion.h"

namespace longarm::planning::internal {

struct PathPlace {
  double tau = 0;       ///< [s]
  double distance = 0;  ///< Largest joint difference there [rad or m].
  Eigen::Index worst_joint = 0;
};

/// The place on the path nearest to `measured` in the largest joint difference.  Of several within
/// `tolerance` (a path may cross itself) the one nearest in time to `hint`.  Pure function.
/// @pre the trajectory is not empty and has measured.size() joints.
PathPlace nearestOnPath(const Trajectory& trajectory, const Eigen::VectorXd& measured, double hint,
                        double tolerance);

}  // namespace longarm::planning::internal
