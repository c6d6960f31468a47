#include "session/calibration/placement.h"

#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/text.h"

namespace longarm::session {

namespace {

using nlohmann::json;

// A list of finite numbers; empty: it is none.
std::vector<double> numbers(const json& value, const char* key, std::size_t count) {
  std::vector<double> out;
  const auto found = value.find(key);
  if (found == value.end() || !found->is_array() || found->size() != count) return {};
  for (const auto& each : *found) {
    if (!each.is_number() || !std::isfinite(each.get<double>())) return {};
    out.push_back(each.get<double>());
  }
  return out;
}

}  // namespace

double Placement::uncertaintyAtOneMetre() const { return std::sqrt(std::max(0.0, covariance.trace())); }

Status writePlacement(const std::string& path, const Placement& placement) {
  const Eigen::Vector3d p = placement.pose.pose.translation();
  const Eigen::Vector4d q = quaternionXyzw(placement.pose.pose.linear());
  std::vector<double> C;
  for (int i = 0; i < 36; ++i) C.push_back(placement.covariance(i / 6, i % 6));
  const json out = {{"parent", placement.pose.parent}, {"xyz", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q[0], q[1], q[2], q[3]}}, {"covariance", C}};
  return writeFileAtomically(path, out.dump(2) + "\n");
}

Result<Placement> readPlacement(const std::string& path) {
  const auto text = readTextFile(path, 1u << 20);
  if (!text) return text.error();
  const json value = json::parse(*text, nullptr, false);
  const auto bad = [&](const std::string& what) { return Error{ErrorCode::kInvalidInput, path + ": " + what}; };
  if (!value.is_object()) return bad("is no JSON object");
  const auto xyz = numbers(value, "xyz", 3), q = numbers(value, "quaternion_xyzw", 4), C = numbers(value, "covariance", 36);
  if (xyz.empty()) return bad("xyz must be three numbers");
  if (q.empty() || std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) < 1e-6) return bad("quaternion_xyzw must be four numbers, not all zero");
  if (C.empty()) return bad("covariance must be 36 numbers");
  if (!value.contains("parent") || !value["parent"].is_string()) return bad("parent must be the name of a link");
  Placement out;
  out.pose.parent = value["parent"];
  out.pose.pose = poseFrom({xyz[0], xyz[1], xyz[2]}, {q[0], q[1], q[2], q[3]});
  for (int i = 0; i < 36; ++i) out.covariance(i / 6, i % 6) = C[static_cast<std::size_t>(i)];
  return out;
}

}  // namespace longarm::session
