#include "planning/world/scenario.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "core/printable.h"
#include "core/resource_path.h"
#include "core/text.h"
#include "planning/world/json_reader.h"
#include "planning/world/mesh_file.h"
#include "planning/world/workcell.h"
#include "vision/camera/bounded_yaml.h"

namespace longarm::planning {
namespace {

namespace fs = std::filesystem;
using internal::FieldReader;
using nlohmann::json;

constexpr double kMaxSize = 100;       // [m]
constexpr std::size_t kMaxObjects = 256;

std::string at(const std::string& place, const char* key, std::size_t index) {
  return place + ": " + key + "[" + std::to_string(index) + "]";
}

std::shared_ptr<const TriangleMesh> readMesh(FieldReader& reader, const std::string& folder) {
  const std::string file = reader.requiredText("file");
  const double scale = reader.number("scale", 1, 1e-6, 1e6);
  if (!reader.status()) return nullptr;
  const fs::path relative(file);
  const bool climbs = std::any_of(relative.begin(), relative.end(), [](const fs::path& p) { return p == ".."; });
  if (relative.is_absolute() || climbs) {
    reader.fail("file is \"" + file + "\"; expected a file beside or below the scenario");
    return nullptr;
  }
  const auto mesh = loadMesh((fs::path(folder) / relative).string(), Eigen::Vector3d::Constant(scale));
  if (!mesh) reader.fail("file: " + mesh.error().message);
  return mesh ? *mesh : nullptr;
}

Shape readCylinder(const json& map, FieldReader& shape) {
  FieldReader reader(map, shape.place() + ".cylinder");
  const Cylinder cylinder{reader.number("radius", 0, 1e-4, kMaxSize), reader.number("length", 0, 1e-4, kMaxSize)};
  if (cylinder.radius <= 0 || cylinder.length <= 0) reader.fail("needs radius and length");
  reader.refuseUnknownKeys();
  shape.adopt(reader.status());
  return cylinder;
}

Shape readShape(const json& map, FieldReader& object, const std::string& folder) {
  FieldReader reader(map, object.place() + ".shape");
  Shape shape = Box{};
  if (map.size() != 1) reader.fail("holds " + std::to_string(map.size()) + " kinds; expected one of box, cylinder, sphere, mesh");
  if (reader.has("box")) {
    const std::vector<double> size = reader.numbers("box", 3, 1e-4, kMaxSize);
    if (size.size() == 3) shape = Box{{size[0], size[1], size[2]}};
  } else if (const json* cylinder = reader.map("cylinder")) {
    shape = readCylinder(*cylinder, reader);
  } else if (const json* sphere = reader.map("sphere")) {
    FieldReader inner(*sphere, reader.place() + ".sphere");
    const double radius = inner.number("radius", 0, 1e-4, kMaxSize);
    if (radius <= 0) inner.fail("needs a radius");
    inner.refuseUnknownKeys();
    reader.adopt(inner.status());
    shape = Sphere{radius};
  } else if (const json* mesh = reader.map("mesh")) {
    FieldReader inner(*mesh, reader.place() + ".mesh");
    shape = readMesh(inner, folder);
    inner.refuseUnknownKeys();
    reader.adopt(inner.status());
  }
  reader.refuseUnknownKeys();
  object.adopt(reader.status());
  return shape;
}

void readRoute(FieldReader& reader, ScenarioObject& object) {
  const json& list = reader.list("route", 200);
  for (std::size_t i = 0; i < list.size() && reader.status(); ++i) {
    FieldReader stop(list[i], at(reader.place(), "route", i));
    object.route.push_back({stop.pose("pose"), stop.number("rest_s", 2, 0, 3600)});
    stop.refuseUnknownKeys();
    reader.adopt(stop.status());
  }
  object.travel_s = reader.number("travel_s", object.travel_s, 0.1, 3600);
  object.before = reader.text("before", "");
  if (!object.route.empty()) object.body.X_WO = object.route.front().X_WO;
}

ScenarioObject readObject(const json& map, const std::string& place, const std::string& folder, Status& status) {
  FieldReader reader(map, place);
  ScenarioObject object;
  object.body.name = reader.requiredText("name");
  if (const json* shape = reader.map("shape")) object.body.shape = readShape(*shape, reader, folder);
  if (!reader.has("shape")) reader.fail("key \"shape\" is missing");
  object.body.X_WO = reader.pose("pose");
  readRoute(reader, object);
  const std::vector<double> rgba = reader.numbers("rgba", 4, 0, 1);
  if (!rgba.empty()) object.body.rgba = Eigen::Vector4d(rgba.data());
  object.body.collides = reader.boolean("collides", true);
  object.surface = reader.text("surface", "");
  object.graspable = reader.boolean("graspable", false);
  object.slides = reader.boolean("slides", false);
  if (object.slides && !std::holds_alternative<Box>(object.body.shape) && !std::holds_alternative<Cylinder>(object.body.shape)) {
    reader.fail("slides is true; only boxes and cylinders slide");
  }
  reader.refuseUnknownKeys();
  status = reader.status();
  return object;
}

void readObjects(FieldReader& file, const std::string& folder, Scenario& scenario) {
  std::set<std::string> names;
  const json& list = file.list("objects", kMaxObjects);
  for (std::size_t i = 0; i < list.size() && file.status(); ++i) {
    Status status;
    ScenarioObject object = readObject(list[i], at(file.place(), "objects", i), folder, status);
    file.adopt(status);
    if (!names.insert(object.body.name).second) file.fail("two objects are called \"" + object.body.name + "\"");
    scenario.objects.push_back(std::move(object));
  }
}

void readImperfections(FieldReader& file, Imperfections& result) {
  const json* map = file.map("imperfections");
  if (map == nullptr) return;
  FieldReader reader(*map, file.place() + ": imperfections");
  result.joint_offset_deg = reader.number("joint_offset_deg", result.joint_offset_deg, 0, 5);
  result.backlash_deg = reader.number("backlash_deg", result.backlash_deg, 0, 5);
  result.encoder_noise_deg = reader.number("encoder_noise_deg", result.encoder_noise_deg, 0, 1);
  result.latency_s = reader.number("latency_s", result.latency_s, 0, 1);
  result.image_noise = reader.number("image_noise", result.image_noise, 0, 50);
  result.odometry_share = reader.number("odometry_share", result.odometry_share, 0, 0.2);
  reader.refuseUnknownKeys();
  file.adopt(reader.status());
}

// The robot's frame is the world's: on a slope it is gravity that leans.
void readSlope(FieldReader& file, Scenario& scenario) {
  const std::vector<double> slope = file.numbers("slope_deg", 2, -40, 40);
  if (slope.empty()) return;
  scenario.up = Eigen::AngleAxisd(-slope[0] * M_PI / 180, Eigen::Vector3d::UnitX()) *
                (Eigen::AngleAxisd(-slope[1] * M_PI / 180, Eigen::Vector3d::UnitY()) * Eigen::Vector3d::UnitZ());
}

void readLight(FieldReader& file, ScenarioLight& light) {
  const json* map = file.map("light");
  if (map == nullptr) return;
  FieldReader reader(*map, file.place() + ": light");
  light.direction = reader.vector("direction", light.direction, 1000);
  light.intensity = reader.number("intensity", light.intensity, 0, 2);
  light.ambient = reader.number("ambient", light.ambient, 0, 2);
  if (light.direction.norm() < 1e-6) reader.fail("direction is zero; expected the way the light travels");
  reader.refuseUnknownKeys();
  file.adopt(reader.status());
}

void readFaults(FieldReader& file, Scenario& scenario) {
  const json& list = file.list("faults", 32);
  for (std::size_t i = 0; i < list.size() && file.status(); ++i) {
    FieldReader reader(list[i], at(file.place(), "faults", i));
    ScenarioFault fault;
    fault.name = reader.requiredText("name");
    if (reader.has("at_s")) fault.at_s = reader.number("at_s", 0, 0, 86400);
    fault.duration_s = reader.number("duration_s", 0, 0, 86400);
    fault.target = reader.text("target", "");
    reader.refuseUnknownKeys();
    file.adopt(reader.status());
    scenario.faults.push_back(std::move(fault));
  }
}

ScenarioMechanism readMechanism(FieldReader& reader, const Scenario& scenario) {
  ScenarioMechanism result;
  result.name = reader.requiredText("name");
  const std::string kind = reader.requiredText("kind");
  if (kind != "hinge" && kind != "slide") reader.fail("kind is \"" + kind + "\"; expected hinge or slide");
  const bool hinge = kind == "hinge";
  result.kind = hinge ? ScenarioMechanism::Kind::kHinge : ScenarioMechanism::Kind::kSlide;
  result.moves = reader.texts("moves");
  if (result.moves.empty()) reader.fail("moves names no object");
  for (const std::string& name : result.moves) {
    if (scenario.object(name) == nullptr) reader.fail("moves: no object is called \"" + name + "\"");
  }
  result.origin = reader.vector("origin", result.origin, kMaxSize);
  const Eigen::Vector3d axis = reader.vector("axis", result.axis, 1000);
  if (axis.norm() < 1e-6) reader.fail("axis is zero; expected a direction");
  else result.axis = axis.normalized();
  const char* key = hinge ? "range_deg" : "range_m";
  const std::vector<double> range = reader.numbers(key, 2, hinge ? -3600 : -10, hinge ? 3600 : 10);
  if (range.empty()) reader.fail(std::string("key \"") + key + "\" is missing; expected [least, most] from where it starts");
  if (!range.empty() && !(range[0] <= 0 && range[1] >= 0)) reader.fail(std::string(key) + " does not hold 0, where it starts");
  if (!range.empty()) {
    result.lower = range[0] * (hinge ? M_PI / 180 : 1);
    result.upper = range[1] * (hinge ? M_PI / 180 : 1);
  }
  result.gives = reader.number("gives", result.gives, 1e-4, 1);
  reader.refuseUnknownKeys();
  return result;
}

void readMechanisms(FieldReader& file, Scenario& scenario) {
  const json& list = file.list("mechanisms", 32);
  std::set<std::string> moved;
  for (std::size_t i = 0; i < list.size() && file.status(); ++i) {
    FieldReader reader(list[i], at(file.place(), "mechanisms", i));
    ScenarioMechanism mechanism = readMechanism(reader, scenario);
    for (const std::string& name : mechanism.moves) {
      if (!moved.insert(name).second) reader.fail("moves: \"" + name + "\" is moved already");
    }
    if (scenario.mechanism(mechanism.name) != nullptr) reader.fail("two mechanisms are called \"" + mechanism.name + "\"");
    file.adopt(reader.status());
    scenario.mechanisms.push_back(std::move(mechanism));
  }
}

/// How far a goal wants something moved, in the unit of its kind.
double goalAmount(FieldReader& reader, const ScenarioGoal& goal, const Scenario& scenario) {
  if (goal.kind == "move") return reader.number("way", 0, 0, kMaxSize);
  if (goal.kind != "open") return reader.number("height", 0, 0, kMaxSize);
  const ScenarioMechanism* mechanism = scenario.mechanism(goal.object);
  if (mechanism == nullptr) {
    reader.fail("open: no mechanism is called \"" + goal.object + "\"");
    return 0;
  }
  const bool hinge = mechanism->kind == ScenarioMechanism::Kind::kHinge;
  return hinge ? reader.number("angle_deg", 0, 0, 3600) * M_PI / 180 : reader.number("way", 0, 0, kMaxSize);
}

/// `- {lift: pipe, height: 0.1}`: the kind is the key.
void readGoals(FieldReader& file, Scenario& scenario) {
  const json& list = file.list("goals", 32);
  for (std::size_t i = 0; i < list.size() && file.status(); ++i) {
    FieldReader reader(list[i], at(file.place(), "goals", i));
    ScenarioGoal goal;
    for (const char* kind : {"grasp", "lift", "touch", "open", "move", "no_contact"}) {
      if (!reader.has(kind)) continue;
      if (!goal.kind.empty()) reader.fail("holds both " + goal.kind + " and " + kind + "; expected one goal an entry");
      goal.kind = kind;
      goal.object = reader.text(kind, "");
    }
    goal.amount = goalAmount(reader, goal, scenario);
    if (goal.kind.empty()) reader.fail("names no goal; expected one of grasp, lift, touch, open, move, no_contact");
    const bool of_object = goal.kind == "grasp" || goal.kind == "lift" || goal.kind == "move";
    if (of_object && scenario.object(goal.object) == nullptr) reader.fail(goal.kind + ": no object is called \"" + goal.object + "\"");
    reader.refuseUnknownKeys();
    file.adopt(reader.status());
    scenario.goals.push_back(std::move(goal));
  }
}

/// Clicks of a step: places in halves of the object's size.
void readPlaces(FieldReader& reader, const json& list, ScenarioStep& step) {
  for (const json& place : list) {
    const bool three = place.is_array() && place.size() == 3 && place[0].is_number() && place[1].is_number() && place[2].is_number();
    if (!three) return reader.fail("at holds something else than [x, y, z]");
    const Eigen::Vector3d p(place[0].get<double>(), place[1].get<double>(), place[2].get<double>());
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 2) return reader.fail("at holds numbers outside -2 to 2 halves of the object's size");
    step.at.push_back(p);
  }
}

void readNumbers(FieldReader& reader, const char* key, std::map<std::string, double>* out) {
  const json* map = reader.map(key);
  if (map == nullptr) return;
  for (const auto& [name, value] : map->items()) {
    if (!value.is_number() || !std::isfinite(value.get<double>())) return reader.fail(std::string(key) + "." + name + " is no finite number");
    (*out)[name] = value.get<double>();
  }
}

/// `- {mark: handle, macro: approach_from_side, gripper: close}`
void readTask(FieldReader& file, Scenario& scenario) {
  const json& list = file.list("task", 32);
  for (std::size_t i = 0; i < list.size() && file.status(); ++i) {
    FieldReader reader(list[i], at(file.place(), "task", i));
    ScenarioStep step;
    step.macro = reader.requiredText("macro");
    const std::string mark = reader.requiredText("mark");
    if (scenario.object(mark) != nullptr) step.object = mark;
    else if (scenario.mechanism(mark) != nullptr) step.mechanism = mark;
    else reader.fail("mark: neither an object nor a mechanism is called \"" + mark + "\"");
    readPlaces(reader, reader.list("at", 4), step);
    if (!step.mechanism.empty() && !step.at.empty()) reader.fail("at: of a mechanism its axis is marked");
    if (step.at.empty() && !step.object.empty() && !std::holds_alternative<Cylinder>(scenario.object(step.object)->body.shape)) {
      reader.fail("at is missing: where on \"" + step.object + "\" to click, in halves of its size");
    }
    readNumbers(reader, "arguments", &step.arguments);
    const std::string gripper = reader.text("gripper", "");
    if (!gripper.empty() && gripper != "close") reader.fail("gripper is \"" + gripper + "\"; expected close");
    step.close_gripper = !gripper.empty();
    reader.refuseUnknownKeys();
    file.adopt(reader.status());
    scenario.task.push_back(std::move(step));
  }
}

void readRange(FieldReader& reader, const char* key, double lower, double upper, double& min, double& max) {
  const std::vector<double> range = reader.numbers(key, 2, lower, upper);
  if (range.empty()) return;
  if (range[0] > range[1]) reader.fail(std::string(key) + " begins above its end");
  min = range[0];
  max = range[1];
}

/// Only names of objects of the shape the drawing resizes.
template <typename Kind>
void requireObject(FieldReader& reader, const Scenario& scenario, const std::string& name, const char* kind) {
  const ScenarioObject* object = scenario.object(name);
  if (object == nullptr || !std::holds_alternative<Kind>(object->body.shape)) {
    reader.fail("\"" + name + "\" is no object whose shape is a " + kind);
  }
}

void readRandomPipe(FieldReader& file, Scenario& scenario) {
  const json* map = file.map("random_pipe");
  if (map == nullptr) return;
  FieldReader reader(*map, file.place() + ": random_pipe");
  RandomPipe pipe;
  pipe.object = reader.requiredText("object");
  pipe.table = reader.requiredText("table");
  pipe.stands = reader.texts("stands");
  pipe.legs = reader.texts("legs");
  readRange(reader, "distance", 0.05, 10, pipe.min_distance, pipe.max_distance);
  readRange(reader, "height", 0.02, 10, pipe.min_height, pipe.max_height);
  readRange(reader, "length", 0.02, 10, pipe.min_length, pipe.max_length);
  pipe.max_bearing = reader.number("max_bearing", pipe.max_bearing, 0, M_PI);
  pipe.max_slope = reader.number("max_slope", pipe.max_slope, 0, 0.5);
  pipe.max_turn = reader.number("max_turn", pipe.max_turn, 0, M_PI / 2);
  const std::vector<double> clear = reader.numbers("keep_clear", 4, -10, 10);
  if (!clear.empty()) pipe.keep_clear = Eigen::Vector4d(clear.data());
  requireObject<Cylinder>(reader, scenario, pipe.object, "cylinder");
  requireObject<Box>(reader, scenario, pipe.table, "box");
  for (const std::string& name : pipe.stands) requireObject<Box>(reader, scenario, name, "box");
  for (const std::string& name : pipe.legs) requireObject<Cylinder>(reader, scenario, name, "cylinder");
  if (pipe.legs.size() > 4) reader.fail("legs names " + std::to_string(pipe.legs.size()) + " objects; expected at most 4");
  reader.refuseUnknownKeys();
  file.adopt(reader.status());
  scenario.random_pipe = std::move(pipe);
}

std::string builtInFolder() { return resourcePath("scenarios").valueOr(std::string()); }

std::string namesOfBuiltIns() {
  std::string names;
  for (const ScenarioInfo& info : listScenarios()) names += (names.empty() ? "" : ", ") + info.name;
  return names.empty() ? "none" : names;
}

Result<Scenario> loadFile(const std::string& path) {
  const Result<std::string> text = readTextFile(path, 1u << 20);
  if (!text) return text.error();
  return printable(parseScenario(*text, path));
}

}  // namespace

