#include "session/document/document_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "session/document/template_json.h"
#include "vision/camera/camera_file.h"
#include "vision/snapshot/image_file.h"

namespace longarm::session {

namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kFormat = 1;
constexpr std::size_t kMaxBytes = 64u << 20;
constexpr std::size_t kMaxSnapshots = 500, kMaxItems = 10000, kMaxName = 500;
constexpr int kMaxDepth = 32;

// ---- writing ---------------------------------------------------------------------------------------------------

std::uint64_t pictureHash(const cv::Mat& image) {
  std::uint64_t hash = 1469598103934665603ULL ^ static_cast<std::uint64_t>(image.type());
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int row = 0; row < image.rows; ++row) {
    const unsigned char* data = image.ptr(row);
    for (std::size_t i = 0; i < row_bytes; i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, data + i, std::min<std::size_t>(8, row_bytes - i));
      hash = (hash ^ word) * 1099511628211ULL;
      hash ^= hash >> 31;
    }
  }
  return hash;
}

/// The content is part of the name: ids begin anew in every session, a picture kept from the last one must not pass
/// for a new one.
std::string pictureName(const vision::Snapshot& snapshot) {
  static const char* digits = "0123456789abcdef";
  std::uint64_t hash = pictureHash(snapshot.image);
  std::string name = "snapshot_" + std::to_string(snapshot.id.value) + "_";
  for (int i = 0; i < 16; ++i, hash >>= 4) name += digits[hash & 15];
  return name + ".png";
}

json numbers(const double* data, Eigen::Index n) {
  json list = json::array();
  for (Eigen::Index i = 0; i < n; ++i) list.push_back(data[i]);
  return list;
}

json poseJson(const std::string& parent, const Pose& pose) {
  const Eigen::Vector3d xyz = pose.translation();
  const Eigen::Vector4d quaternion = quaternionXyzw(pose.linear());
  return {{"parent", parent}, {"xyz", numbers(xyz.data(), 3)}, {"quaternion_xyzw", numbers(quaternion.data(), 4)}};
}

// Where the base was; how fast it went is of no use later.
json baseJson(const BaseState& base) { return {{"x", base.x}, {"y", base.y}, {"yaw", base.yaw}}; }

json snapshotJson(const vision::Snapshot& snapshot, const std::string& picture) {
  vision::CameraFile file;
  file.camera = snapshot.view.camera;
  json out = {{"id", snapshot.id.value}, {"name", snapshot.view.name}, {"image", picture},
              {"camera", vision::toJson(file)}, {"pose", poseJson(snapshot.view.parent, snapshot.view.X_WC)},
              {"sigma_px", snapshot.view.sigma_px}, {"stamp_s", snapshot.stamp_s},
              {"wall_time_s", snapshot.wall_time_s}, {"source", snapshot.source}};
  if (snapshot.view.zoom) out["zoom"] = *snapshot.view.zoom;
  if (!snapshot.view.intrinsics_covariance.isZero(0)) {
    out["intrinsics_covariance"] = numbers(snapshot.view.intrinsics_covariance.data(), 100);
  }
  if (!snapshot.view.pose_covariance.isZero(0)) {
    out["pose_covariance"] = numbers(snapshot.view.pose_covariance.data(), 36);
  }
  if (snapshot.base) out["base"] = baseJson(*snapshot.base);
  if (!snapshot.robot_state.names.empty()) {
    const JointState& state = snapshot.robot_state;
    out["joints"] = {{"stamp_s", state.stamp_s}, {"names", state.names},
                     {"positions", numbers(state.positions.data(), state.positions.size())},
                     {"velocities", numbers(state.velocities.data(), state.velocities.size())}};
  }
  return out;
}

const char* stateWord(PickState state) {
  switch (state) {
    case PickState::kUnplaced: return "unplaced";
    case PickState::kFree: return "free";
    case PickState::kConstrained: return "constrained";
    case PickState::kReleased: return "released";
    case PickState::kMatched: return "matched";
  }
  return "unplaced";
}

