#pragma once

/// @file
/// A calibration of the library made anew from the raw data kept with it.

#include <optional>

#include "session/calibration/calibration_change.h"
#include "session/calibration/camera_library.h"

namespace longarm::session {

/// One of the two.
struct SolvedAgain {
  std::optional<CameraChange> camera;
  std::optional<PlaceChange> place;
};

/// @returns kNotFound without raw data, kRefused for a kind whose raw data do not suffice (with what to do instead), or why it
///   cannot be solved.  Pure function but for reading the record's files; may take seconds.
Result<SolvedAgain> solveAgain(const CalibrationRecord& record);

}  // namespace longarm::session
