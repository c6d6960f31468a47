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
/// @param camera_file Path in it, relative to where it will stand.
std::string observationsText(const calibration::LoopProblem& problem, const std::string& camera_file, double sigma_px);

}  // namespace longarm::session