json itemJson(const SketchItem& item) {
  json picks = json::array();
  for (const auto& [id, list] : item.picks) {
    for (std::size_t vertex = 0; vertex < list.size(); ++vertex) {
      if (!list[vertex]) continue;
      picks.push_back({{"snapshot", id.value}, {"vertex", vertex}, {"pixel", numbers(list[vertex]->pixel.data(), 2)},
                       {"state", stateWord(list[vertex]->state)}});
      if (list[vertex]->sigma_px > 0) picks.back()["sigma_px"] = list[vertex]->sigma_px;
    }
  }
  json out = {{"id", item.id.value}, {"kind", vision::toString(item.kind)}, {"name", item.name},
              {"hidden", item.hidden}, {"locked", item.locked}, {"picks", std::move(picks)}};
  if (item.colour) out["colour"] = *item.colour;
  if (item.pipe) out["pipe"] = true;
  if (item.edge) out["edge"] = true;
  if (item.group != 0) out["group"] = item.group;
  if (!item.note.empty()) out["note"] = item.note;
  return out;
}

json worldJson(const WorldItem& item) {
  json out = {{"id", item.id.value}, {"kind", toString(item.kind)}, {"name", item.name}, {"pose", poseJson(item.parent, item.X_WO)},
              {"size", numbers(item.size.data(), 3)},
              {"margin_m", item.margin_m}, {"hidden", item.hidden}, {"role", toString(item.role)}, {"source", item.source.value}};
  if (item.base) out["base"] = baseJson(*item.base);
  for (const auto& point : item.points) out["points"].push_back(numbers(point.data(), 3));
  if (item.kind == WorldKind::kTemplate) out.update(templateJson(item));
  return out;
}

void removeUnused(const fs::path& folder, const std::set<std::string>& used) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const bool ours = name.rfind("snapshot_", 0) == 0 && entry->path().extension() == ".png";
    std::error_code ignored;
    if (ours && used.count(name) == 0) fs::remove(entry->path(), ignored);
  }
}

// ---- reading ---------------------------------------------------------------------------------------------------

/// Thrown inside this file only; loadSketch turns it into an Error.
struct Fault {
  std::string where, what;
};

[[noreturn]] void fault(const std::string& where, const std::string& what) { throw Fault{where, what}; }

const json& need(const json& object, const char* key, const std::string& where) {
  if (!object.is_object()) fault(where, "is " + std::string(object.type_name()) + ", expected an object");
  const auto found = object.find(key);
  if (found == object.end()) fault(where, std::string("has no \"") + key + "\"");
  return *found;
}

double number(const json& value, const std::string& where) {
  if (!value.is_number()) fault(where, "is " + std::string(value.type_name()) + ", expected a number");
  const double x = value.get<double>();
  if (!(std::abs(x) < 1e12)) fault(where, "is " + formatNumber(x) + ", beyond 1e12");
  return x;
}

std::uint64_t idNumber(const json& value, const std::string& where, bool may_be_zero) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > (1ULL << 53) ||
      (!may_be_zero && value.get<std::uint64_t>() == 0)) {
    fault(where, "is " + value.dump().substr(0, 40) + ", expected an id from 1 to 2^53");
  }
  return value.get<std::uint64_t>();
}

std::string text(const json& value, const std::string& where) {
  if (!value.is_string()) fault(where, "is " + std::string(value.type_name()) + ", expected text");
  std::string word = value.get<std::string>();
  if (word.size() > kMaxName) fault(where, "has " + std::to_string(word.size()) + " letters, at most 500 are taken");
  return word;
}

bool flag(const json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) return false;
  if (!found->is_boolean()) fault(where + "." + key, "is not true or false");
  return found->get<bool>();
}

