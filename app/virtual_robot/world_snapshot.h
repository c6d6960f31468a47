#pragma once

/// @file
/// Everything true at one instant: what pictures are made from.

#include <map>
#include <string>
#include <vector>

#include "core/pose.h"
#include "planning/world/shape.h"

namespace longarm::virtual_robot {

/// World frame W: base_link where the robot started.  A plain value.
struct WorldSnapshot {
  double time_s = 0;                               ///< On the robot's clock.
  std::vector<Pose> X_WL;                          ///< Every link, in the model's order.
  std::vector<planning::WorldObject> objects;      ///< In W.
  std::map<std::string, Pose> X_WC;                ///< Optical frame of every camera, by name.
};

}  // namespace longarm::virtual_robot
