#include "planning/world/workcell.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/printable.h"
#include "core/resource_path.h"
#include "core/text.h"
#include "planning/world/mesh_file.h"
#include "planning/world/yaml_section.h"
#include "planning/world/zone.h"

namespace longarm::planning {
namespace {

namespace fs = std::filesystem;
using internal::NumberRange;
using internal::YamlSection;

/// Reads one workcell file section by section; the findings keep the first error.
class WorkcellReader {
 public:
  explicit WorkcellReader(const std::string& path) { m_findings.file = m_cell.path = path; }

  Result<Workcell> run() {
    auto node = internal::readYamlMap(m_cell.path);
    if (!node) return node.error();
    YamlSection top(*node, "", m_findings);
    m_cell.name = top.textOr("name", fs::path(m_cell.path).stem().string());
    if (top.numberOr("format", 1) != 1) top.refuse("format", "1");
    if (const Status status = readRobot(top); !status) return status.error();
    readArm(top);
    readGripper(top);
    readBase(top);
    readImu(top);
    readPanTilts(top);
    readCameras(top);
    readBackend(top);
    readObjects(top);
    readPoses(top);
    for (const auto& place : top.textsOr("templates")) m_cell.templates.push_back(absolute(place));
    if (auto speeds = top.sectionOr("speeds")) {
      m_cell.max_tool_speed = speeds->numberOr("max_tool_speed", m_cell.max_tool_speed, NumberRange::kPositive);
      m_cell.approach_speed = speeds->numberOr("approach_speed", m_cell.approach_speed, NumberRange::kPositive);
      speeds->finish();
    }
    top.finish();
    if (m_findings.error) return *m_findings.error;
    m_cell.warnings.insert(m_cell.warnings.end(), m_findings.warnings.begin(), m_findings.warnings.end());
    return std::move(m_cell);
  }

 private:
  std::string absolute(const std::string& file) const {
    const fs::path path = fs::path(m_cell.path).parent_path() / file;  // An absolute `file` replaces the folder.
    std::error_code ec;
    const fs::path full = fs::absolute(path, ec).lexically_normal();
    return ec ? path.string() : full.string();
  }

  Status readRobot(YamlSection& top) {
    YamlSection robot = top.section("robot");
    const std::string urdf = robot.text("urdf");
    const std::string srdf = robot.textOr("srdf", "");
    LoadOptions options;
    for (const auto& path : robot.textsOr("package_paths")) options.package_paths.push_back(absolute(path));
    robot.finish();
    if (m_findings.error) return *m_findings.error;
    auto model = RobotModel::load(absolute(urdf), srdf.empty() ? srdf : absolute(srdf), options);
    if (!model) {
      robot.refuse("urdf", "a robot that can be read: " + model.error().message);
      return *m_findings.error;
    }
    m_cell.model = *model;
    m_cell.warnings = m_cell.model->warnings();
    return {};
  }

  const RobotModel& model() const { return *m_cell.model; }

  /// The value of `key`, which must name a link.
  std::string linkName(YamlSection& section, const std::string& key) {
    const std::string name = section.text(key);
    if (!name.empty() && !model().linkIndex(name)) section.refuse(key, "a link of robot \"" + model().name() + "\"");
    return name;
  }

  /// The value of `key`, which must name a joint that moves by itself.
  std::string jointName(YamlSection& section, const std::string& key) {
    const std::string name = section.text(key);
    if (!name.empty() && !isActuated(name)) {
      section.refuse(key, "a moving joint of robot \"" + model().name() + "\"");
    }
    return name;
  }

  bool isActuated(const std::string& name) const {
    const auto& names = model().actuatedNames();
    return std::find(names.begin(), names.end(), name) != names.end();
  }

  void readArm(YamlSection& top) {
    YamlSection arm = top.section("arm");
    const std::string base = arm.has("base") ? linkName(arm, "base") : rootName();
    const std::string tip = linkName(arm, "tip");
    if (m_findings.error) return;
    auto chain = model().chain(base, tip);
    if (!chain || chain->joints.empty()) {
      arm.refuse("tip", "a link below \"" + base + "\" with moving joints between");
      return;
    }
    m_cell.arm = *std::move(chain);
    m_cell.arm.name = arm.textOr("name", "arm");
    readLimits(arm);
    arm.finish();
  }

