#pragma once

/// @file
/// Small sums of a template file: sizes that follow from other sizes.

#include <map>
#include <string>

#include "core/result.h"

namespace longarm::planning {

/// Value of a sum such as "width / 2 - 0.06": numbers with a decimal point, names of `variables`, + - * / brackets, sin() and cos() of radians.
/// @returns kInvalidInput naming the text and the place: what is not understood, an unknown name, a division by zero, a
///   value that is not finite.  Bounded: at most 200 characters, brackets nested at most 20 deep.  Pure function.
Result<double> evaluate(const std::string& text, const std::map<std::string, double>& variables);

}  // namespace longarm::planning
