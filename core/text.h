#pragma once

/// @file
/// Locale-independent numbers and small files.  Never use strtod, stod, streams or printf for numbers in
/// files: with a decimal-comma locale they read "1.5" as 1.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace longarm {

/// A finite or infinite number that fills the whole (trimmed) text, "." always the decimal point.
std::optional<double> parseNumber(std::string_view text);
/// A whole number that fills the whole (trimmed) text.
std::optional<long long> parseInteger(std::string_view text);
/// Numbers separated by blanks and/or commas, or an Error naming the one that is none.
Result<std::vector<double>> parseNumbers(std::string_view text);
/// Shortest text that reads back as the same double.
std::string formatNumber(double value);
/// Fixed number of decimals, "." always the decimal point.
std::string formatFixed(double value, int decimals);

std::string_view trimmed(std::string_view text);
std::vector<std::string> split(std::string_view text, char separator);

/// Whole file.  @returns kNotFound, or kInvalidInput when it is a folder or larger than `max_bytes`.
Result<std::string> readTextFile(const std::string& path, std::size_t max_bytes = 16u << 20);
/// Writes beside, then renames: the file is never half written.  Creates no folders.
Status writeFileAtomically(const std::string& path, std::string_view content);

}  // namespace longarm
