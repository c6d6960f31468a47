#pragma once

/// @file
/// What would help when a point is out of reach.

#include <string>

#include <Eigen/Core>

#include "planning/world/workcell.h"

namespace longarm::planning {

/// Where the arm hangs and how far it reaches.
struct Reach {
  Eigen::Vector3d shoulder = Eigen::Vector3d::Zero();    ///< Second joint on the first one's axis, in the root frame.
  double length = 0;                     ///< From there to the tool, stretched out [m].
};

Reach reachOf(const Workcell& workcell, const Eigen::VectorXd& q);

/// "its middle is 1.31 m from the shoulder, the arm reaches 1.05 m"
std::string reachFacts(const Reach& reach, const std::string& what, const Eigen::Vector3d& point);

/// "its middle is 1.31 m from the shoulder, the arm reaches 1.05 m: drive 0.26 m closer", or what else would help.
std::string reachAdvice(const Reach& reach, const std::string& what, const Eigen::Vector3d& point);

}  // namespace longarm::planning
