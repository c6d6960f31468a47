#include "vision/camera/json_fields.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/text.h"

namespace longarm::vision {

using nlohmann::json;

namespace {

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

}  // namespace

std::string shortText(const json& value) {
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  if (value.is_object()) return "a map";
  std::string text = value.dump(-1, ' ', true, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

Result<double> numberFromJson(const json& value, const std::string& where) {
  if (!value.is_number()) return bad(where, shortText(value) + " is not a finite number (write 1.5, not 1,5)");
  const double number = value.get<double>();
  if (!std::isfinite(number)) return bad(where, "is not a finite number");
  return number;
}

Result<std::vector<double>> numbersFromJson(const json& value, const std::string& where, int count) {
  constexpr std::size_t kMost = 4096;
  if (!value.is_array()) return bad(where, shortText(value) + " is not a list of numbers");
  if (count >= 0 ? value.size() != static_cast<std::size_t>(count) : value.size() > kMost) {
    return bad(where, "holds " + std::to_string(value.size()) + " numbers; expected " +
                          (count >= 0 ? std::to_string(count) : "at most " + std::to_string(kMost)));
  }
  std::vector<double> numbers;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const auto number = numberFromJson(value[i], where + "[" + std::to_string(i) + "]");
    if (!number) return number.error();
    numbers.push_back(*number);
  }
  return numbers;
}

json toJson(const PoseInParent& pose) {
  const Eigen::Vector3d& p = pose.pose.translation();
  const Eigen::Vector4d q = quaternionXyzw(pose.pose.linear());
  return {{"parent", pose.parent},
          {"xyz", {p.x(), p.y(), p.z()}},
          {"quaternion_xyzw", {q[0], q[1], q[2], q[3]}}};
}

Result<PoseInParent> poseFromJson(const json& value, const std::string& where, const std::string& default_parent) {
  if (!value.is_object()) return bad(where, shortText(value) + " is not a pose {parent, xyz, quaternion_xyzw}");
  PoseInParent out;
  out.parent = default_parent;
  if (value.contains("parent")) {
    const json& parent = value["parent"];
    if (!parent.is_string() || parent.get_ref<const std::string&>().empty()) {
      return bad(where + ".parent", shortText(parent) + " is not the name of a frame");
    }
    out.parent = parent.get<std::string>();
  }
  for (const char* key : {"xyz", "quaternion_xyzw"}) {
    if (!value.contains(key)) return bad(where, std::string("key \"") + key + "\" is missing");
  }
  const auto xyz = numbersFromJson(value["xyz"], where + ".xyz", 3);
  if (!xyz) return xyz.error();
  const auto q = numbersFromJson(value["quaternion_xyzw"], where + ".quaternion_xyzw", 4);
  if (!q) return q.error();
  for (const double metres : *xyz) {
    if (std::abs(metres) > 1e6) return bad(where + ".xyz", formatNumber(metres) + " m is farther than 1e6 m");
  }
  const Eigen::Vector4d quaternion((*q)[0], (*q)[1], (*q)[2], (*q)[3]);
  const double length = quaternion.norm();
  if (!(std::abs(length - 1) <= 0.01)) {
    return bad(where + ".quaternion_xyzw", "has length " + formatNumber(length) + "; expected 1 (x, y, z, w)");
  }
  out.pose = poseFrom({(*xyz)[0], (*xyz)[1], (*xyz)[2]}, quaternion);
  return out;
}

}  // namespace longarm::vision
