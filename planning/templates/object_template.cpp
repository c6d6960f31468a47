#include "planning/templates/object_template.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include <Eigen/Geometry>

#include "core/resource_path.h"
#include "core/text.h"
#include "planning/templates/expression.h"
#include "planning/world/yaml_section.h"

namespace longarm::planning {

using Eigen::Vector3d;
using internal::YamlFindings;
using internal::YamlSection;

namespace {

using Values = std::map<std::string, double>;
using Sums = std::vector<std::string>;

constexpr double kRad = M_PI / 180;
constexpr int kMostSegments = 48;
constexpr std::size_t kMostParts = 200;

/// As the file has them, before sizes are known.
struct BodySpec {
  enum class Kind { kBox, kCylinder, kSphere, kRing } kind = Kind::kBox;
  std::string name, where;
  Sums size, at, turn_deg;
  bool moves = false;
};

struct FeatureSpec {
  vision::FeatureKind kind = vision::FeatureKind::kPoint;
  std::string name, where;
  std::vector<Sums> points;                        // its vertices
  bool moves = false;
};

struct StepSpec {
  TemplateStep step;                               // without numbers
  std::string where;
  std::map<std::string, std::string> arguments, adds;
};

struct ActionSpec {
  TemplateAction action;
  std::vector<StepSpec> steps;
};

struct Mechanism {
  bool slides = false;
  std::string line, by;                            // a feature and a parameter; empty: nothing moves
};

/// Works out sums; the first error decides.
class Sizes {
 public:
  Sizes(const std::string& path, const Values& values) : m_path(path), m_values(values) {}

  double value(const std::string& sum, const std::string& where) {
    const auto result = evaluate(sum, m_values);
    if (!result && m_status) m_status = {ErrorCode::kInvalidInput, m_path + ": " + where + ": " + result.error().message};
    return result.valueOr(0);
  }
  double size(const std::string& sum, const std::string& where) {
    const double found = value(sum, where);
    if (m_status && !(found > 1e-5 && found < 100)) {
      m_status = {ErrorCode::kInvalidInput, m_path + ": " + where + ": \"" + sum + "\" is " + formatNumber(found) +
                                                "; expected a size between 0 and 100 m"};
    }
    return std::max(found, 1e-5);
  }
  Vector3d vector(const Sums& sums, const std::string& where) {
    if (sums.empty()) return Vector3d::Zero();
    if (sums.size() != 3 && m_status) m_status = {ErrorCode::kInvalidInput, m_path + ": " + where + ": expected three numbers"};
    if (!m_status) return Vector3d::Zero();
    return {value(sums[0], where), value(sums[1], where), value(sums[2], where)};
  }
  void refuse(const std::string& where, const std::string& what) {
    if (m_status) m_status = {ErrorCode::kInvalidInput, m_path + ": " + where + ": " + what};
  }
  const Status& status() const { return m_status; }

