#pragma once

/// @file
/// How far two bodies are apart, without a robot.

#include "planning/world/shape.h"

namespace longarm::planning {

/// Distance of two bodies whose poses are in one frame, unsigned and at most `cap` [m]; 0 when they touch, one lies
/// inside the other, or FCL fails.  A shape too small for FCL is infinitely far (`cap`).  Thread-safe.
double bodyDistance(const WorldObject& a, const WorldObject& b, double cap);

}  // namespace longarm::planning
