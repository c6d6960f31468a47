#pragma once

/// @file
/// Which pictures of a list were taken together.

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"

namespace longarm::calibration {

/// Indices of left and right pictures: they alternate (left01 right01 left02 ...), or all left ones come first; told from the
/// numbers in their names.
/// @returns kInvalidInput for an odd number of pictures, or none.  Pure function.
Result<std::vector<std::pair<std::size_t, std::size_t>>> pairPictures(const std::vector<std::string>& names);

}  // namespace longarm::calibration
