#include "calibration/intrinsics/corners_file.h"

#include <cmath>
#include <map>
#include <tuple>

#include "calibration/solve/csv_table.h"
#include "core/text.h"

namespace longarm::calibration {
namespace {

constexpr std::size_t kMaxBytes = 64u << 20;
constexpr double kFarthest = 1e6;
const std::vector<std::string> kCornerColumns = {"view", "x", "y", "z", "u", "v"};
const std::vector<std::string> kPointColumns = {"x", "y", "z", "u", "v"};

// Five numbers of a row from column `first` on.
Result<Corner> cornerOf(const std::string& file, const CsvRow& row, const std::vector<std::string>& columns,
                        std::size_t first) {
  double values[5];
  for (std::size_t i = 0; i < 5; ++i) {
    const auto number = cellNumber(file, row, columns, first + i);
    if (!number) return number.error();
    if (std::abs(*number) > kFarthest) {
      return Error{ErrorCode::kInvalidInput, file + ": line " + std::to_string(row.line) + ": column " + columns[first + i] + ": " +
                                                 formatNumber(*number) + " is beyond 1e6 (metres for x,y,z, pixels for u,v)"};
    }
    values[i] = *number;
  }
  return Corner{{values[0], values[1], values[2]}, {values[3], values[4]}, row.line};
}

using Place = std::tuple<double, double, double>;
Place placeOf(const Corner& c) { return {c.xyz.x(), c.xyz.y(), c.xyz.z()}; }

// Refuses the same point twice in one picture.
Status addOnce(std::map<Place, int>* seen, const Corner& corner, const std::string& file, const std::string& in) {
  const auto [at, fresh] = seen->emplace(placeOf(corner), corner.line);
  if (fresh) return {};
  return {ErrorCode::kInvalidInput, file + ": line " + std::to_string(corner.line) + ": point (" +
                                        formatNumber(corner.xyz.x()) + ", " + formatNumber(corner.xyz.y()) + ", " +
                                        formatNumber(corner.xyz.z()) + ") was already given" + in + " on line " +
                                        std::to_string(at->second) + "; remove one of them"};
}

}  // namespace

Result<std::vector<BoardView>> parseCorners(std::string_view text, const std::string& file) {
  const auto rows = parseCsv(text, file, kCornerColumns);
  if (!rows) return rows.error();
  std::vector<BoardView> views;
  std::map<std::string, std::size_t> index;
  std::vector<std::map<Place, int>> seen;
  for (const auto& row : *rows) {
    if (row.cells[0].empty()) {
      return Error{ErrorCode::kInvalidInput, file + ": line " + std::to_string(row.line) + ": column view is empty"};
    }
    const auto corner = cornerOf(file, row, kCornerColumns, 1);
    if (!corner) return corner.error();
    const auto [at, fresh] = index.emplace(row.cells[0], views.size());
    if (fresh) {
      views.push_back({row.cells[0], {}});
      seen.emplace_back();
    }
    if (auto status = addOnce(&seen[at->second], *corner, file, " in view " + row.cells[0]); !status) return status.error();
    views[at->second].corners.push_back(*corner);
  }
  return views;
}

Result<std::vector<BoardView>> readCornersFile(const std::string& path) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  return parseCorners(*text, path);
}

Result<BoardView> parseFixturePoints(std::string_view text, const std::string& file) {
  const auto rows = parseCsv(text, file, kPointColumns);
  if (!rows) return rows.error();
  BoardView view;
  std::map<Place, int> seen;
  for (const auto& row : *rows) {
    const auto corner = cornerOf(file, row, kPointColumns, 0);
    if (!corner) return corner.error();
    if (auto status = addOnce(&seen, *corner, file, ""); !status) return status.error();
    view.corners.push_back(*corner);
  }
  return view;
}

Result<BoardView> readFixturePoints(const std::string& path) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  return parseFixturePoints(*text, path);
}

}  // namespace longarm::calibration
