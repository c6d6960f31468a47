#include "planning/world/json_reader.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace longarm::planning::internal {
namespace {

const nlohmann::json& emptyMap() {
  static const nlohmann::json kEmpty = nlohmann::json::object();
  return kEmpty;
}

const nlohmann::json& emptyList() {
  static const nlohmann::json kEmpty = nlohmann::json::array();
  return kEmpty;
}

std::string shown(const nlohmann::json& value) {
  std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

}  // namespace

FieldReader::FieldReader(const nlohmann::json& map, std::string place)
    : m_map(map.is_object() ? map : emptyMap()), m_place(std::move(place)) {
  if (!map.is_object()) fail("is " + shown(map) + "; expected a map of keys and values");
}

const nlohmann::json* FieldReader::find(const char* key) {
  m_asked.emplace_back(key);
  const auto found = m_map.find(key);
  return found == m_map.end() || found->is_null() ? nullptr : &*found;
}

bool FieldReader::has(const char* key) const { return m_map.contains(key) && !m_map.at(key).is_null(); }

void FieldReader::fail(const std::string& sentence) {
  if (m_status) m_status = Error{ErrorCode::kInvalidInput, m_place + ": " + sentence};
}

void FieldReader::adopt(const Status& status) {
  if (m_status && !status) m_status = status;
}

double FieldReader::number(const char* key, double fallback, double lower, double upper) {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return fallback;
  const double number = value->is_number() ? value->get<double>() : std::nan("");
  if (number >= lower && number <= upper) return number;
  fail(std::string(key) + " is " + shown(*value) + "; expected a number from " + formatNumber(lower) + " to " +
       formatNumber(upper));
  return fallback;
}

bool FieldReader::boolean(const char* key, bool fallback) {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return fallback;
  if (value->is_boolean()) return value->get<bool>();
  fail(std::string(key) + " is " + shown(*value) + "; expected true or false");
  return fallback;
}

std::string FieldReader::text(const char* key, const std::string& fallback) {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return fallback;
  if (value->is_string() && value->get_ref<const std::string&>().size() <= 4096) return value->get<std::string>();
  fail(std::string(key) + " is " + shown(*value) + "; expected a text of at most 4096 characters");
  return fallback;
}

std::string FieldReader::requiredText(const char* key) {
  if (!has(key)) fail(std::string("key \"") + key + "\" is missing");
  const std::string value = text(key, {});
  if (has(key) && value.empty()) fail(std::string(key) + " is empty; expected a text");
  return value;
}

std::vector<std::string> FieldReader::texts(const char* key) {
  std::vector<std::string> values;
  for (const nlohmann::json& entry : list(key, 64)) {
    if (!entry.is_string()) {
      fail(std::string(key) + " holds " + shown(entry) + "; expected names");
      return {};
    }
    values.push_back(entry.get<std::string>());
  }
  return values;
}

std::vector<double> FieldReader::numbers(const char* key, std::size_t count, double lower, double upper) {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return {};
  bool good = value->is_array() && value->size() == count;
  std::vector<double> result;
  for (std::size_t i = 0; good && i < count; ++i) {
    const nlohmann::json& entry = (*value)[i];
    const double number = entry.is_number() ? entry.get<double>() : std::nan("");
    good = number >= lower && number <= upper;
    result.push_back(number);
  }
  if (good) return result;
  fail(std::string(key) + " is " + shown(*value) + "; expected " + std::to_string(count) + " numbers from " +
       formatNumber(lower) + " to " + formatNumber(upper));
  return {};
}

Eigen::Vector3d FieldReader::vector(const char* key, const Eigen::Vector3d& fallback, double limit) {
  const std::vector<double> values = numbers(key, 3, -limit, limit);
  return values.empty() ? fallback : Eigen::Vector3d(values[0], values[1], values[2]);
}

Pose FieldReader::pose(const char* key) {
  const nlohmann::json* value = map(key);
  if (value == nullptr) return Pose::Identity();
  FieldReader reader(*value, m_place + "." + key);
  const Eigen::Vector3d xyz = reader.vector("xyz", Eigen::Vector3d::Zero(), 1000);
  const std::vector<double> quaternion = reader.numbers("quaternion_xyzw", 4, -10, 10);
  const Eigen::Vector3d rpy = reader.vector("rpy_deg", Eigen::Vector3d::Zero(), 3600) * (M_PI / 180);
  reader.refuseUnknownKeys();
  Pose X = poseFromRpy(xyz, rpy);
  if (!quaternion.empty()) {
    const Eigen::Vector4d q(quaternion[0], quaternion[1], quaternion[2], quaternion[3]);
    if (q.norm() < 1e-6) reader.fail("quaternion_xyzw is zero; expected a rotation");
    if (reader.has("rpy_deg")) reader.fail("holds both quaternion_xyzw and rpy_deg; expected one of them");
    if (reader.status()) X = poseFrom(xyz, q);
  }
  adopt(reader.status());
  return X;
}

const nlohmann::json& FieldReader::list(const char* key, std::size_t limit) {
  const nlohmann::json* value = find(key);
  if (value == nullptr) return emptyList();
  if (value->is_array() && value->size() <= limit) return *value;
  fail(std::string(key) + (value->is_array() ? " holds " + std::to_string(value->size()) + " entries"
                                             : " is " + shown(*value)) +
       "; expected a list of at most " + std::to_string(limit));
  return emptyList();
}

const nlohmann::json* FieldReader::map(const char* key) {
  const nlohmann::json* value = find(key);
  if (value == nullptr || value->is_object()) return value;
  fail(std::string(key) + " is " + shown(*value) + "; expected a map");
  return nullptr;
}

void FieldReader::refuseUnknownKeys() {
  for (const auto& entry : m_map.items()) {
    if (std::find(m_asked.begin(), m_asked.end(), entry.key()) == m_asked.end()) {
      fail("unknown key \"" + entry.key().substr(0, 60) + "\"");
    }
  }
}

}  // namespace longarm::planning::internal
