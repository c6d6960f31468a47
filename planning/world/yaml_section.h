#pragma once

/// @file
/// Strict reading of YAML maps: every value is named by its place, and nothing is converted by guesswork.

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <yaml-cpp/yaml.h>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::planning::internal {

/// What a reading has met: the first error decides, warnings add up.
struct YamlFindings {
  std::string file;
  std::optional<Error> error;
  std::vector<std::string> warnings;

  /// Keeps the first error only.  `node` tells the line.
  void refuse(const YAML::Node& node, const std::string& what);
  void warn(const YAML::Node& node, const std::string& what);
};

/// Which numbers a key may hold.
enum class NumberRange { kAny, kPositive, kNotNegative };

/// A map of the file.  Reading a key that is missing or of the wrong kind notes an error and returns a default, so
/// that a reader can go on and check YamlFindings::error once at its end.  Thread-compatible.
class YamlSection {
 public:
  YamlSection(YAML::Node node, std::string trail, YamlFindings& findings);

  bool has(const std::string& key) const;
  /// "arm.tip", for messages.
  std::string trailOf(const std::string& key) const;
  /// Notes an error about the value of `key`: "...: arm.tip is "x"; expected ...".
  void refuse(const std::string& key, const std::string& expected) const;

  std::string text(const std::string& key);
  std::string textOr(const std::string& key, const std::string& fallback);
  double number(const std::string& key, NumberRange range = NumberRange::kAny);
  double numberOr(const std::string& key, double fallback, NumberRange range = NumberRange::kAny);
  bool flagOr(const std::string& key, bool fallback);
  std::vector<double> numbers(const std::string& key, std::size_t count, NumberRange range = NumberRange::kAny);
  std::vector<std::string> textsOr(const std::string& key);
  /// name -> number; empty when the key is missing.
  std::map<std::string, double> numberMapOr(const std::string& key);
  std::map<std::string, std::string> textMapOr(const std::string& key);
  /// One number for all, or one for each of `count`.
  std::vector<double> numberOrNumbers(const std::string& key, std::size_t count, NumberRange range);
  /// {xyz, quaternion_xyzw or rpy}; identity when the key is missing.
  Pose poseOr(const std::string& key);

  YamlSection section(const std::string& key);
  std::optional<YamlSection> sectionOr(const std::string& key);
  /// The maps of a list; empty when the key is missing.
  std::vector<YamlSection> sections(const std::string& key);
  /// The maps of a map by their names; empty when the key is missing.
  std::vector<std::pair<std::string, YamlSection>> namedSections(const std::string& key);

  /// Warns of keys that nobody asked for.
  void finish() const;

 private:
  YAML::Node child(const std::string& key);
  YAML::Node required(const std::string& key);
  double toNumber(const YAML::Node& node, const std::string& trail, NumberRange range) const;
  std::string toText(const YAML::Node& node, const std::string& trail) const;

  YAML::Node m_node;
  std::string m_trail;
  YamlFindings* m_findings;
  std::set<std::string> m_asked;
};

/// The top map of a file of at most 1 MB.  @returns kNotFound or kInvalidInput naming file, line and cause.
/// Parsing never throws; what hangs or bloats other readers is refused.
Result<YAML::Node> readYamlMap(const std::string& path);

}  // namespace longarm::planning::internal