Imperfections Imperfections::none() { return {0, 0, 0, 0, 0, 0}; }

Pose ScenarioObject::onRoute(double time_s) const {
  double whole = 0;
  for (const auto& stop : route) whole += stop.rest_s + travel_s;
  double left = std::fmod(time_s, whole);
  for (std::size_t i = 0; i < route.size(); ++i) {
    if (left <= route[i].rest_s) return route[i].X_WO;
    left -= route[i].rest_s;
    const double part = left / travel_s;
    // Starts and ends gently, as a hand does.
    if (part <= 1) return interpolate(route[i].X_WO, route[(i + 1) % route.size()].X_WO, part * part * (3 - 2 * part));
    left -= travel_s;
  }
  return route.front().X_WO;
}

Result<Workcell> workcellOf(const Scenario& scenario) {
  if (scenario.robot != Scenario().robot) return loadWorkcell(scenario.robot);
  return loadBuiltInWorkcell(scenario.variant);
}

const ScenarioObject* Scenario::object(const std::string& wanted) const {
  for (const ScenarioObject& candidate : objects) {
    if (candidate.body.name == wanted) return &candidate;
  }
  return nullptr;
}

const ScenarioMechanism* Scenario::mechanism(const std::string& wanted) const {
  for (const ScenarioMechanism& candidate : mechanisms) {
    if (candidate.name == wanted) return &candidate;
  }
  return nullptr;
}

