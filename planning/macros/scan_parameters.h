#pragma once

/// @file
/// What scans of surfaces share: their parameters, and the ways to begin.

#include <vector>

#include "planning/macros/macro_arguments.h"
#include "planning/macros/raster.h"
#include "planning/macros/tool_task.h"

namespace longarm::planning {

/// swath, overlap, stand_off, tilt, speed, direction, roll_free.
std::vector<MacroParameter> scanParameters();
RasterSpec scanSpec(const MacroArguments& arguments);

/// The raster of a patch from each of its four corners, as tasks; the one that was asked for first.
/// @param all_corners  false: only from the first corner, as resuming a scan needs it.
/// @returns as rasterOf().
Result<std::vector<ToolTask>> scanTasks(const PlanePatch& patch, const RasterSpec& spec, bool roll_free, bool all_corners);

}  // namespace longarm::planning
