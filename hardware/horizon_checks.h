#pragma once

/// @file
/// What MotionGate asks of a horizon by itself, whatever the arm is doing.

#include <string>
#include <vector>

#include "core/motion.h"
#include "core/result.h"
#include "hardware/motion_gate.h"

namespace longarm::hardware {

/// Names, sizes, finite numbers, times, length, rest at the end, limits of position, velocity and acceleration
/// (given values and differences between points).  A start outside the position limits is let back in but no
/// further out.  @returns kInvalidInput or kOutOfLimits naming point, joint, value and limit.  Pure function.
Status checkHorizon(const Horizon& horizon, const std::vector<std::string>& joints, const MotionLimits& limits,
                    const GateOptions& options);

/// Tool speed and clearance along the horizon.  @returns kOutOfLimits, kCollision, or kInternal when a check
/// throws.  As thread-safe as the callables.
Status checkSurroundings(const Horizon& horizon, const GateChecks& checks);

}  // namespace longarm::hardware