template <typename Vector>
Vector vectorOf(const json& value, Eigen::Index n, const std::string& where) {
  if (!value.is_array() || static_cast<Eigen::Index>(value.size()) != n) {
    fault(where, "must be a list of " + std::to_string(n) + " numbers");
  }
  Vector out(n);
  for (Eigen::Index i = 0; i < n; ++i) out(i) = number(value[static_cast<std::size_t>(i)], where);
  return out;
}

void readPose(const json& value, const std::string& where, vision::View& view) {
  view.parent = text(need(value, "parent", where), where + ".parent");
  const auto xyz = vectorOf<Eigen::VectorXd>(need(value, "xyz", where), 3, where + ".xyz");
  const auto q = vectorOf<Eigen::VectorXd>(need(value, "quaternion_xyzw", where), 4, where + ".quaternion_xyzw");
  if (std::abs(q.norm() - 1) > 1e-3) fault(where + ".quaternion_xyzw", "has length " + formatNumber(q.norm()) + ", expected 1");
  view.X_WC = poseFrom(xyz, q);
}

JointState readJoints(const json& value, const std::string& where) {
  JointState state;
  state.stamp_s = number(need(value, "stamp_s", where), where + ".stamp_s");
  const json& names = need(value, "names", where);
  if (!names.is_array() || names.size() > 1000) fault(where + ".names", "must be a list of at most 1000 names");
  for (const auto& name : names) state.names.push_back(text(name, where + ".names"));
  const auto n = static_cast<Eigen::Index>(state.names.size());
  state.positions = vectorOf<Eigen::VectorXd>(need(value, "positions", where), n, where + ".positions");
  const json& velocities = need(value, "velocities", where);
  if (!velocities.empty()) state.velocities = vectorOf<Eigen::VectorXd>(velocities, n, where + ".velocities");
  return state;
}

BaseState readBase(const json& value, const std::string& where) {
  BaseState base;
  base.x = number(need(value, "x", where), where + ".x");
  base.y = number(need(value, "y", where), where + ".y");
  base.yaw = number(need(value, "yaw", where), where + ".yaw");
  return base;
}

cv::Mat readPicture(const fs::path& folder, const std::string& name, const std::string& where) {
  const bool plain = !name.empty() && name.find_first_of("/\\") == std::string::npos && name[0] != '.' &&
                     name.find('\0') == std::string::npos;
  if (!plain) fault(where, "is \"" + name + "\", expected a file name inside the sketch's folder");
  auto image = vision::loadImage((folder / name).string());
  if (!image) fault(where, image.error().message);
  return std::move(*image);
}

SnapshotPtr readSnapshot(const json& value, const fs::path& folder, const std::string& where) {
  auto snapshot = std::make_shared<vision::Snapshot>();
  snapshot->id = {idNumber(need(value, "id", where), where + ".id", false)};
  vision::View& view = snapshot->view;
  const auto camera = vision::cameraFromJson(need(value, "camera", where));
  if (!camera) fault(where + ".camera", camera.error().message);
  view.camera = camera->camera;
  view.name = text(need(value, "name", where), where + ".name");
  readPose(need(value, "pose", where), where + ".pose", view);
  view.sigma_px = number(need(value, "sigma_px", where), where + ".sigma_px");
  if (!(view.sigma_px > 0)) fault(where + ".sigma_px", "is " + formatNumber(view.sigma_px) + ", expected > 0");
  if (value.contains("zoom")) view.zoom = number(value["zoom"], where + ".zoom");
  if (value.contains("intrinsics_covariance")) {
    const auto list = vectorOf<Eigen::VectorXd>(value["intrinsics_covariance"], 100, where + ".intrinsics_covariance");
    view.intrinsics_covariance = Eigen::Map<const Eigen::Matrix<double, 10, 10>>(list.data());
  }
  if (value.contains("pose_covariance")) {
    const auto list = vectorOf<Eigen::VectorXd>(value["pose_covariance"], 36, where + ".pose_covariance");
    view.pose_covariance = Eigen::Map<const Matrix6d>(list.data());
  }
  snapshot->stamp_s = number(need(value, "stamp_s", where), where + ".stamp_s");
  snapshot->wall_time_s = number(need(value, "wall_time_s", where), where + ".wall_time_s");
  snapshot->source = need(value, "source", where).is_string() ? value["source"].get<std::string>() : "";
  if (value.contains("base")) snapshot->base = readBase(value["base"], where + ".base");
  if (value.contains("joints")) snapshot->robot_state = readJoints(value["joints"], where + ".joints");
  snapshot->image = readPicture(folder, text(need(value, "image", where), where + ".image"), where + ".image");
  const bool sized = view.camera.width > 0 && view.camera.height > 0;
  if (sized && (snapshot->image.cols != view.camera.width || snapshot->image.rows != view.camera.height)) {
    fault(where + ".image", "is " + std::to_string(snapshot->image.cols) + " x " + std::to_string(snapshot->image.rows) +
                                " px, its camera says " + std::to_string(view.camera.width) + " x " +
                                std::to_string(view.camera.height));
  }
  return snapshot;
}

