#pragma once

/// @file
/// Small comma separated tables with a header line.

#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace longarm::calibration {

/// Cells of the wanted columns, in the order wanted.
struct CsvRow {
  int line = 0;                          ///< In the file, from 1.
  std::vector<std::string> cells;
};

/// Reads a table whose header holds the wanted columns (in any order, others are ignored); LF or CRLF, empty lines
/// and lines that start with # are skipped.
/// @returns kInvalidInput naming file, line and what was expected: no or a wrong header, a row of another length,
///   more than 1e6 rows.
Result<std::vector<CsvRow>> parseCsv(std::string_view text, const std::string& file,
                                     const std::vector<std::string>& columns);
/// The same from a file of at most 64 MB.
Result<std::vector<CsvRow>> readCsv(const std::string& path, const std::vector<std::string>& columns);

/// A finite number in a cell, or kInvalidInput naming file, line, column and the value.
Result<double> cellNumber(const std::string& file, const CsvRow& row, const std::vector<std::string>& columns,
                          std::size_t index);

}  // namespace longarm::calibration
