#pragma once

/// @file
/// What would help when something cannot be done: tried out with the arm's kinematics.

#include <string>
#include <vector>

#include "core/pose.h"
#include "planning/collision/collision_world.h"
#include "planning/macros/planning_run.h"
#include "planning/motion/arm_space.h"

namespace longarm::planning {

/// Each adds a sentence to the run's plan where it finds one, and says whether it did; none takes over 1 s, nor beyond the run's
/// deadline.

/// That a body of the world other than the target is in the way.
bool adviseObstacle(PlanningRun& run, const Contact& contact, const std::string& target);

/// The shortest drive forwards or back, or turn of the base, after which one of the ways (tool poses X_RT in a row) lies
/// within reach; what stands around is not looked at.
bool adviseDriving(PlanningRun& run, const ArmSpace& free, const std::vector<std::vector<Pose>>& ways);

/// The least roll of the tool about its own axis, before it begins, with which a way from here can be followed free of
/// collisions.
bool adviseRoll(PlanningRun& run, const ArmSpace& free, const std::vector<Pose>& way);

}  // namespace longarm::planning