PickState stateFrom(const std::string& word, const std::string& where) {
  for (const PickState state : {PickState::kUnplaced, PickState::kFree, PickState::kConstrained, PickState::kReleased,
                                PickState::kMatched}) {
    if (word == stateWord(state)) return state;
  }
  fault(where, "is \"" + word + "\", expected unplaced, free, constrained, released or matched");
}

double readPickSigma(const json& pick, const std::string& where) {
  const auto found = pick.find("sigma_px");
  if (found == pick.end()) return 0;
  const double sigma = number(*found, where + ".sigma_px");
  if (!(sigma > 0)) fault(where + ".sigma_px", "is " + formatNumber(sigma) + ", expected > 0");
  return sigma;
}

SketchItem readItem(const json& value, const std::set<std::uint64_t>& snapshots, const std::string& where) {
  SketchItem item;
  item.id = {idNumber(need(value, "id", where), where + ".id", false)};
  const std::string kind = text(need(value, "kind", where), where + ".kind");
  const auto found = vision::featureKindFrom(kind);
  if (!found) fault(where + ".kind", "is \"" + kind + "\", expected point, line, plane or triad");
  item.kind = *found;
  item.name = text(need(value, "name", where), where + ".name");
  item.hidden = flag(value, "hidden", where);
  item.locked = flag(value, "locked", where);
  item.pipe = flag(value, "pipe", where);
  if (item.pipe && item.kind != vision::FeatureKind::kLine) fault(where + ".pipe", "is true of a " + kind + ", only lines have it");
  item.edge = flag(value, "edge", where);
  if (item.edge && (item.pipe || item.kind != vision::FeatureKind::kLine)) fault(where + ".edge", "is true of a " + std::string(item.pipe ? "pipe" : kind) + ", only lines have it");
  if (value.contains("group")) item.group = idNumber(value["group"], where + ".group", true);
  if (value.contains("note")) item.note = text(value["note"], where + ".note");
  if (value.contains("colour")) {
    item.colour = static_cast<std::uint32_t>(idNumber(value["colour"], where + ".colour", true) & 0xffffffU);
  }
  const json& picks = need(value, "picks", where);
  if (!picks.is_array() || picks.size() > 4 * kMaxSnapshots) fault(where + ".picks", "is not a list, or too long");
  for (const auto& entry : picks) {
    const std::string here = where + ".picks";
    const std::uint64_t id = idNumber(need(entry, "snapshot", here), here + ".snapshot", false);
    if (snapshots.count(id) == 0) fault(here + ".snapshot", "is " + std::to_string(id) + ", which the file does not hold");
    const std::uint64_t vertex = idNumber(need(entry, "vertex", here), here + ".vertex", true);
    if (vertex >= static_cast<std::uint64_t>(item.vertices())) {
      fault(here + ".vertex", "is " + std::to_string(vertex) + ", a " + kind + " has " +
                                  std::to_string(item.vertices()));
    }
    const auto pixel = vectorOf<Eigen::VectorXd>(need(entry, "pixel", here), 2, here + ".pixel");
    item.setPick({id}, static_cast<int>(vertex),
                 {pixel, stateFrom(text(need(entry, "state", here), here + ".state"), here + ".state"), readPickSigma(entry, here)});
  }
  return item;
}