  std::string rootName() const { return model().links()[static_cast<std::size_t>(model().rootLink())].name; }

  void readLimits(YamlSection& arm) {
    const std::size_t n = m_cell.arm.joints.size();
    MotionLimits& limits = m_cell.arm_limits;
    for (auto* vector : {&limits.lower, &limits.upper, &limits.max_velocity}) {
      vector->resize(static_cast<Eigen::Index>(n));
    }
    const double margin = arm.numberOr("limit_margin", 0, NumberRange::kNotNegative);
    for (std::size_t i = 0; i < n; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      const Joint& joint = model().joints()[static_cast<std::size_t>(m_cell.arm.joints[i])];
      const bool limited = joint.type != JointType::kContinuous;
      limits.lower[k] = limited ? joint.lower + margin : -2 * M_PI;
      limits.upper[k] = limited ? joint.upper - margin : 2 * M_PI;
      limits.max_velocity[k] = joint.max_velocity;
      if (limits.lower[k] > limits.upper[k]) arm.refuse("limit_margin", "less than half of the range of " + joint.name);
    }
    readRates(arm, n);
  }

  void readRates(YamlSection& arm, std::size_t n) {
    MotionLimits& limits = m_cell.arm_limits;
    const auto vectorOf = [&](const std::string& key) {
      const auto values = arm.numberOrNumbers(key, n, NumberRange::kPositive);
      return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(n)));
    };
    if (arm.has("max_velocity")) limits.max_velocity = vectorOf("max_velocity");
    if (limits.max_velocity.minCoeff() <= 0) {
      arm.refuse("max_velocity", "a speed above 0 for every joint, because the URDF gives none");
    }
    limits.max_acceleration = vectorOf("max_acceleration");
    limits.stop_deceleration = arm.has("stop_deceleration") ? vectorOf("stop_deceleration")
                                                            : Eigen::VectorXd(3 * limits.max_acceleration);
    if ((limits.stop_deceleration - limits.max_acceleration).minCoeff() < 0) {
      arm.refuse("stop_deceleration", "at least max_acceleration for every joint");
    }
  }

  void readGripper(YamlSection& top) {
    auto gripper = top.sectionOr("gripper");
    if (!gripper || m_findings.error) return;
    GripperSpec spec;
    spec.joint = jointName(*gripper, "joint");
    spec.open = gripper->number("open");
    spec.closed = gripper->number("closed");
    spec.max_width = gripper->number("max_width", NumberRange::kPositive);
    spec.links = gripper->textsOr("links");
    spec.device = gripper->textOr("device", "gripper");
    for (const auto& link : spec.links) {
      if (!model().linkIndex(link)) gripper->refuse("links", "links of the robot; \"" + link + "\" is none");
    }
    gripper->finish();
    m_cell.gripper = std::move(spec);
  }

  void readBase(YamlSection& top) {
    auto base = top.sectionOr("base");
    if (!base || m_findings.error) return;
    BaseLimits limits;
    limits.max_speed = base->numberOr("max_speed", limits.max_speed, NumberRange::kPositive);
    limits.max_turn = base->numberOr("max_turn", limits.max_turn, NumberRange::kPositive);
    limits.max_acceleration =
        base->numberOr("max_acceleration", limits.max_acceleration, NumberRange::kPositive);
    limits.max_turn_acceleration =
        base->numberOr("max_turn_acceleration", limits.max_turn_acceleration, NumberRange::kPositive);
    limits.sideways = base->flagOr("sideways", false);
    base->finish();
    m_cell.base = limits;
  }

  void readImu(YamlSection& top) {
    auto imu = top.sectionOr("imu");
    if (!imu || m_findings.error) return;
    m_cell.imu = ImuSpec{linkName(*imu, "link"), imu->textOr("topic", "")};
    imu->finish();
  }

  void readPanTilts(YamlSection& top) {
    for (auto& section : top.sections("pan_tilts")) {
      PanTiltSpec spec{section.text("name"), jointName(section, "pan_joint"), jointName(section, "tilt_joint")};
      section.finish();
      if (hasPanTilt(spec.name)) section.refuse("name", "a name of its own");
      m_cell.pan_tilts.push_back(std::move(spec));
    }
  }

