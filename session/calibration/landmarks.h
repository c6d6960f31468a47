#pragma once

/// @file
/// Landmarks: places on known things that an operator can find in a picture.

#include <optional>
#include <string>
#include <vector>

#include "planning/world/workcell.h"
#include "session/document/document.h"

namespace longarm::session {

struct Landmark {
  std::string name;                      ///< "crate corner 3", "finger_left_link corner 1", "Line 1 end 2"
  std::string thing;                     ///< Object, link or feature it belongs to.
  std::string link;                      ///< Link that carries it; empty: the robot's root frame.
  Eigen::Vector3d xyz;                   ///< In that link, or in the thing's own frame for objects [m].
  Pose X_LO = Pose::Identity();          ///< Frame of `xyz` in the link: an object's pose.
  double sigma_m = 0.0005;               ///< How well a corner can be told from its surroundings [m].

  /// In the robot's root frame at a configuration.  @returns kNotFound for a link the robot does not have.
  Result<Eigen::Vector3d> inRoot(const planning::RobotModel& model, const Eigen::VectorXd& q) const;
};

/// Corners of the workcell's objects, of the robot's links (boxes' corners, ends of cylinders' axes, and where a mesh ends in each
/// of the eight diagonal directions), the tool's tip, and vertices of measured features.
std::vector<Landmark> landmarksOf(const planning::Workcell& workcell, const Document& document);

}  // namespace longarm::session