const json& listIn(const json& root, const char* key, std::size_t limit) {
  const json& list = need(root, key, "the file");
  if (!list.is_array()) fault(key, "is not a list");
  if (list.size() > limit) fault(key, "has " + std::to_string(list.size()) + " entries, at most " + std::to_string(limit));
  return list;
}

void readWorldPose(const json& value, const std::string& where, WorldItem& item) {
  vision::View frame;
  readPose(value, where, frame);
  item.parent = frame.parent;
  item.X_WO = frame.X_WC;
}

WorldItem readWorldItem(const json& value, const std::string& where) {
  WorldItem item;
  item.id = {idNumber(need(value, "id", where), where + ".id", false)};
  const std::string kind = text(need(value, "kind", where), where + ".kind");
  const auto found = worldKindFrom(kind);
  if (!found) fault(where + ".kind", "is \"" + kind + "\", expected box, slab, pipe, points or template");
  item.kind = *found;
  item.name = text(need(value, "name", where), where + ".name");
  readWorldPose(need(value, "pose", where), where + ".pose", item);
  item.size = vectorOf<Eigen::VectorXd>(need(value, "size", where), 3, where + ".size");
  item.margin_m = number(need(value, "margin_m", where), where + ".margin_m");
  item.hidden = flag(value, "hidden", where);
  const std::string role = text(need(value, "role", where), where + ".role");
  const auto known = worldRoleFrom(role);
  if (!known) fault(where + ".role", "is \"" + role + "\", expected obstacle, drawn, keep_out or workspace");
  item.role = *known;
  item.source = {idNumber(need(value, "source", where), where + ".source", true)};
  if (value.contains("points")) {
    const json& points = value["points"];
    if (!points.is_array() || points.size() > kMaxItems) fault(where + ".points", "is not a list, or too long");
    for (const auto& point : points) item.points.push_back(vectorOf<Eigen::VectorXd>(point, 3, where + ".points"));
  }
  if (item.kind == WorldKind::kTemplate) {
    if (const Status read = readTemplate(value, item); !read) fault(where, read.error().message);
  }
  if (value.contains("base")) item.base = readBase(value["base"], where + ".base");
  if (const Status checked = checkWorldItem(item); !checked) fault(where, checked.error().message);
  return item;
}

void readWorld(const json& root, const std::set<std::uint64_t>& snapshots, DocumentState& state) {
  std::set<std::uint64_t> ids;
  if (root.contains("world")) {
    const json& world = listIn(root, "world", kMaxItems);
    for (std::size_t i = 0; i < world.size(); ++i) {
      const std::string where = "world[" + std::to_string(i) + "]";
      state.world.push_back(readWorldItem(world[i], where));
      if (!ids.insert(state.world.back().id.value).second) fault(where + ".id", "is there twice");
    }
  }
  if (!root.contains("pinned")) return;
  for (const auto& entry : listIn(root, "pinned", kMaxSnapshots)) {
    const std::uint64_t id = idNumber(entry, "pinned", false);
    if (snapshots.count(id) == 0) fault("pinned", "names snapshot " + std::to_string(id) + ", which the file does not hold");
    state.pinned.insert({id});
  }
}