  bool hasPanTilt(const std::string& name) const {
    return std::any_of(m_cell.pan_tilts.begin(), m_cell.pan_tilts.end(),
                       [&](const PanTiltSpec& p) { return p.name == name; });
  }

  void readCameras(YamlSection& top) {
    auto sections = top.sections("cameras");
    for (auto& section : sections) {
      CameraSpec spec;
      spec.name = section.text("name");
      spec.link = linkName(section, "link");
      spec.pan_tilt = section.textOr("pan_tilt", "");
      spec.stereo_partner = section.textOr("stereo_partner", "");
      spec.role = section.textOr("role", "");
      spec.sigma_px = section.numberOr("sigma_px", 0.5, NumberRange::kPositive);
      if (section.has("calibration")) spec.calibration = absolute(section.text("calibration"));
      readLens(section, spec);
      section.finish();
      if (m_cell.camera(spec.name) != nullptr) section.refuse("name", "a name of its own");
      if (!spec.pan_tilt.empty() && !hasPanTilt(spec.pan_tilt)) section.refuse("pan_tilt", "one of pan_tilts");
      warnAboutCalibration(spec);
      m_cell.cameras.push_back(std::move(spec));
    }
    for (auto& section : sections) {
      const std::string partner = section.textOr("stereo_partner", "");
      if (!partner.empty() && m_cell.camera(partner) == nullptr) section.refuse("stereo_partner", "one of cameras");
    }
  }

  void readLens(YamlSection& section, CameraSpec& spec) {
    spec.zooms = section.flagOr("zoom", spec.role == "ptz");
    if (section.has("picture_size")) {
      const auto size = section.numbers("picture_size", 2, NumberRange::kPositive);
      spec.width = static_cast<int>(size[0]);
      spec.height = static_cast<int>(size[1]);
    }
    auto digital = section.sectionOr("digital_zoom");
    if (!digital) return;
    spec.digital_zoom.from = digital->number("from", NumberRange::kNotNegative);
    spec.digital_zoom.factor = digital->number("factor", NumberRange::kPositive);
    if (spec.digital_zoom.from >= 1) digital->refuse("from", "a setting below 1");
    if (spec.digital_zoom.factor < 1) digital->refuse("factor", "an enlargement of at least 1");
    digital->finish();
  }

  void warnAboutCalibration(const CameraSpec& spec) {
    std::error_code ec;
    if (spec.calibration.empty()) {
      m_cell.warnings.push_back(m_cell.path + ": camera \"" + spec.name + "\" has no calibration; nothing can be " +
                                "measured with it");
    } else if (!fs::is_regular_file(spec.calibration, ec)) {
      m_cell.warnings.push_back(m_cell.path + ": camera \"" + spec.name + "\": calibration " + spec.calibration +
                                " does not exist");
    }
  }

  void readBackend(YamlSection& top) {
    auto backend = top.sectionOr("backend");
    if (!backend) return;
    m_cell.backend.driver = backend->textOr("driver", m_cell.backend.driver);
    m_cell.backend.url = backend->textOr("url", "");
    m_cell.backend.is_virtual = backend->flagOr("virtual", false);
    m_cell.backend.topics = backend->textMapOr("topics");
    if (!m_cell.backend.is_virtual && m_cell.backend.url.empty()) {
      m_findings.warn(YAML::Node(), "backend.url is missing; the robot can be planned for but not driven");
    }
    backend->finish();
  }

  void readObjects(YamlSection& top) {
    for (auto& section : top.sections("objects")) {
      WorldObject object;
      object.name = section.text("name");
      object.X_WO = section.poseOr("pose");
      object.collides = section.flagOr("collides", true);
      readRole(section, object);
      if (section.has("attached_link")) object.attached_link = linkName(section, "attached_link");
      if (section.has("rgba")) {
        const auto rgba = section.numbers("rgba", 4, NumberRange::kNotNegative);
        object.rgba = Eigen::Map<const Eigen::Vector4d>(rgba.data()).cwiseMin(1);
      }
      readShape(section, object.shape);
      if (object.role == BodyRole::kKeepIn && !std::holds_alternative<Box>(object.shape)) section.refuse("role", "a box, where it is keep_in");
      section.finish();
      m_cell.objects.push_back(std::move(object));
    }
  }

