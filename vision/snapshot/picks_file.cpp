// picks.csv, and the features that views and picks make.
#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "core/printable.h"
#include "core/text.h"
#include "vision/snapshot/views_file.h"
#include "vision/stereo/line.h"
#include "vision/stereo/measure.h"
#include "vision/stereo/pipe.h"

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

// The word of the kind column.
std::string kindWord(const Pick& pick) {
  if (pick.rule == PickRule::kEdge) return "edge";
  return pick.rule == PickRule::kPipe ? "pipe" : toString(pick.kind);
}

int vertexCount(const Pick& pick) { return pick.rule == PickRule::kPipe ? 4 : vision::vertexCount(pick.kind); }

bool readKind(const std::string& word, Pick* pick) {
  if (word == "edge" || word == "pipe") {
    pick->kind = FeatureKind::kLine;
    pick->rule = word == "edge" ? PickRule::kEdge : PickRule::kPipe;
    return true;
  }
  const auto kind = featureKindFrom(word);
  if (kind) pick->kind = *kind;
  return kind.has_value();
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
  if (!readKind(cells[1], &pick)) {
    return place.error("kind " + inQuotes(cells[1]) + " is none of point, line, edge, pipe, plane, triad");
  }
  const auto vertex = parseInteger(cells[2]);
  if (!vertex || *vertex < 0 || *vertex >= vertexCount(pick)) {
    return place.error("vertex " + inQuotes(cells[2]) + " is not 0 to " + std::to_string(vertexCount(pick) - 1) +
                       ", which a " + kindWord(pick) + " has");
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

using Vertices = std::vector<std::vector<Sighting>>;

// The picks of one feature, by vertex: matched ones, and those of edges or outlines.
struct Group {
  explicit Group(const Pick& pick)
      : first(pick), matched(static_cast<std::size_t>(vision::vertexCount(pick.kind))), outline(4) {}

  Pick first;
  Vertices matched, outline;
  bool hasEdges() const { return !outline[0].empty() || !outline[1].empty(); }
};

// A line may have matched ends in some views and be an edge in others.
bool mayMix(const Pick& a, const Pick& b) {
  if (a.kind != b.kind) return false;
  return a.rule == b.rule || (a.rule != PickRule::kPipe && b.rule != PickRule::kPipe);
}

Error pickError(const Pick& pick, const std::string& what) {
  return printable(Error{ErrorCode::kInvalidInput, "picks, line " + std::to_string(pick.line) + ": " + what});
}

Error unknownView(const ViewSet& views, const Pick& pick) {
  std::string names;
  for (const auto& entry : views.entries) names += (names.empty() ? "" : ", ") + entry.view.name;
  return pickError(pick, "view " + inQuotes(pick.view) + " is not in the views file (" + names.substr(0, 200) + ")");
}

Status addPick(const ViewSet& views, const Pick& pick, Group* group) {
  if (!mayMix(pick, group->first)) {
    return pickError(pick, "feature " + inQuotes(pick.feature) + " is a " + kindWord(pick) + " here but a " +
                               kindWord(group->first) + " in line " + std::to_string(group->first.line));
  }
  const View* view = views.find(pick.view);
  if (view == nullptr) return unknownView(views, pick);
  if (pick.vertex < 0 || pick.vertex >= vertexCount(pick)) {
    return pickError(pick, "vertex " + std::to_string(pick.vertex) + " is more than a " + kindWord(pick) + " has");
  }
  const auto index = static_cast<std::size_t>(pick.vertex);
  for (const auto* vertices : {&group->matched, &group->outline}) {
    if (index >= vertices->size()) continue;
    for (const auto& sighting : (*vertices)[index]) {
      if (sighting.view == view) {
        return pickError(pick, "vertex " + std::to_string(pick.vertex) + " of " + inQuotes(pick.feature) +
                                   " is picked twice in view " + inQuotes(pick.view));
      }
    }
  }
  (pick.rule == PickRule::kMatched ? group->matched : group->outline)[index].push_back({view, pick.pixel, 0});
  return {};
}

const Sighting* seenBy(const std::vector<Sighting>& sightings, const View* view) {
  const auto found = std::find_if(sightings.begin(), sightings.end(), [&](const auto& s) { return s.view == view; });
  return found == sightings.end() ? nullptr : &*found;
}

Error missingVertex(const Group& group, int vertex, const View& view) {
  return {ErrorCode::kInvalidInput, "vertex " + std::to_string(vertex) + " of the " + kindWord(group.first) +
                                        " is not picked in view \"" + view.name + "\": a " + kindWord(group.first) +
                                        " needs all of its picks in every view it is marked in"};
}

// The views of an edge or outline, each with its first `count` picks.
Result<std::vector<std::vector<const Sighting*>>> outlinesOf(const Group& group, int count) {
  std::vector<const View*> views;
  for (const auto& vertex : group.outline) {
    for (const auto& sighting : vertex) {
      if (std::find(views.begin(), views.end(), sighting.view) == views.end()) views.push_back(sighting.view);
    }
  }
  std::vector<std::vector<const Sighting*>> out;
  for (const auto* view : views) {
    out.emplace_back();
    for (int i = 0; i < count; ++i) {
      out.back().push_back(seenBy(group.outline[static_cast<std::size_t>(i)], view));
      if (out.back().back() == nullptr) return missingVertex(group, i, *view);
    }
  }
  return out;
}

Result<Feature> measureGroup(const Group& group, const TriangulationOptions& options) {
  const std::string& name = group.first.feature;
  if (group.first.rule == PickRule::kPipe) {
    const auto outlines = outlinesOf(group, 4);
    if (!outlines) return outlines.error();
    std::vector<PipeSighting> sightings;
    for (const auto& o : *outlines) sightings.push_back({o[0]->view, o[0]->pixel, o[1]->pixel, o[2]->pixel, o[3]->pixel});
    return estimatePipe(name, sightings);
  }
  if (!group.hasEdges()) return measureFeature(name, group.first.kind, group.matched, options);
  const auto edges = outlinesOf(group, 2);
  if (!edges) return edges.error();
  LinePicks picks{group.matched[0], group.matched[1], {}};
  for (const auto& edge : *edges) picks.along.push_back({edge[0]->view, edge[0]->pixel, edge[1]->pixel});
  return estimateLine(name, picks, options);
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
    if (is_new) groups.emplace_back(pick);
    if (auto status = addPick(views, pick, &groups[known->second]); !status) return status.error();
  }
  std::vector<MeasuredFeature> out;
  for (const auto& group : groups) {
    out.push_back({group.first.feature, group.first.kind, measureGroup(group, options)});
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
