#pragma once

/// @file
/// The camera files of a workcell, read once per change of the file: live overlays ask at every frame.

#include <memory>

#include "core/result.h"
#include "planning/world/workcell.h"
#include "vision/camera/camera_calibration.h"

namespace longarm::session {

/// @returns as CameraCalibration::read.  Thread-safe.
Result<std::shared_ptr<const vision::CameraCalibration>> calibrationOf(const planning::CameraSpec& camera);

}  // namespace longarm::session
