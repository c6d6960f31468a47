#include "calibration/pose/observations_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "vision/camera/camera_file.h"
#include "vision/camera/json_fields.h"

namespace longarm::calibration {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 64;
constexpr double kFarthest = 1e6;
constexpr std::size_t kMaxBytes = 64u << 20;
const char* const kKeys[3] = {"T_ext", "T_dev", "T_obj"};

Error bad(const std::string& what) { return {ErrorCode::kInvalidInput, what}; }

bool shallow(int depth, json::parse_event_t, json&) {
  if (depth > kMaxDepth) throw std::length_error("is nested deeper than 64 levels");
  return true;
}

bool isUnknown(const std::vector<LoopUnknown>& unknowns, const std::string& key) {
  return std::any_of(unknowns.begin(), unknowns.end(), [&](LoopUnknown u) { return key == toString(u); });
}

Result<double> numberAt(const json& object, const char* key, const std::string& where) {
  if (!object.contains(key)) return bad(where + ": key \"" + key + "\" is missing");
  return vision::numberFromJson(object[key], where + "." + key);
}

Result<LoopPoint> pointFrom(const json& value, const std::string& where) {
  if (!value.is_object()) return bad(where + ": " + vision::shortText(value) + " is not a point {xyz, u, v}");
  if (!value.contains("xyz")) return bad(where + ": key \"xyz\" is missing");
  const auto xyz = vision::numbersFromJson(value["xyz"], where + ".xyz", 3);
  if (!xyz) return xyz.error();
  const auto u = numberAt(value, "u", where), v = numberAt(value, "v", where);
  if (!u) return u.error();
  if (!v) return v.error();
  for (const double number : {(*xyz)[0], (*xyz)[1], (*xyz)[2], *u, *v}) {
    if (std::abs(number) > kFarthest) return bad(where + ": " + formatNumber(number) + " is beyond 1e6 (metres for xyz, pixels for u and v)");
  }
  LoopPoint point{{(*xyz)[0], (*xyz)[1], (*xyz)[2]}, {*u, *v}, 0};
  if (value.contains("sigma_m")) {
    const auto sigma = numberAt(value, "sigma_m", where);
    if (!sigma) return sigma.error();
    if (*sigma < 0) return bad(where + ".sigma_m: " + formatNumber(*sigma) + " is negative");
    point.sigma_m = *sigma;
  }
  return point;
}

// A transform of a view, of the whole file, or none.
Result<std::optional<PoseInParent>> transformAt(const json& view, const json& file, const char* key, const std::string& where) {
  for (const json* object : {&view, &file}) {
    if (!object->contains(key) || (*object)[key].is_null()) continue;
    const auto pose = vision::poseFromJson((*object)[key], (object == &view ? where + "." : std::string()) + key, "");
    if (!pose) return pose.error();
    return std::optional<PoseInParent>(*pose);
  }
  return std::optional<PoseInParent>();
}

Status readTransforms(const json& value, const json& file, const std::vector<LoopUnknown>& unknowns, const std::string& where,
                      LoopView* view, Observations* out) {
  Pose* const places[3] = {&view->T_ext, &view->T_dev, &view->T_obj};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found = transformAt(value, file, kKeys[i], where);
    if (!found) return found.error();
    if (*found) {
      *places[i] = (*found)->pose;
      if (!out->given[i]) out->given[i] = (*found)->pose;
      if (!(*found)->parent.empty()) out->parents[i] = (*found)->parent;
    } else if (!isUnknown(unknowns, kKeys[i])) {
      return bad(where + ": " + kKeys[i] + " is missing, here and at the top of the file; give it, or solve for it (a transform that "
                 "does nothing is {\"xyz\": [0, 0, 0], \"quaternion_xyzw\": [0, 0, 0, 1]})");
    }
  }
  const auto kin = transformAt(value, file, "T_kin", where);
  if (!kin) return kin.error();
  if (!*kin) {
    return bad(where + ": T_kin is missing; for a camera that does not move it is {\"xyz\": [0, 0, 0], \"quaternion_xyzw\": [0, 0, 0, 1]}");
  }
  view->T_kin = (*kin)->pose;
  return {};
}

Result<LoopView> viewFrom(const json& value, const json& file, const std::vector<LoopUnknown>& unknowns, std::size_t index, Observations* out) {
  const std::string number = "views[" + std::to_string(index) + "]";
  if (!value.is_object()) return bad(number + ": " + vision::shortText(value) + " is not a view");
  LoopView view;
  view.name = value.contains("name") && value["name"].is_string() ? value["name"].get<std::string>() : std::to_string(index);
  const std::string where = number + " (" + view.name + ")";
  if (auto status = readTransforms(value, file, unknowns, where, &view, out); !status) return status.error();
  if (!value.contains("points") || !value["points"].is_array()) return bad(where + ": key \"points\" is missing or no list");
  for (std::size_t i = 0; i < value["points"].size(); ++i) {
    const auto point = pointFrom(value["points"][i], where + ".points[" + std::to_string(i) + "]");
    if (!point) return point.error();
    view.points.push_back(*point);
  }
  return view;
}

Status readCamera(const json& file, const std::filesystem::path& folder, bool needed, Observations* out) {
  if (!file.contains("camera") || file["camera"].is_null()) {
    if (needed) return bad("key \"camera\" is missing; name the camera file");
    return {};
  }
  const json& value = file["camera"];
  std::optional<double> zoom;
  if (file.contains("zoom")) {
    const auto number = vision::numberFromJson(file["zoom"], "zoom");
    if (!number) return number.error();
    zoom = *number;
  }
  if (!value.is_string() && !value.is_object()) return bad("camera: " + vision::shortText(value) + " is neither a file name nor a camera");
  const auto camera = value.is_string() ? vision::readCameraFile((folder / value.get<std::string>()).string(), zoom) : vision::cameraFromJson(value);
  if (!camera) return camera.error();
  out->problem.camera = camera->camera;
  out->has_camera = true;
  return {};
}

Result<Observations> parse(const json& file, const std::filesystem::path& folder, const std::vector<LoopUnknown>& unknowns) {
  if (!file.is_object()) return bad("expected a map with the keys camera and views, found " + vision::shortText(file));
  Observations out;
  if (auto status = readCamera(file, folder, !isUnknown(unknowns, "C_int"), &out); !status) return status.error();
  if (!file.contains("views") || !file["views"].is_array()) return bad("key \"views\" is missing or no list");
  for (std::size_t i = 0; i < file["views"].size(); ++i) {
    auto view = viewFrom(file["views"][i], file, unknowns, i, &out);
    if (!view) return view.error();
    out.problem.views.push_back(std::move(*view));
  }
  if (file.contains("sigma_px")) {
    const auto sigma = vision::numberFromJson(file["sigma_px"], "sigma_px");
    if (!sigma) return sigma.error();
    if (!(*sigma > 0)) return bad("sigma_px: " + formatNumber(*sigma) + " is not above 0");
    out.sigma_px = *sigma;
  }
  return out;
}

}  // namespace

Result<Observations> readObservations(const std::string& path, const std::vector<LoopUnknown>& unknowns) {
  const auto text = readTextFile(path, kMaxBytes);
  if (!text) return text.error();
  json file;
  try {
    file = json::parse(*text, shallow);
  } catch (const std::exception& error) {
    return bad(path + ": is not JSON: " + error.what());
  }
  auto out = parse(file, std::filesystem::path(path).parent_path(), unknowns);
  if (!out) return Error{out.error().code, path + ": " + out.error().message};
  return out;
}

}  // namespace longarm::calibration