 private:
  const std::string& m_path;
  const Values& m_values;
  Status m_status;
};

// A ring about z of straight pieces, each a cylinder.
void addRing(const BodySpec& spec, const Pose& X_TP, Sizes& sizes, std::vector<TemplatePart>& out) {
  const double radius = sizes.size(spec.size[0], spec.where), tube = sizes.size(spec.size[1], spec.where);
  const int n = static_cast<int>(std::lround(sizes.value(spec.size[2], spec.where)));
  if (n < 3 || n > kMostSegments) return sizes.refuse(spec.where, "a ring has 3 to 48 pieces");
  for (int i = 0; i < n; ++i) {
    Pose X = Pose::Identity();
    X.linear() = Eigen::AngleAxisd(2 * M_PI * i / n, Vector3d::UnitZ()).toRotationMatrix();
    X.translation() = X.linear() * Vector3d(radius, 0, 0);
    X.linear() = X.linear() * Eigen::AngleAxisd(-M_PI / 2, Vector3d::UnitX()).toRotationMatrix();
    const Cylinder piece{tube, 2 * radius * std::tan(M_PI / n)};
    out.push_back({spec.name + "_" + std::to_string(i + 1), piece, X_TP * X, spec.moves});
  }
}

void addBody(const BodySpec& spec, Sizes& sizes, std::vector<TemplatePart>& out) {
  static const std::map<BodySpec::Kind, std::size_t> counts = {{BodySpec::Kind::kBox, 3}, {BodySpec::Kind::kCylinder, 2},
                                                               {BodySpec::Kind::kSphere, 1}, {BodySpec::Kind::kRing, 3}};
  if (spec.size.size() != counts.at(spec.kind)) {
    return sizes.refuse(spec.where, "expected " + std::to_string(counts.at(spec.kind)) + " sizes");
  }
  const Pose X_TP = poseFromRpy(sizes.vector(spec.at, spec.where), kRad * sizes.vector(spec.turn_deg, spec.where));
  if (spec.kind == BodySpec::Kind::kRing) return addRing(spec, X_TP, sizes, out);
  Vector3d size = Vector3d::Zero();
  for (std::size_t i = 0; i < spec.size.size(); ++i) size(static_cast<Eigen::Index>(i)) = sizes.size(spec.size[i], spec.where);
  Shape shape = Box{size};
  if (spec.kind == BodySpec::Kind::kCylinder) shape = Cylinder{size.x(), size.y()};
  if (spec.kind == BodySpec::Kind::kSphere) shape = Sphere{size.x()};
  out.push_back({spec.name, shape, X_TP, spec.moves});
}

vision::Feature featureOf(const FeatureSpec& spec, Sizes& sizes) {
  vision::Feature out;
  out.name = spec.name;
  out.kind = spec.kind;
  for (const auto& point : spec.points) {
    vision::FeatureVertex vertex;
    vertex.xyz = sizes.vector(point, spec.where);
    out.vertices.push_back(vertex);
  }
  for (std::size_t i = 1; i < out.vertices.size(); ++i) {
    if ((out.vertices[i].xyz - out.vertices[i - 1].xyz).norm() < 1e-4) sizes.refuse(spec.where, "two of its points are one");
  }
  return out;
}

/// Reads one file; the findings keep the first error.
class TemplateReader {
 public:
  explicit TemplateReader(const std::string& path) { m_findings.file = path; }

  std::string name, title, description;
  std::vector<TemplateParameter> parameters;
  std::set<vision::FeatureKind> kinds;
  Mechanism mechanism;
  std::vector<BodySpec> bodies;
  std::vector<FeatureSpec> features;
  std::vector<ActionSpec> actions;

  Status read() {
    auto node = internal::readYamlMap(m_findings.file);
    if (!node) return node.error();
    YamlSection top(*node, "", m_findings);
    if (top.numberOr("format", 1) != 1) top.refuse("format", "1");
    name = top.text("name");
    title = top.textOr("title", name);
    description = top.textOr("description", "");
    for (const auto& word : top.textsOr("takes")) {
      const auto kind = vision::featureKindFrom(word);
      if (kind) kinds.insert(*kind);
      else top.refuse("takes", "point, line, plane or triad");
    }
    for (auto& section : top.sections("parameters")) readParameter(section);
    readMechanism(top);
    for (auto& section : top.sections("bodies")) readBody(section);
    for (auto& section : top.sections("features")) readFeature(section);
    for (auto& section : top.sections("actions")) readAction(section);
    if (bodies.empty() && !m_findings.error) top.refuse("bodies", "at least one body");
    top.finish();
    if (m_findings.error) return *m_findings.error;
    if (!m_findings.warnings.empty()) return {ErrorCode::kInvalidInput, m_findings.warnings.front()};
    return {};
  }

 private:
  void readParameter(YamlSection& section) {
    TemplateParameter p;
    p.name = section.text("name");
    p.unit = section.textOr("unit", "m");
    p.description = section.textOr("description", "");
    p.value = section.number("value");
    const auto range = section.numbers("range", 2);
    p.lower = range[0];
    p.upper = range[1];
    const std::string from = section.textOr("from", "");
    if (!from.empty() && from != "u" && from != "v" && from != "w") section.refuse("from", "u, v or w");
    if (!from.empty()) p.from = from[0];
    if (!(p.lower <= p.value && p.value <= p.upper)) section.refuse("value", "a number within range");
    section.finish();
    parameters.push_back(std::move(p));
  }

  void readMechanism(YamlSection& top) {
    auto section = top.sectionOr("mechanism");
    if (!section) return;
    mechanism.slides = section->has("slide");
    mechanism.line = section->text(mechanism.slides ? "slide" : "hinge");
    mechanism.by = section->text("by");
    section->finish();
  }

