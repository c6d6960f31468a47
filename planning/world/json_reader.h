#pragma once

/// @file
/// Reads fields of a JSON (or YAML) map with messages that name the place.  Internal to planning/world.

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/pose.h"
#include "core/result.h"

namespace longarm::planning::internal {

/// One map of a file.  The first mistake is kept and later reads give their fallbacks: read everything, then ask
/// status().  Thread-compatible.
class FieldReader {
 public:
  /// @param place "scenario.yaml: objects[2]", the beginning of every message.
  FieldReader(const nlohmann::json& map, std::string place);

  bool has(const char* key) const;
  double number(const char* key, double fallback, double lower, double upper);
  bool boolean(const char* key, bool fallback);
  std::string text(const char* key, const std::string& fallback);
  std::string requiredText(const char* key);
  std::vector<std::string> texts(const char* key);
  /// Exactly `count` finite numbers within [lower, upper]; empty when the key is absent.
  std::vector<double> numbers(const char* key, std::size_t count, double lower, double upper);
  Eigen::Vector3d vector(const char* key, const Eigen::Vector3d& fallback, double limit);
  /// {xyz: [..], quaternion_xyzw: [..]} or {xyz: [..], rpy_deg: [..]}; identity when absent.
  Pose pose(const char* key);
  /// The list under a key; empty when absent.  At most `limit` entries.
  const nlohmann::json& list(const char* key, std::size_t limit);
  const nlohmann::json* map(const char* key);

  /// Every key that was never asked for is a mistake (a typing error must not pass silently).
  void refuseUnknownKeys();
  void fail(const std::string& sentence);
  void adopt(const Status& status);
  const std::string& place() const { return m_place; }
  const Status& status() const { return m_status; }

 private:
  const nlohmann::json* find(const char* key);

  const nlohmann::json& m_map;
  std::string m_place;
  std::vector<std::string> m_asked;
  Status m_status;
};

}  // namespace longarm::planning::internal
