#pragma once

/// @file
/// Colours of clearance along a path, the same in scene, pictures and time bar.

#include <Eigen/Core>

#include "planning/motion/clearance.h"

namespace longarm::scene {

/// RGB 0 ... 1.  Told apart by people who see no difference of red and green; where lines are drawn, tighter ones are wider too.
Eigen::Vector3d clearanceColor(planning::ClearanceBand band);

}  // namespace longarm::scene