  void readBody(YamlSection& section) {
    BodySpec body;
    body.name = section.text("name");
    body.where = "body " + body.name;
    body.at = section.textsOr("at");
    body.turn_deg = section.textsOr("turn_deg");
    body.moves = section.flagOr("moves", false);
    int kinds_given = 0;
    using Kind = BodySpec::Kind;
    for (const auto& [key, kind] : {std::pair("box", Kind::kBox), std::pair("cylinder", Kind::kCylinder),
                                    std::pair("sphere", Kind::kSphere), std::pair("ring", Kind::kRing)}) {
      if (!section.has(key)) continue;
      ++kinds_given;
      body.kind = kind;
      body.size = section.textsOr(key);
    }
    if (kinds_given != 1) section.refuse("box", "exactly one of box, cylinder, sphere and ring");
    section.finish();
    bodies.push_back(std::move(body));
  }

  void readFeature(YamlSection& section) {
    FeatureSpec feature;
    feature.name = section.text("name");
    feature.where = "feature " + feature.name;
    feature.moves = section.flagOr("moves", false);
    const auto kind = vision::featureKindFrom(section.text("kind"));
    if (kind) feature.kind = *kind;
    else section.refuse("kind", "point, line, plane or triad");
    for (int i = 0; i < vision::vertexCount(feature.kind); ++i) {
      const std::string key = "p" + std::to_string(i);
      feature.points.push_back(section.textsOr(key));
      if (feature.points.back().size() != 3) section.refuse(key, "three numbers");
    }
    section.finish();
    features.push_back(std::move(feature));
  }

  void readAction(YamlSection& section) {
    ActionSpec spec;
    spec.action.name = section.text("name");
    spec.action.title = section.textOr("title", spec.action.name);
    spec.action.description = section.textOr("description", "");
    for (auto& step : section.sections("steps")) spec.steps.push_back(readStep(step));
    if (spec.steps.empty()) section.refuse("steps", "at least one step");
    section.finish();
    actions.push_back(std::move(spec));
  }

  StepSpec readStep(YamlSection& section) {
    StepSpec out;
    out.where = section.trailOf("macro");
    if (section.has("gripper")) {
      const std::string word = section.text("gripper");
      if (word != "open" && word != "close") section.refuse("gripper", "open or close");
      out.step.kind = word == "open" ? TemplateStep::Kind::kOpenGripper : TemplateStep::Kind::kCloseGripper;
    } else {
      out.step.macro = section.text("macro");
      out.step.feature = section.text("feature");
      out.step.through = section.flagOr("through", false);
      out.arguments = section.textMapOr("arguments");
    }
    out.adds = section.textMapOr("adds");
    section.finish();
    return out;
  }

  YamlFindings m_findings;
};

}  // namespace

struct ObjectTemplate::Impl {
  std::string path;
  TemplateReader spec;

  explicit Impl(const std::string& file) : path(file), spec(file) {}

  Result<Values> valuesFor(const Values& given) const {
    Values values;
    for (const auto& p : spec.parameters) values[p.name] = p.value;
    for (const auto& [name, value] : given) {
      const auto found = std::find_if(spec.parameters.begin(), spec.parameters.end(), [&, n = name](const auto& p) { return p.name == n; });
      if (found == spec.parameters.end()) {
        return Error{ErrorCode::kNotFound, "Template " + spec.name + " has no parameter \"" + name + "\"."};
      }
      if (!(value >= found->lower && value <= found->upper)) {
        return Error{ErrorCode::kOutOfLimits, name + " " + formatNumber(value) + " " + found->unit + " is outside " +
                                                  formatNumber(found->lower) + " to " + formatNumber(found->upper) + " " + found->unit + "."};
      }
      values[name] = value;
    }
    return values;
  }

  void move(TemplateInstance& out, const Values& values, Sizes& sizes) const {
    if (spec.mechanism.line.empty()) return;
    const auto line = out.features.find(spec.mechanism.line);
    const auto by = values.find(spec.mechanism.by);
    if (line == out.features.end() || line->second.kind != vision::FeatureKind::kLine) {
      return sizes.refuse("mechanism", "\"" + spec.mechanism.line + "\" is no feature of kind line");
    }
    if (by == values.end()) return sizes.refuse("mechanism", "\"" + spec.mechanism.by + "\" is no parameter");
    const Vector3d on = line->second.vertices[0].xyz, along = line->second.direction();
    Pose X = Pose::Identity();
    if (spec.mechanism.slides) {
      X.translation() = by->second * along;
    } else {
      X.linear() = Eigen::AngleAxisd(by->second, along).toRotationMatrix();
      X.translation() = on - X.linear() * on;
    }
    for (auto& part : out.parts) {
      if (part.moves) part.X_TP = X * part.X_TP;
    }
    for (const auto& feature : spec.features) {
      if (!feature.moves) continue;
      for (auto& vertex : out.features.at(feature.name).vertices) vertex.xyz = X * vertex.xyz;
    }
  }

