#include "vision/snapshot/views_file.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "core/printable.h"
#include "core/text.h"
#include "vision/camera/bounded_yaml.h"
#include "vision/camera/camera_file.h"
#include "vision/camera/json_fields.h"

namespace longarm::vision {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t kMaxViews = 1000;
constexpr std::size_t kMaxFileBytes = 16u << 20;

Error bad(const std::string& where, const std::string& what) { return {ErrorCode::kInvalidInput, where + ": " + what}; }

Result<std::string> wordAt(const json& object, const char* key, const std::string& where) {
  if (!object.contains(key)) return bad(where, std::string("key \"") + key + "\" is missing");
  const json& value = object[key];
  if (value.is_number_integer()) return value.dump();   // a view may be called 1
  if (!value.is_string() || value.get_ref<const std::string&>().empty()) {
    return bad(where + "." + key, shortText(value) + " is not a word");
  }
  return value.get<std::string>();
}

std::string besides(const fs::path& folder, const std::string& path) {
  return fs::path(path).is_absolute() ? path : (folder / path).lexically_normal().string();
}

// A covariance must be symmetric with no negative variance.
Result<Matrix6d> poseCovariance(const json& value, const std::string& where) {
  const auto numbers = numbersFromJson(value, where, 36);
  if (!numbers) return numbers.error();
  Matrix6d out;
  for (int i = 0; i < 36; ++i) out(i / 6, i % 6) = (*numbers)[static_cast<std::size_t>(i)];
  if (out.diagonal().minCoeff() < 0) return bad(where, "has a negative variance");
  if (!out.isApprox(out.transpose(), 1e-6) && !out.isZero(0)) return bad(where, "is not symmetric");
  return out;
}

Status readCamera(const json& object, const fs::path& folder, const std::string& where, ViewEntry* entry) {
  if (object.contains("zoom")) {
    const auto zoom = numberFromJson(object["zoom"], where + ".zoom");
    if (!zoom) return zoom.error();
    entry->zoom = *zoom;
  }
  const auto camera = wordAt(object, "camera", where);
  if (!camera) return camera.error();
  entry->camera_file = besides(folder, *camera);
  const auto file = readCameraFile(entry->camera_file, entry->zoom);
  if (!file) return {file.error().code, where + ".camera: " + file.error().message};
  View& view = entry->view;
  view.camera = file->camera;
  if (file->covariance) view.intrinsics_covariance = file->covariance->topLeftCorner<10, 10>();
  if (view.camera.name.empty()) view.camera.name = view.name;
  if (object.contains("pose")) {
    const auto pose = poseFromJson(object["pose"], where + ".pose");
    if (!pose) return pose.error();
    view.parent = pose->parent;
    view.X_WC = pose->pose;
  } else if (file->pose) {
    view.parent = file->pose->parent;
    view.X_WC = file->pose->pose;
    if (file->covariance && file->covariance->rows() == 16) view.pose_covariance = file->covariance->bottomRightCorner<6, 6>();
  } else {
    return bad(where, "key \"pose\" is missing, and the camera file has none either");
  }
  return {};
}

Result<ViewEntry> readEntry(const json& object, const fs::path& folder, const std::string& where) {
  if (!object.is_object()) return bad(where, shortText(object) + " is not a view {name, camera, pose}");
  ViewEntry entry;
  const auto name = wordAt(object, "name", where);
  if (!name) return name.error();
  entry.view.name = *name;
  const std::string here = where + " \"" + *name + "\"";
  if (object.contains("image") && !object["image"].is_null()) {
    const auto image = wordAt(object, "image", here);
    if (!image) return image.error();
    entry.image = besides(folder, *image);
  }
  if (auto status = readCamera(object, folder, here, &entry); !status) return status.error();
  if (object.contains("sigma_px")) {
    const auto sigma = numberFromJson(object["sigma_px"], here + ".sigma_px");
    if (!sigma) return sigma.error();
    if (!(*sigma > 0 && *sigma <= 1000)) return bad(here + ".sigma_px", formatNumber(*sigma) + " is not above 0 and at most 1000");
    entry.view.sigma_px = *sigma;
  }
  if (object.contains("pose_covariance")) {
    const auto covariance = poseCovariance(object["pose_covariance"], here + ".pose_covariance");
    if (!covariance) return covariance.error();
    entry.view.pose_covariance = *covariance;
  }
  return entry;
}

Result<ViewSet> readViews(const json& content, const fs::path& folder) {
  if (!content.is_object() || !content.contains("views")) return bad("views", "is missing; expected `views:` and a list");
  const json& list = content["views"];
  if (!list.is_array() || list.empty() || list.size() > kMaxViews) {
    return bad("views", shortText(list) + "; expected a list of 1 to " + std::to_string(kMaxViews) + " views");
  }
  ViewSet set;
  for (std::size_t i = 0; i < list.size(); ++i) {
    auto entry = readEntry(list[i], folder, "views[" + std::to_string(i) + "]");
    if (!entry) return entry.error();
    const View& view = entry->view;
    if (set.find(view.name) != nullptr) return bad("views", "\"" + view.name + "\" is given twice");
    if (!set.entries.empty() && set.entries.front().view.parent != view.parent) {
      return bad("views", "\"" + view.name + "\" is placed in \"" + view.parent + "\" but \"" +
                              set.entries.front().view.name + "\" in \"" + set.entries.front().view.parent +
                              "\"; all views share one parent");
    }
    set.entries.push_back(std::move(*entry));
  }
  return set;
}

}  // namespace

const View* ViewSet::find(const std::string& name) const {
  for (const auto& entry : entries) {
    if (entry.view.name == name) return &entry.view;
  }
  return nullptr;
}

Result<ViewSet> readViewsFile(const std::string& path) {
  const auto text = readTextFile(path, kMaxFileBytes);
  if (!text) return text.error();
  try {
    const auto content = jsonFromYaml(*text);
    auto views = content ? readViews(*content, fs::path(path).parent_path()) : Result<ViewSet>(content.error());
    if (!views) return printable(Error{views.error().code, "views file " + path + ": " + views.error().message});
    return views;
  } catch (const std::exception& exception) {   // std::filesystem
    return Error{ErrorCode::kInvalidInput, "views file " + path + ": " + exception.what()};
  }
}

}  // namespace longarm::vision
