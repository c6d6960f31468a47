#pragma once

/// @file
/// What stands in the room while the robot drives through it.

#include <memory>

#include "core/pose.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// Whether a base that drives leaves some of the workcell's objects behind: those without an `attached_link`.
bool hasRoom(const Workcell& workcell);

/// The workcell as it is with the base elsewhere.  Its file gives objects where the robot started, which is the odometry frame O;
/// those that no link carries, zones too, stay there, so that in the robot's root frame they move the other way.
/// @param X_OB Base in the odometry frame.
/// @returns the workcell itself where nothing moves.  Pure function.
std::shared_ptr<const Workcell> withBaseAt(const std::shared_ptr<const Workcell>& workcell, const Pose& X_OB);

}  // namespace longarm::planning
