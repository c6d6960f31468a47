#include "calibration/solve/csv_table.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr std::size_t kMaxBytes = 64u << 20;
constexpr std::size_t kMaxRows = 1000000;

Error bad(const std::string& file, int line, const std::string& what) {
  return {ErrorCode::kInvalidInput, file + ": line " + std::to_string(line) + ": " + what};
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ",") + word;
  return out;
}

std::vector<std::string> cellsOf(const std::string& line) {
  auto cells = split(line, ',');
  for (auto& cell : cells) cell = std::string(trimmed(cell));
  return cells;
}

std::string shortened(const std::string& text) { return text.size() > 60 ? text.substr(0, 57) + "..." : text; }

bool isSkipped(std::string_view line) {
  line = trimmed(line);
  return line.empty() || line.front() == '#';
}

// Where each wanted column stands in the header.
Result<std::vector<std::size_t>> placesOf(const std::string& file, int line, const std::vector<std::string>& header,
                                          const std::vector<std::string>& columns) {
  std::vector<std::size_t> places;
  for (const auto& column : columns) {
    const auto at = std::find(header.begin(), header.end(), column);
    if (at == header.end()) {
      return bad(file, line, "the header is \"" + shortened(joined(header)) + "\" but column \"" + column +
                                 "\" is missing; expected " + joined(columns));
    }
    places.push_back(static_cast<std::size_t>(at - header.begin()));
  }
  return places;
}

}  // namespace

Result<std::vector<CsvRow>> parseCsv(std::string_view text, const std::string& file,
                                     const std::vector<std::string>& columns) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  std::vector<CsvRow> rows;
  std::vector<std::size_t> places;
  std::size_t width = 0;
  int number = 0;
  for (const auto& line : split(text, '\n')) {
    ++number;
    if (isSkipped(line)) continue;
    const auto cells = cellsOf(line);
    if (places.empty()) {
      const auto found = placesOf(file, number, cells, columns);
      if (!found) return found.error();
      places = *found;
      width = cells.size();
      continue;
    }
    if (cells.size() != width) {
      return bad(file, number, "has " + std::to_string(cells.size()) + " columns; expected " + std::to_string(width) +
                                   " as in the header (write decimals with a point, 1.5, not 1,5)");
    }
    if (rows.size() >= kMaxRows) return bad(file, number, "more than " + std::to_string(kMaxRows) + " rows");
    CsvRow row{number, {}};
    for (const std::size_t place : places) row.cells.push_back(cells[place]);
    rows.push_back(std::move(row));
  }
  if (places.empty()) return bad(file, 1, "the file is empty; expected the header " + joined(columns));
  return rows;
}

Result<std::vector<CsvRow>> readCsv(const std::string& path, const std::vector<std::string>& columns) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  return parseCsv(*text, path, columns);
}

Result<double> cellNumber(const std::string& file, const CsvRow& row, const std::vector<std::string>& columns,
                          std::size_t index) {
  const auto number = parseNumber(row.cells[index]);
  if (number && std::isfinite(*number)) return *number;
  return bad(file, row.line, "column " + columns[index] + ": \"" + shortened(row.cells[index]) +
                                 "\" is not a finite number (write 1.5, not 1,5)");
}

}  // namespace longarm::calibration
