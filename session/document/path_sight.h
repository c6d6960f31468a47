#pragma once

/// @file
/// Which parts of a planned path a picture would see, past the bodies that are known.

#include <string>
#include <vector>

#include <Eigen/Core>

#include "planning/world/shape.h"
#include "session/document/document.h"

namespace longarm::session {

/// The solid bodies that stand in this frame: the workcell's and those of the world, where they stand now.
std::vector<planning::WorldObject> bodiesInSight(const Document& document, const std::string& frame);

/// For each point whether a body lies between it and the eye, by more than 5 mm; all in one frame [m].  A body around the eye hides
/// nothing.  Pure function.
std::vector<bool> hiddenBehind(const std::vector<planning::WorldObject>& bodies, const Eigen::Vector3d& eye,
                               const std::vector<Eigen::Vector3d>& points);

}  // namespace longarm::session
