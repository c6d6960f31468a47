#include "planning/world/yaml_section.h"

#include <algorithm>
#include <cmath>

#include "core/printable.h"
#include "core/text.h"

namespace longarm::planning::internal {
namespace {

constexpr std::size_t kLargestFile = 1u << 20;
constexpr std::size_t kLongestList = 10000;
constexpr int kDeepest = 40;

std::string shown(const YAML::Node& node) {
  if (!node.IsDefined() || node.IsNull()) return "empty";
  if (node.IsMap()) return "a map";
  if (node.IsSequence()) return "a list of " + std::to_string(node.size());
  return "\"" + node.Scalar().substr(0, 60) + "\"";
}

const char* describe(NumberRange range) {
  switch (range) {
    case NumberRange::kPositive: return "a finite number above 0";
    case NumberRange::kNotNegative: return "a finite number of at least 0";
    default: return "a finite number (with a decimal point)";
  }
}

bool isIn(double value, NumberRange range) {
  if (!std::isfinite(value)) return false;
  return range == NumberRange::kAny || value > 0 || (range == NumberRange::kNotNegative && value == 0);
}

/// Brackets and indents deeper than any file of ours, before the parser recurses into them.
bool isTooDeep(const std::string& text) {
  int depth = 0, dashes = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') depth = std::max(0, depth - 1);
    dashes = c == '-' || c == '?' || c == ' ' ? dashes + (c == ' ' ? 0 : 1) : 0;
    if (depth > kDeepest || dashes > kDeepest * 4) return true;
  }
  return false;
}

}  // namespace

void YamlFindings::refuse(const YAML::Node& node, const std::string& what) {
  if (error) return;
  const int line = node.IsDefined() ? node.Mark().line : -1;
  error = Error{ErrorCode::kInvalidInput,
                printable(file + (line >= 0 ? ":" + std::to_string(line + 1) : std::string()) + ": " + what.substr(0, 600))};
}

void YamlFindings::warn(const YAML::Node& node, const std::string& what) {
  const int line = node.IsDefined() ? node.Mark().line : -1;
  if (warnings.size() < 100) {
    warnings.push_back(printable(file + (line >= 0 ? ":" + std::to_string(line + 1) : std::string()) + ": " +
                                 what.substr(0, 600)));
  }
}

YamlSection::YamlSection(YAML::Node node, std::string trail, YamlFindings& findings)
    : m_node(node.IsDefined() && node.IsMap() ? node : YAML::Node(YAML::NodeType::Map)),
      m_trail(std::move(trail)),
      m_findings(&findings) {
  if (!node.IsDefined() || !node.IsMap()) {
    findings.refuse(node, (m_trail.empty() ? "the file" : m_trail) + " is " + shown(node) + "; expected a map");
    return;
  }
  std::set<std::string> seen;
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) {
      findings.refuse(entry.first, "a key is " + shown(entry.first) + "; expected a word");
    } else if (!seen.insert(entry.first.Scalar()).second) {
      findings.refuse(entry.first, trailOf(entry.first.Scalar().substr(0, 60)) + " is given twice");
    }
  }
}

std::string YamlSection::trailOf(const std::string& key) const { return m_trail.empty() ? key : m_trail + "." + key; }

bool YamlSection::has(const std::string& key) const {
  const YAML::Node& node = m_node;  // The const operator does not add keys.
  const YAML::Node found = node[key];
  return found.IsDefined() && !found.IsNull();
}

YAML::Node YamlSection::child(const std::string& key) {
  m_asked.insert(key);
  const YAML::Node& node = m_node;
  return node[key];
}

YAML::Node YamlSection::required(const std::string& key) {
  if (!has(key)) m_findings->refuse(m_node, trailOf(key) + " is missing");
  return child(key);
}

void YamlSection::refuse(const std::string& key, const std::string& expected) const {
  const YAML::Node& node = m_node;
  m_findings->refuse(has(key) ? node[key] : node, trailOf(key) + " is " + shown(node[key]) + "; expected " + expected);
}

double YamlSection::toNumber(const YAML::Node& node, const std::string& trail, NumberRange range) const {
  const auto value = node.IsDefined() && node.IsScalar() ? parseNumber(node.Scalar()) : std::nullopt;
  if (value && isIn(*value, range)) return *value;
  m_findings->refuse(node, trail + " is " + shown(node) + "; expected " + describe(range));
  return 1;
}

std::string YamlSection::toText(const YAML::Node& node, const std::string& trail) const {
  if (node.IsDefined() && node.IsScalar() && !node.Scalar().empty()) return node.Scalar();
  m_findings->refuse(node, trail + " is " + shown(node) + "; expected a word");
  return {};
}

std::string YamlSection::text(const std::string& key) { return toText(required(key), trailOf(key)); }

std::string YamlSection::textOr(const std::string& key, const std::string& fallback) {
  const YAML::Node node = child(key);
  return has(key) ? toText(node, trailOf(key)) : fallback;
}

double YamlSection::number(const std::string& key, NumberRange range) {
  return toNumber(required(key), trailOf(key), range);
}

double YamlSection::numberOr(const std::string& key, double fallback, NumberRange range) {
  const YAML::Node node = child(key);
  return has(key) ? toNumber(node, trailOf(key), range) : fallback;
}

bool YamlSection::flagOr(const std::string& key, bool fallback) {
  const YAML::Node node = child(key);
  if (!has(key)) return fallback;
  if (node.IsDefined() && node.IsScalar() && (node.Scalar() == "true" || node.Scalar() == "false")) return node.Scalar() == "true";
  refuse(key, "true or false");
  return fallback;
}

