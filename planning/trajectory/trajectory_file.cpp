#include "planning/trajectory/trajectory_file.h"

#include <nlohmann/json.hpp>

#include "core/printable.h"
#include "core/text.h"

namespace longarm::planning {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxBytes = 64u << 20;
constexpr std::size_t kMaxPoints = 200000;
constexpr std::size_t kMaxJoints = 64;

json toArray(const Eigen::VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); }

std::string shortened(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

Error bad(const std::string& where, const std::string& what) {
  return {ErrorCode::kInvalidInput, "trajectory: " + where + ": " + what};
}

Result<Eigen::VectorXd> numbers(const json& point, const std::string& where, const char* key, std::size_t n) {
  const auto it = point.find(key);
  if (it == point.end() || !it->is_array() || it->size() != n) {
    return bad(where, std::string("\"") + key + "\" must be an array of " + std::to_string(n) + " numbers, is " +
                          (it == point.end() ? "missing" : shortened(*it)));
  }
  Eigen::VectorXd out(static_cast<Eigen::Index>(n));
  for (std::size_t j = 0; j < n; ++j) {
    if (!(*it)[j].is_number()) {
      return bad(where, std::string(key) + "[" + std::to_string(j) + "] must be a number, is " + shortened((*it)[j]));
    }
    out[static_cast<Eigen::Index>(j)] = (*it)[j].get<double>();
  }
  return out;
}

Result<TrajectoryPoint> pointFromJson(const json& point, std::size_t i, std::size_t n) {
  const std::string where = "points[" + std::to_string(i) + "]";
  if (!point.is_object()) return bad(where, "must be an object, is " + shortened(point));
  const auto t = point.find("t");
  if (t == point.end() || !t->is_number()) {
    return bad(where, "\"t\" must be a number, is " + (t == point.end() ? "missing" : shortened(*t)));
  }
  auto q = numbers(point, where, "positions", n);
  if (!q) return q.error();
  auto v = numbers(point, where, "velocities", n);
  if (!v) return v.error();
  auto a = numbers(point, where, "accelerations", n);
  if (!a) return a.error();
  return TrajectoryPoint{t->get<double>(), *std::move(q), *std::move(v), *std::move(a)};
}

Result<std::vector<std::string>> namesFromJson(const json& value) {
  const auto names = value.find("joint_names");
  if (names == value.end() || !names->is_array() || names->empty() || names->size() > kMaxJoints) {
    return bad("joint_names", "must be an array of 1 to " + std::to_string(kMaxJoints) + " names");
  }
  std::vector<std::string> out;
  for (const auto& name : *names) {
    if (!name.is_string()) return bad("joint_names", "must hold strings, holds " + shortened(name));
    out.push_back(name.get<std::string>());
  }
  return out;
}

}  // namespace

json toJson(const Trajectory& trajectory) {
  json points = json::array();
  for (const auto& p : trajectory.points) {
    points.push_back({{"t", p.t},
                      {"positions", toArray(p.positions)},
                      {"velocities", toArray(p.velocities)},
                      {"accelerations", toArray(p.accelerations)}});
  }
  return {{"joint_names", trajectory.joint_names}, {"points", std::move(points)}};
}

Result<Trajectory> trajectoryFromJson(const json& value) {
  if (!value.is_object()) return bad("top level", "must be an object with joint_names and points, is " + shortened(value));
  auto names = namesFromJson(value);
  if (!names) return names.error();
  const auto points = value.find("points");
  if (points == value.end() || !points->is_array() || points->empty() || points->size() > kMaxPoints) {
    return bad("points", "must be an array of 1 to " + std::to_string(kMaxPoints) + " points");
  }
  Trajectory out;
  out.joint_names = *std::move(names);
  out.points.reserve(points->size());
  for (std::size_t i = 0; i < points->size(); ++i) {
    auto point = pointFromJson((*points)[i], i, out.joint_names.size());
    if (!point) return point.error();
    out.points.push_back(*std::move(point));
  }
  if (auto status = validate(out); !status) return status.error();
  return out;
}

Result<Trajectory> readTrajectory(const std::string& path) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  try {
    // The depth is bounded by the callback: a trajectory is at most 4 deep.
    const json value = json::parse(*text, [](int depth, json::parse_event_t, json&) {
      if (depth > 8) throw std::runtime_error("nested deeper than 8 levels");
      return true;
    });
    auto trajectory = trajectoryFromJson(value);
    if (!trajectory) return printable(Error{trajectory.error().code, path + ": " + trajectory.error().message});
    return trajectory;
  } catch (const std::exception& e) {
    return printable(Error{ErrorCode::kInvalidInput, path + ": not JSON: " + e.what()});
  }
}

Status writeTrajectory(const std::string& path, const Trajectory& trajectory) {
  return writeFileAtomically(path, toJson(trajectory).dump(1) + "\n");
}

}  // namespace longarm::planning
