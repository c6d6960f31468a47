#include "session/document/template_json.h"

#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

namespace longarm::session {

using nlohmann::json;

namespace {

constexpr std::size_t kMostParts = 200, kMostParameters = 200, kLongestName = 500;

json partJson(const planning::TemplatePart& part) {
  const Eigen::Vector3d p = part.X_TP.translation();
  const Eigen::Vector4d q = quaternionXyzw(part.X_TP.linear());
  json out = {{"name", part.name}, {"moves", part.moves}, {"xyz", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q(0), q(1), q(2), q(3)}}};
  if (const auto* box = std::get_if<planning::Box>(&part.shape)) out["box"] = {box->size.x(), box->size.y(), box->size.z()};
  if (const auto* c = std::get_if<planning::Cylinder>(&part.shape)) out["cylinder"] = {c->radius, c->length};
  if (const auto* s = std::get_if<planning::Sphere>(&part.shape)) out["sphere"] = {s->radius};
  return out;
}

// Empty where the key holds anything but so many finite numbers.
std::vector<double> numbersOf(const json& map, const char* key, std::size_t count) {
  const auto found = map.find(key);
  if (found == map.end() || !found->is_array() || found->size() != count) return {};
  std::vector<double> out;
  for (const auto& each : *found) {
    if (!each.is_number() || !std::isfinite(each.get<double>())) return {};
    out.push_back(each.get<double>());
  }
  return out;
}

bool isName(const json& map, const char* key) {
  const auto found = map.find(key);
  return found != map.end() && found->is_string() && found->get_ref<const std::string&>().size() <= kLongestName;
}

std::optional<planning::Shape> shapeOf(const json& part) {
  const auto positive = [](const std::vector<double>& sizes) {
    for (const double size : sizes) {
      if (!(size > 0 && size < kMostSize_m)) return false;
    }
    return !sizes.empty();
  };
  if (const auto s = numbersOf(part, "box", 3); positive(s)) return planning::Box{{s[0], s[1], s[2]}};
  if (const auto s = numbersOf(part, "cylinder", 2); positive(s)) return planning::Cylinder{s[0], s[1]};
  if (const auto s = numbersOf(part, "sphere", 1); positive(s)) return planning::Sphere{s[0]};
  return {};
}

Status readPart(const json& value, const std::string& where, WorldItem& item) {
  if (!value.is_object() || !isName(value, "name")) return {ErrorCode::kInvalidInput, where + ": expected a body with a name"};
  const auto xyz = numbersOf(value, "xyz", 3), q = numbersOf(value, "quaternion_xyzw", 4);
  const auto shape = shapeOf(value);
  if (xyz.empty() || q.empty()) return {ErrorCode::kInvalidInput, where + ": expected xyz and quaternion_xyzw"};
  const Eigen::Vector4d quaternion(q[0], q[1], q[2], q[3]);
  if (std::abs(quaternion.norm() - 1) > 0.01) return {ErrorCode::kInvalidInput, where + ".quaternion_xyzw: is not a unit quaternion"};
  if (!shape) return {ErrorCode::kInvalidInput, where + ": expected box, cylinder or sphere with sizes above 0"};
  item.parts.push_back({value["name"].get<std::string>(), *shape, poseFrom({xyz[0], xyz[1], xyz[2]}, quaternion),
                        value.contains("moves") && value["moves"].is_boolean() && value["moves"].get<bool>()});
  return {};
}

}  // namespace

json templateJson(const WorldItem& item) {
  json parts = json::array(), parameters = json::object();
  for (const auto& part : item.parts) parts.push_back(partJson(part));
  for (const auto& [name, value] : item.parameters) parameters[name] = value;
  return {{"template", item.template_name}, {"parameters", std::move(parameters)}, {"parts", std::move(parts)}};
}

Status readTemplate(const json& value, WorldItem& item) {
  if (!isName(value, "template")) return {ErrorCode::kInvalidInput, "template: expected a name"};
  item.template_name = value["template"].get<std::string>();
  const json none = json::object(), empty = json::array();
  const json& parameters = value.contains("parameters") ? value["parameters"] : none;
  const json& parts = value.contains("parts") ? value["parts"] : empty;
  if (!parameters.is_object() || parameters.size() > kMostParameters) return {ErrorCode::kInvalidInput, "parameters: expected names with numbers"};
  for (const auto& [name, number] : parameters.items()) {
    if (!number.is_number() || !std::isfinite(number.get<double>())) return {ErrorCode::kInvalidInput, "parameters." + name.substr(0, 50) + ": expected a number"};
    item.parameters[name] = number.get<double>();
  }
  if (!parts.is_array() || parts.size() > kMostParts) return {ErrorCode::kInvalidInput, "parts: expected a list of at most 200 bodies"};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (const Status read = readPart(parts[i], "parts[" + std::to_string(i) + "]", item); !read) return read;
  }
  return {};
}

}  // namespace longarm::session
