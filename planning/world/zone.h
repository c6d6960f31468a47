#pragma once

/// @file
/// Zones: volumes that the arm must not enter or must not leave.

#include <vector>

#include "planning/world/shape.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// What motions must not meet: the body itself, or the six walls around a box that they must not leave (5 m thick, of the
/// box's name).  None for a kKeepIn that is no box.
std::vector<WorldObject> barriersOf(const WorldObject& object);

/// Whether motions of the arm move this link: zones are about nothing else.
bool movedByArm(const Workcell& workcell, int link);

/// What a zone is drawn with: red, or a hint of blue; seen through.
Eigen::Vector4d zoneColour(BodyRole role);

/// "touches crate", "is inside the keep-out zone drill", "leaves the workspace cell": for sentences.
std::string meetingWords(BodyRole role, const std::string& name);

}  // namespace longarm::planning