  TemplateAction actionOf(const ActionSpec& from, const TemplateInstance& instance, const Values& values, Sizes& sizes) const {
    TemplateAction action = from.action;
    for (const auto& step : from.steps) {
      action.steps.push_back(step.step);
      TemplateStep& out = action.steps.back();
      for (const auto& [name, sum] : step.arguments) out.arguments[name] = sizes.value(sum, step.where);
      for (const auto& [name, sum] : step.adds) {
        if (values.count(name) == 0) sizes.refuse(step.where, "adds to \"" + name + "\", which is no parameter");
        out.adds[name] = sizes.value(sum, step.where);
      }
      if (out.kind == TemplateStep::Kind::kMacro && instance.features.count(out.feature) == 0) {
        sizes.refuse(step.where, "\"" + out.feature + "\" is no feature of the template");
      }
    }
    return action;
  }
};

Result<ObjectTemplate> ObjectTemplate::load(const std::string& path) {
  auto impl = std::make_shared<Impl>(path);
  if (const Status read = impl->spec.read(); !read) return read.error();
  ObjectTemplate out;
  out.m_impl = std::move(impl);
  if (const auto whole = out.instance({}); !whole) return whole.error();
  return out;
}

const std::string& ObjectTemplate::path() const { return m_impl->path; }
const std::string& ObjectTemplate::name() const { return m_impl->spec.name; }
const std::string& ObjectTemplate::title() const { return m_impl->spec.title; }
const std::string& ObjectTemplate::description() const { return m_impl->spec.description; }
const std::vector<TemplateParameter>& ObjectTemplate::parameters() const { return m_impl->spec.parameters; }
bool ObjectTemplate::takes(vision::FeatureKind kind) const { return m_impl->spec.kinds.empty() || m_impl->spec.kinds.count(kind) != 0; }

Result<TemplateInstance> ObjectTemplate::instance(const std::map<std::string, double>& parameters) const {
  const auto values = m_impl->valuesFor(parameters);
  if (!values) return values.error();
  Sizes sizes(m_impl->path, *values);
  TemplateInstance out;
  for (const auto& body : m_impl->spec.bodies) addBody(body, sizes, out.parts);
  for (const auto& feature : m_impl->spec.features) out.features[feature.name] = featureOf(feature, sizes);
  if (out.parts.size() > kMostParts) sizes.refuse("bodies", "more than 200 bodies");
  if (sizes.status()) m_impl->move(out, *values, sizes);
  for (const auto& action : m_impl->spec.actions) out.actions.push_back(m_impl->actionOf(action, out, *values, sizes));
  if (!sizes.status()) return sizes.status().error();
  return out;
}

std::vector<ObjectTemplate> loadTemplates(const std::vector<std::string>& more, std::vector<std::string>* warnings) {
  namespace fs = std::filesystem;
  std::vector<std::string> places, files;
  if (const auto built_in = resourcePath("templates")) places.push_back(*built_in);
  places.insert(places.end(), more.begin(), more.end());
  for (const auto& place : places) {
    std::error_code error;
    if (!fs::is_directory(place, error)) {
      files.push_back(place);
      continue;
    }
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(place, error)) {
      if (entry.path().extension() == ".yaml") found.push_back(entry.path().string());
    }
    std::sort(found.begin(), found.end());
    files.insert(files.end(), found.begin(), found.end());
  }
  std::map<std::string, ObjectTemplate> by_name;
  for (const auto& file : files) {
    auto read = ObjectTemplate::load(file);
    if (read) by_name.insert_or_assign(read->name(), std::move(*read));
    else if (warnings != nullptr) warnings->push_back(read.error().message);
  }
  std::vector<ObjectTemplate> out;
  for (auto& [name, each] : by_name) out.push_back(std::move(each));
  return out;
}

}  // namespace longarm::planning
