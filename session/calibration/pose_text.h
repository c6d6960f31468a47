#pragma once

/// @file
/// Solved poses and what they were solved from, as text.

#include <string>

#include "calibration/pose/transform_loop.h"
#include "core/pose.h"

namespace longarm::session {

/// "xyz 0.1 0.2 0.3 m, rpy 0 0 1.5 rad", as a URDF's origin takes it.
std::string poseText(const Pose& X);

/// observations.json, which `calibrate pose` solves again.
std::string observationsText(const calibration::LoopProblem& problem, double sigma_px);

}  // namespace longarm::session