  static void readRole(YamlSection& section, WorldObject& object) {
    const std::string role = section.textOr("role", "solid");
    if (role == "keep_out") object.role = BodyRole::kKeepOut;
    else if (role == "keep_in") object.role = BodyRole::kKeepIn;
    else if (role != "solid") section.refuse("role", "solid, keep_out or keep_in");
    if (object.role != BodyRole::kSolid) object.rgba = zoneColour(object.role);
  }

  /// Exactly one of box, cylinder, sphere, mesh.
  void readShape(YamlSection& section, Shape& shape) {
    int kinds = 0;
    for (const char* kind : {"box", "cylinder", "sphere", "mesh"}) kinds += section.has(kind) ? 1 : 0;
    if (kinds != 1) {
      section.refuse("box", "exactly one of box, cylinder, sphere and mesh");
      return;
    }
    if (section.has("box")) {
      const auto size = section.numbers("box", 3, NumberRange::kPositive);
      shape = Box{{size[0], size[1], size[2]}};
    } else if (auto cylinder = section.sectionOr("cylinder")) {
      shape = Cylinder{cylinder->number("radius", NumberRange::kPositive),
                       cylinder->number("length", NumberRange::kPositive)};
      cylinder->finish();
    } else if (section.has("sphere")) {
      auto sphere = section.section("sphere");
      shape = Sphere{sphere.number("radius", NumberRange::kPositive)};
      sphere.finish();
    } else {
      readMesh(section, shape);
    }
  }

  void readMesh(YamlSection& section, Shape& shape) {
    auto mesh = section.section("mesh");
    const std::string file = mesh.text("file");
    const double scale = mesh.numberOr("scale", 1, NumberRange::kPositive);
    mesh.finish();
    if (m_findings.error) return;
    auto loaded = loadMesh(absolute(file), Eigen::Vector3d::Constant(scale));
    if (loaded) {
      shape = *std::move(loaded);
    } else {
      mesh.refuse("file", "a mesh that can be read: " + loaded.error().message);
    }
  }

  void readPoses(YamlSection& top) {
    m_cell.poses = model().namedStates();
    auto poses = top.sectionOr("poses");
    if (!poses) return;
    for (const auto& [name, unused] : top.namedSections("poses")) {
      for (const auto& [joint, value] : poses->numberMapOr(name)) {
        const auto index = model().jointIndex(joint);
        if (!index || !isActuated(joint)) {
          poses->refuse(name, "moving joints of the robot; \"" + joint.substr(0, 60) + "\" is none");
          return;
        }
        const Joint& known = model().joints()[static_cast<std::size_t>(*index)];
        if (value < known.lower || value > known.upper) {
          poses->refuse(name, "joint \"" + joint + "\" between " + formatNumber(known.lower) + " and " +
                                  formatNumber(known.upper) + ", not " + formatNumber(value));
        }
        m_cell.poses[name][joint] = value;
      }
    }
  }

  internal::YamlFindings m_findings;
  Workcell m_cell;
};

}  // namespace

std::vector<std::string> Workcell::armJointNames() const {
  std::vector<std::string> names;
  for (const int index : arm.joints) names.push_back(model->joints()[static_cast<std::size_t>(index)].name);
  return names;
}

const CameraSpec* Workcell::camera(const std::string& wanted) const {
  const auto found =
      std::find_if(cameras.begin(), cameras.end(), [&](const CameraSpec& c) { return c.name == wanted; });
  return found == cameras.end() ? nullptr : &*found;
}

Result<Workcell> loadWorkcell(const std::string& path) {
  try {
    auto workcell = printable(WorkcellReader(path).run());
    if (workcell) {
      for (auto& warning : workcell->warnings) warning = printable(warning);
    }
    return workcell;
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInternal, path + ": reading failed: " + e.what()};
  }
}

Result<Workcell> loadBuiltInWorkcell(const std::string& variant) {
  if (!variant.empty() && variant != "ptz") {
    return Error{ErrorCode::kNotFound, "the built-in robot has no variant \"" + variant.substr(0, 60) +
                                           "\"; expected none or \"ptz\""};
  }
  const auto path = resourcePath("robots/longarm_one/workcell" + (variant.empty() ? "" : "_" + variant) + ".yaml");
  if (!path) return path.error();
  return loadWorkcell(*path);
}

}  // namespace longarm::planning