std::vector<double> YamlSection::numbers(const std::string& key, std::size_t count, NumberRange range) {
  const YAML::Node node = required(key);
  std::vector<double> values(count, 1.0);
  if (!node.IsDefined() || !node.IsSequence() || node.size() != count) {
    refuse(key, "a list of " + std::to_string(count) + " numbers");
    return values;
  }
  for (std::size_t i = 0; i < count; ++i) {
    values[i] = toNumber(node[i], trailOf(key) + "[" + std::to_string(i) + "]", range);
  }
  return values;
}

std::vector<double> YamlSection::numberOrNumbers(const std::string& key, std::size_t count, NumberRange range) {
  const YAML::Node node = required(key);
  if (node.IsDefined() && node.IsSequence()) return numbers(key, count, range);
  return std::vector<double>(count, toNumber(node, trailOf(key), range));
}

std::vector<std::string> YamlSection::textsOr(const std::string& key) {
  const YAML::Node node = child(key);
  std::vector<std::string> words;
  if (!has(key)) return words;
  if (!node.IsSequence() || node.size() > kLongestList) {
    refuse(key, "a list of words");
    return words;
  }
  for (std::size_t i = 0; i < node.size() && !m_findings->error; ++i) {
    words.push_back(toText(node[i], trailOf(key) + "[" + std::to_string(i) + "]"));
  }
  return words;
}

std::map<std::string, double> YamlSection::numberMapOr(const std::string& key) {
  std::map<std::string, double> values;
  if (auto map = sectionOr(key)) {
    for (const auto& entry : map->m_node) {
      if (m_findings->error || values.size() > kLongestList) break;
      const std::string name = entry.first.Scalar();
      values[name] = toNumber(entry.second, map->trailOf(name.substr(0, 60)), NumberRange::kAny);
    }
  }
  return values;
}

std::map<std::string, std::string> YamlSection::textMapOr(const std::string& key) {
  std::map<std::string, std::string> values;
  if (auto map = sectionOr(key)) {
    for (const auto& entry : map->m_node) {
      if (m_findings->error || values.size() > kLongestList) break;
      const std::string name = entry.first.Scalar();
      values[name] = toText(entry.second, map->trailOf(name.substr(0, 60)));
    }
  }
  return values;
}

Pose YamlSection::poseOr(const std::string& key) {
  auto map = sectionOr(key);
  if (!map) return Pose::Identity();
  const auto xyz = map->numbers("xyz", 3);
  const Eigen::Vector3d p(xyz[0], xyz[1], xyz[2]);
  Pose pose = Pose::Identity();
  if (map->has("rpy")) {
    const auto rpy = map->numbers("rpy", 3);
    pose = poseFromRpy(p, {rpy[0], rpy[1], rpy[2]});
  } else if (map->has("quaternion_xyzw")) {
    const auto q = map->numbers("quaternion_xyzw", 4);
    const Eigen::Vector4d quaternion(q[0], q[1], q[2], q[3]);
    if (std::abs(quaternion.norm() - 1) > 0.01) {
      map->refuse("quaternion_xyzw", "a unit quaternion; its length is " + formatNumber(quaternion.norm()));
      return pose;
    }
    pose = poseFrom(p, quaternion);
  } else {
    pose.translation() = p;
  }
  map->textOr("parent", "");
  map->finish();
  return pose;
}

YamlSection YamlSection::section(const std::string& key) {
  return YamlSection(required(key), trailOf(key), *m_findings);
}

std::optional<YamlSection> YamlSection::sectionOr(const std::string& key) {
  const YAML::Node node = child(key);
  if (!has(key)) return std::nullopt;
  return YamlSection(node, trailOf(key), *m_findings);
}

std::vector<YamlSection> YamlSection::sections(const std::string& key) {
  const YAML::Node node = child(key);
  std::vector<YamlSection> list;
  if (!has(key)) return list;
  if (!node.IsSequence() || node.size() > kLongestList) {
    refuse(key, "a list of maps");
    return list;
  }
  for (std::size_t i = 0; i < node.size() && !m_findings->error; ++i) {
    list.emplace_back(node[i], trailOf(key) + "[" + std::to_string(i) + "]", *m_findings);
  }
  return list;
}

std::vector<std::pair<std::string, YamlSection>> YamlSection::namedSections(const std::string& key) {
  std::vector<std::pair<std::string, YamlSection>> list;
  if (auto map = sectionOr(key)) {
    for (const auto& entry : map->m_node) {
      if (m_findings->error || list.size() > kLongestList) break;
      const std::string name = entry.first.Scalar();
      list.emplace_back(name, YamlSection(entry.second, map->trailOf(name.substr(0, 60)), *m_findings));
    }
  }
  return list;
}

void YamlSection::finish() const {
  for (const auto& entry : m_node) {
    if (!entry.first.IsScalar() || m_asked.count(entry.first.Scalar()) != 0) continue;
    m_findings->warn(entry.first, "key " + trailOf(entry.first.Scalar().substr(0, 60)) + " is unknown and ignored");
  }
}

Result<YAML::Node> readYamlMap(const std::string& path) {
  const auto text = readTextFile(path, kLargestFile);
  if (!text) return text.error();
  if (isTooDeep(*text)) {
    return Error{ErrorCode::kInvalidInput, path + ": nested deeper than " + std::to_string(kDeepest) + " levels"};
  }
  try {
    const YAML::Node node = YAML::Load(*text);
    if (node.IsMap()) return node;
    return printable(Error{ErrorCode::kInvalidInput, path + ":1: the file is " + shown(node) + "; expected a map"});
  } catch (const YAML::Exception& e) {
    return printable(
        Error{ErrorCode::kInvalidInput, path + ":" + std::to_string(e.mark.line + 1) + ": not YAML: " + e.msg});
  }
}

}  // namespace longarm::planning::internal