/// Nesting of the text, before anything is built from it.
int depthOf(const std::string& content) {
  int depth = 0, deepest = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < content.size(); ++i) {
    const char c = content[i];
    if (quoted) {
      if (c == '\\') ++i;
      else if (c == '"') quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
  return deepest;
}

DocumentState readState(const json& root, const fs::path& folder) {
  const json& format = need(root, "format", "the file");
  if (format != kFormat) fault("format", "is " + format.dump().substr(0, 40) + ", this version reads 1");
  DocumentState state;
  std::set<std::uint64_t> ids, item_ids;
  const json& snapshots = listIn(root, "snapshots", kMaxSnapshots);
  for (std::size_t i = 0; i < snapshots.size(); ++i) {
    const std::string where = "snapshots[" + std::to_string(i) + "]";
    state.snapshots.push_back(readSnapshot(snapshots[i], folder, where));
    if (!ids.insert(state.snapshots.back()->id.value).second) fault(where + ".id", "is there twice");
  }
  const json& items = listIn(root, "items", kMaxItems);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string where = "items[" + std::to_string(i) + "]";
    state.items.push_back(readItem(items[i], ids, where));
    if (!item_ids.insert(state.items.back().id.value).second) fault(where + ".id", "is there twice");
  }
  const json& panes = listIn(root, "panes", 2);
  for (std::size_t i = 0; i < panes.size(); ++i) {
    const std::uint64_t id = idNumber(panes[i], "panes", true);
    if (id != 0 && ids.count(id) == 0) fault("panes", "names snapshot " + std::to_string(id) + ", which the file does not hold");
    state.panes[i] = {id};
  }
  readWorld(root, ids, state);
  return state;
}

}  // namespace

Status saveSketch(const std::string& folder, const DocumentState& state) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return {ErrorCode::kInvalidInput, folder + ": cannot make the folder: " + error.message()};
  json root = {{"format", kFormat}, {"panes", {state.panes[0].value, state.panes[1].value}},
               {"snapshots", json::array()}, {"items", json::array()}};
  std::set<std::string> used;
  for (const auto& snapshot : state.snapshots) {
    const std::string picture = pictureName(*snapshot);
    const fs::path path = fs::path(folder) / picture;
    used.insert(picture);
    if (!fs::exists(path, error)) {
      if (const Status saved = vision::saveImage(path.string(), snapshot->image); !saved) return saved;
    }
    root["snapshots"].push_back(snapshotJson(*snapshot, picture));
  }
  for (const auto& item : state.items) root["items"].push_back(itemJson(item));
  for (const auto& item : state.world) root["world"].push_back(worldJson(item));
  for (const SnapshotId id : state.pinned) root["pinned"].push_back(id.value);
  // Replaces bytes that are no UTF-8: a name from a file must not make saving impossible.
  const std::string content = root.dump(1, ' ', false, json::error_handler_t::replace);
  if (const Status saved = writeFileAtomically((fs::path(folder) / kSketchFileName).string(), content); !saved) return saved;
  removeUnused(folder, used);
  return {};
}

Result<DocumentState> loadSketch(const std::string& path) {
  std::error_code error;
  const fs::path file = fs::is_directory(path, error) ? fs::path(path) / kSketchFileName : fs::path(path);
  auto content = readTextFile(file.string(), kMaxBytes);
  if (!content) return content.error();
  if (depthOf(*content) > kMaxDepth) {
    return {ErrorCode::kInvalidInput, file.string() + ": nested deeper than " + std::to_string(kMaxDepth) + " levels"};
  }
  try {
    return readState(json::parse(*content), file.parent_path());
  } catch (const Fault& problem) {
    return {ErrorCode::kInvalidInput, file.string() + ": " + problem.where + " " + problem.what};
  } catch (const json::exception& problem) {
    return {ErrorCode::kInvalidInput, file.string() + ": not a sketch file: " + problem.what()};
  } catch (const std::exception& problem) {
    return {ErrorCode::kInvalidInput, file.string() + ": " + problem.what()};
  }
}

}  // namespace longarm::session
