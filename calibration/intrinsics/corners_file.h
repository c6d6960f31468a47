#pragma once

/// @file
/// corners.csv: pixels of known points, found elsewhere.

#include <string>
#include <string_view>
#include <vector>

#include "calibration/intrinsics/board_view.h"
#include "core/result.h"

namespace longarm::calibration {

/// Reads `view,x,y,z,u,v` (metres in the target's frame, raw pixels); views in the order of their first row.
/// @returns kNotFound, or kInvalidInput naming file, line, column and value; the same point twice in one view too.
Result<std::vector<BoardView>> readCornersFile(const std::string& path);
Result<std::vector<BoardView>> parseCorners(std::string_view text, const std::string& file);

/// Reads `x,y,z,u,v`: one picture of a fixture.  Fails as readCornersFile.
Result<BoardView> readFixturePoints(const std::string& path);
Result<BoardView> parseFixturePoints(std::string_view text, const std::string& file);

}  // namespace longarm::calibration
