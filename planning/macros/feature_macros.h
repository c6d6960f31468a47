#pragma once

/// @file
/// The macros for features, one file each; macro.cpp puts them in the order an operator sees them.

#include <memory>

#include "planning/macros/macro.h"

namespace longarm::planning {

// For a point.
std::unique_ptr<Macro> makeLookAt(const Workcell& workcell);
std::unique_ptr<Macro> makeTouch();
std::unique_ptr<Macro> makeMoveAbove();
std::unique_ptr<Macro> makePlaceHere();

// For a line; Grab Pipe stands in grab_pipe.h.
std::unique_ptr<Macro> makeMoveAroundAxis();
std::unique_ptr<Macro> makeApproachFromSide();
std::unique_ptr<Macro> makeMoveParallel();
std::unique_ptr<Macro> makeAimAlongAxis();
std::unique_ptr<Macro> makePlaceDisruptor();
std::unique_ptr<Macro> makeInsertAlong();
std::unique_ptr<Macro> makeExtractAlong();

// For a plane.
std::unique_ptr<Macro> makeSurfaceScan();
std::unique_ptr<Macro> makeFollowPerimeter();
std::unique_ptr<Macro> makePress();
std::unique_ptr<Macro> makeWipe();

// For a triad, which is a box.
std::unique_ptr<Macro> makeGraspByFaces();
std::unique_ptr<Macro> makePushFace();
std::unique_ptr<Macro> makeScanFaces();
std::unique_ptr<Macro> makeLookAround();

}  // namespace longarm::planning
