#pragma once

/// @file
/// What the gripper holds or touches where a motion starts.

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "planning/collision/collision_world.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// How the gripper meets the world's bodies; names of objects.
struct Grip {
  std::vector<std::string> held;         ///< Between the fingers, which stand neither open nor shut: moves with the tool.
  std::vector<std::string> touched;      ///< Touched by the gripper's links and not held: stays where it is.
  std::vector<std::pair<std::string, std::string>> supports;   ///< A held body, and one that it lies on.
};

/// Looks at the bodies that are attached to nothing.  Empty without a gripper.
/// @param q      Full configuration.
/// @param known  Bodies that are held however their measured place fits the fingers, because the robot says that it holds
///               something; only while the fingers stand neither open nor shut.
Grip gripAt(const Workcell& workcell, const std::vector<WorldObject>& objects, const Eigen::VectorXd& q,
            const std::vector<std::string>& known = {});

/// The bodies, those that are held attached to the arm's tip as they stand at q.
std::vector<WorldObject> withHeldAttached(const Workcell& workcell, std::vector<WorldObject> objects, const Grip& grip,
                                          const Eigen::VectorXd& q);

/// Lets the gripper's links touch what it carries, and held bodies what they lie on.
/// @param objects  As from withHeldAttached().
void allowGrip(CollisionWorld& world, const Workcell& workcell, const std::vector<WorldObject>& objects, const Grip& grip);

}  // namespace longarm::planning