Result<Scenario> parseScenario(const std::string& text, const std::string& path) {
  Result<json> content = vision::jsonFromYaml(text);
  if (!content) return Error{content.error().code, path + ": " + content.error().message};
  FieldReader file(*content, path);
  Scenario scenario;
  scenario.path = path;
  file.number("format", 0, 1, 1);
  if (!file.has("format")) file.fail("key \"format\" is missing; expected 1");
  scenario.name = file.requiredText("name");
  scenario.title = file.text("title", scenario.name);
  scenario.description = file.text("description", "");
  scenario.robot = file.text("robot", scenario.robot);
  scenario.variant = file.text("variant", "");
  scenario.start_pose = file.text("start_pose", scenario.start_pose);
  readSlope(file, scenario);
  readNumbers(file, "start_joints", &scenario.start_joints);
  scenario.ground = file.text("ground", scenario.ground);
  readObjects(file, fs::path(path).parent_path().string(), scenario);
  readMechanisms(file, scenario);
  readLight(file, scenario.light);
  readImperfections(file, scenario.imperfections);
  readFaults(file, scenario);
  readGoals(file, scenario);
  readTask(file, scenario);
  readRandomPipe(file, scenario);
  file.refuseUnknownKeys();
  if (!file.status()) return file.status().error();
  return scenario;
}

std::vector<ScenarioInfo> listScenarios() {
  std::vector<ScenarioInfo> found;
  const std::string folder = builtInFolder();
  std::error_code ec;
  for (fs::directory_iterator entry(folder, ec), end; !ec && entry != end; entry.increment(ec)) {
    if (entry->path().extension() != ".yaml") continue;
    const Result<Scenario> scenario = loadFile(entry->path().string());
    if (scenario) found.push_back({scenario->name, scenario->title, scenario->description, scenario->path});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return found;
}

Result<Scenario> loadScenario(const std::string& path_or_name) {
  const bool is_path = path_or_name.find('/') != std::string::npos || fs::path(path_or_name).extension() == ".yaml" ||
                       fs::path(path_or_name).extension() == ".yml";
  if (is_path) return loadFile(path_or_name);
  const fs::path file = fs::path(builtInFolder()) / (path_or_name + ".yaml");
  std::error_code ec;
  if (path_or_name.empty() || !fs::is_regular_file(file, ec)) {
    return Error{ErrorCode::kNotFound, "No built-in scenario is called \"" + path_or_name + "\"; there are: " +
                                           namesOfBuiltIns() + ". A file needs its .yaml ending."};
  }
  return loadFile(file.string());
}

}  // namespace longarm::planning
