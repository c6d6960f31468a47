// picks.csv, and the features that views and picks make.
#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "core/printable.h"
#include "core/text.h"
#include "vision/snapshot/views_file.h"
#include "vision/stereo/measure.h"

namespace longarm::vision {
namespace {

using nlohmann::json;

constexpr const char* kHeader = "feature,kind,vertex,view,u,v";
constexpr std::size_t kMaxPicks = 200000, kMaxFileBytes = 16u << 20;

struct Place {
  const std::string& file;
  int line;
  Error error(const std::string& what) const {
    return printable(Error{ErrorCode::kInvalidInput, "picks file " + file + ", line " + std::to_string(line) + ": " + what});
  }
};

std::string inQuotes(std::string_view text) {
  return "\"" + std::string(text.substr(0, 60)) + "\"";
}

Result<Pick> parseRow(const std::string& row, const Place& place) {
  std::vector<std::string> cells = split(row, ',');
  for (auto& cell : cells) cell = std::string(trimmed(cell));
  if (cells.size() != 6) {
    return place.error("has " + std::to_string(cells.size()) + " columns; expected 6 (" + kHeader +
                       ", numbers with a decimal point)");
  }
  Pick pick;
  pick.line = place.line;
  pick.feature = cells[0];
  if (pick.feature.empty()) return place.error("feature has no name");
  const auto kind = featureKindFrom(cells[1]);
  if (!kind) return place.error("kind " + inQuotes(cells[1]) + " is none of point, line, plane, triad");
  pick.kind = *kind;
  const auto vertex = parseInteger(cells[2]);
  if (!vertex || *vertex < 0 || *vertex >= vertexCount(*kind)) {
    return place.error("vertex " + inQuotes(cells[2]) + " is not 0 to " + std::to_string(vertexCount(*kind) - 1) +
                       ", which a " + toString(*kind) + " has");
  }
  pick.vertex = static_cast<int>(*vertex);
  pick.view = cells[3];
  for (const auto& [column, name] : {std::pair<int, const char*>{4, "u"}, {5, "v"}}) {
    const auto number = parseNumber(cells[static_cast<std::size_t>(column)]);
    if (!number || !(std::abs(*number) <= 1e6)) {
      return place.error(std::string(name) + " " + inQuotes(cells[static_cast<std::size_t>(column)]) +
                         " is not a pixel coordinate (write 1.5, not 1,5)");
    }
    pick.pixel[column - 4] = *number;
  }
  return pick;
}

Status checkHeader(std::string line, const Place& place) {
  line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
  if (trimmed(line) == kHeader) return {};
  return place.error("header is " + inQuotes(line) + "; expected " + kHeader);
}

// The picks of one feature, by vertex.
struct Group {
  std::string name;
  FeatureKind kind = FeatureKind::kPoint;
  int first_line = 0;
  std::vector<std::vector<Sighting>> vertices;
};

Error pickError(const Pick& pick, const std::string& what) {
  return printable(Error{ErrorCode::kInvalidInput, "picks, line " + std::to_string(pick.line) + ": " + what});
}

Status addPick(const ViewSet& views, const Pick& pick, Group* group) {
  if (group->kind != pick.kind) {
    return pickError(pick, "feature " + inQuotes(pick.feature) + " is a " + toString(pick.kind) + " here but a " +
                               toString(group->kind) + " in line " + std::to_string(group->first_line));
  }
  const View* view = views.find(pick.view);
  if (view == nullptr) {
    std::string names;
    for (const auto& entry : views.entries) names += (names.empty() ? "" : ", ") + entry.view.name;
    return pickError(pick, "view " + inQuotes(pick.view) + " is not in the views file (" + names.substr(0, 200) + ")");
  }
  if (pick.vertex < 0 || pick.vertex >= vertexCount(pick.kind)) {
    return pickError(pick, "vertex " + std::to_string(pick.vertex) + " is more than a " + toString(pick.kind) + " has");
  }
  auto& vertex = group->vertices[static_cast<std::size_t>(pick.vertex)];
  for (const auto& sighting : vertex) {
    if (sighting.view == view) {
      return pickError(pick, "vertex " + std::to_string(pick.vertex) + " of " + inQuotes(pick.feature) +
                                 " is picked twice in view " + inQuotes(pick.view));
    }
  }
  vertex.push_back({view, pick.pixel, 0});
  return {};
}

json refusedJson(const MeasuredFeature& feature) {
  return {{"name", feature.name},
          {"kind", toString(feature.kind)},
          {"status", toString(feature.outcome.error().code)},
          {"reason", feature.outcome.error().message}};
}

}  // namespace

Result<std::vector<Pick>> parsePicks(std::string_view text, const std::string& file_name) {
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  std::vector<Pick> picks;
  bool has_header = false;
  int line = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string row(trimmed(text.substr(at, end - at)));
    at = end + 1;
    const Place place{file_name, ++line};
    if (row.empty()) continue;
    if (!has_header) {
      if (auto status = checkHeader(row, place); !status) return status.error();
      has_header = true;
      continue;
    }
    if (picks.size() >= kMaxPicks) return place.error("more than " + std::to_string(kMaxPicks) + " picks");
    auto pick = parseRow(row, place);
    if (!pick) return pick.error();
    picks.push_back(std::move(*pick));
  }
  if (picks.empty()) {
    return Error{ErrorCode::kInvalidInput,
                 "picks file " + file_name + ": holds no picks; expected the header " + kHeader + " and rows"};
  }
  return picks;
}

Result<std::vector<Pick>> readPicksFile(const std::string& path) {
  const auto text = readTextFile(path, kMaxFileBytes);
  if (!text) return text.error();
  return parsePicks(*text, path);
}

Result<std::vector<MeasuredFeature>> measureAll(const ViewSet& views, const std::vector<Pick>& picks,
                                                const TriangulationOptions& options) {
  std::vector<Group> groups;
  std::map<std::string, std::size_t> by_name;
  for (const auto& pick : picks) {
    const auto [known, is_new] = by_name.emplace(pick.feature, groups.size());
    if (is_new) {
      groups.push_back({pick.feature, pick.kind, pick.line, {}});
      groups.back().vertices.resize(static_cast<std::size_t>(vertexCount(pick.kind)));
    }
    if (auto status = addPick(views, pick, &groups[known->second]); !status) return status.error();
  }
  std::vector<MeasuredFeature> out;
  for (const auto& group : groups) {
    out.push_back({group.name, group.kind, measureFeature(group.name, group.kind, group.vertices, options)});
  }
  return out;
}

json targetJson(const std::vector<MeasuredFeature>& features) {
  json out = {{"features", json::array()}};
  std::size_t measured = 0;
  for (const auto& feature : features) {
    measured += feature.outcome.ok() ? 1 : 0;
    out["features"].push_back(feature.outcome.ok() ? toJson(*feature.outcome) : refusedJson(feature));
  }
  if (measured == 0) {
    out["status"] = features.empty() ? "invalid_input" : toString(features.front().outcome.error().code);
    out["reason"] = features.empty() ? "there are no picks" : features.front().outcome.error().message;
  }
  return out;
}

}  // namespace longarm::vision
