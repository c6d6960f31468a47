/// Builds a RobotModel: bounds, our own check, urdfdom, meshes, SRDF.

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <tuple>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include "core/printable.h"
#include "core/text.h"
#include "planning/robot/robot_model.h"
#include "planning/robot/srdf_file.h"
#include "planning/robot/urdf_check.h"
#include "planning/robot/xml_bounds.h"
#include "planning/world/mesh_file.h"
#include "planning/world/mesh_path.h"

namespace longarm::planning {
namespace {

/// Collects what urdfdom complains about, instead of standard error.
class ComplaintCollector final : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && m_text.size() < 400) {
      m_text += (m_text.empty() ? "" : "; ") + text.substr(0, 400);
    }
  }
  const std::string& text() const { return m_text; }

 private:
  std::string m_text;
};

/// urdfdom with its complaints.  Its log handler is global, so one caller at a time.
Result<urdf::ModelInterfaceSharedPtr> parseWithUrdfdom(const std::string& text, const std::string& name) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  ComplaintCollector complaints;
  console_bridge::useOutputHandler(&complaints);
  urdf::ModelInterfaceSharedPtr model;
  std::string thrown;
  try {
    model = urdf::parseURDF(text);
  } catch (const std::exception& e) {
    thrown = e.what();
  }
  console_bridge::restorePreviousOutputHandler();
  if (model && thrown.empty()) return model;
  const std::string why = complaints.text() + thrown;
  return Error{ErrorCode::kInvalidInput, name + ": not a valid URDF: " + (why.empty() ? "refused by the parser" : why)};
}

Pose poseOf(const urdf::Pose& pose) {
  return poseFrom({pose.position.x, pose.position.y, pose.position.z},
                  {pose.rotation.x, pose.rotation.y, pose.rotation.z, pose.rotation.w});
}

JointType typeOf(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE: return JointType::kRevolute;
    case urdf::Joint::CONTINUOUS: return JointType::kContinuous;
    case urdf::Joint::PRISMATIC: return JointType::kPrismatic;
    default: return JointType::kFixed;
  }
}

}  // namespace

/// The steps of RobotModel::load; friend of the model.
class RobotLoader {
 public:
  RobotLoader(std::string urdf_path, std::string srdf_path, LoadOptions options)
      : m_urdf_path(std::move(urdf_path)),
        m_srdf_path(std::move(srdf_path)),
        m_options(std::move(options)),
        m_resolver(m_urdf_path, m_options.package_paths),
        m_model(new RobotModel) {}

  Result<std::shared_ptr<const RobotModel>> run() {
    const auto text = internal::readBoundedXml(m_urdf_path);
    if (!text) return text.error();
    const auto outline = internal::checkUrdf(*text, m_urdf_path);
    if (!outline) return outline.error();
    const auto parsed = parseWithUrdfdom(*text, m_urdf_path);
    if (!parsed) return parsed.error();
    m_model->m_name = (*parsed)->getName();
    m_model->m_warnings = outline->warnings;
    for (const auto step : {&RobotLoader::addLinks, &RobotLoader::addJoints}) {
      if (const Status status = (this->*step)(**parsed, *outline); !status) return status.error();
    }
    if (const Status status = resolveMimics(); !status) return status.error();
    orderDepthFirst();
    if (const Status status = readSrdf(); !status) return status.error();
    for (auto& warning : m_model->m_warnings) warning = printable(warning);
    return std::shared_ptr<const RobotModel>(std::move(m_model));
  }

 private:
  Status addLinks(const urdf::ModelInterface& urdf, const internal::UrdfOutline& outline) {
    for (const auto& name : outline.links) {
      const auto link = urdf.getLink(name);
      if (!link) return lost("link", name);
      Link& added = m_model->m_links.emplace_back();
      added.name = name;
      m_link_index[name] = static_cast<int>(m_model->m_links.size()) - 1;
      for (const auto& visual : link->visual_array) {
        addShape(*visual->geometry, visual->origin, visual->material.get(), name, false, added.visuals);
      }
      for (const auto& collision : link->collision_array) {
        addShape(*collision->geometry, collision->origin, nullptr, name, true, added.collisions);
      }
    }
    return {};
  }

  Status lost(const char* kind, const std::string& name) const {
    return {ErrorCode::kInvalidInput, m_urdf_path + ": " + kind + " \"" + name.substr(0, 200) +
                                          "\" was dropped by the parser; check its spelling and quotes"};
  }

  void addShape(const urdf::Geometry& geometry, const urdf::Pose& origin, const urdf::Material* material,
                const std::string& link, bool collides, std::vector<LinkShape>& shapes) {
    LinkShape added;
    added.X_LS = poseOf(origin);
    if (material != nullptr) {
      const auto& c = material->color;
      added.rgba = Eigen::Vector4d(c.r, c.g, c.b, c.a).cwiseMax(0).cwiseMin(1);
    }
    if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
      added.shape = Box{{box->dim.x, box->dim.y, box->dim.z}};
    } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
      added.shape = Cylinder{cylinder->radius, cylinder->length};
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
      added.shape = Sphere{sphere->radius};
    } else if (const auto* mesh = dynamic_cast<const urdf::Mesh*>(&geometry)) {
      if (!m_options.load_meshes) return;
      auto loaded = meshFor(*mesh);
      if (!loaded) return warnAboutMesh(link, collides, loaded.error());
      added.shape = *loaded;
    }
    shapes.push_back(std::move(added));
  }

  void warnAboutMesh(const std::string& link, bool collides, const Error& error) {
    m_model->m_warnings.push_back(
        "link \"" + link + "\", " + (collides ? "collision" : "visual") + " mesh: " + error.message +
        (collides ? "; this part of the link is NOT checked for collisions" : "; it is not drawn"));
  }

  /// Each file is read once per scale; failures are remembered as well.
  Result<std::shared_ptr<const TriangleMesh>> meshFor(const urdf::Mesh& mesh) {
    const auto key = std::make_tuple(mesh.filename, mesh.scale.x, mesh.scale.y, mesh.scale.z);
    const auto found = m_meshes.find(key);
    if (found != m_meshes.end()) return found->second;
    auto loaded = [&]() -> Result<std::shared_ptr<const TriangleMesh>> {
      const auto path = m_resolver.resolve(mesh.filename);
      if (!path) return path.error();
      return loadMesh(*path, {mesh.scale.x, mesh.scale.y, mesh.scale.z});
    }();
    return m_meshes.emplace(key, loaded).first->second;
  }

  Status addJoints(const urdf::ModelInterface& urdf, const internal::UrdfOutline& outline) {
    for (const auto& name : outline.joints) {
      const auto joint = urdf.getJoint(name);
      if (!joint) return lost("joint", name);
      Joint& added = m_model->m_joints.emplace_back();
      const int index = static_cast<int>(m_model->m_joints.size()) - 1;
      added.name = name;
      added.type = typeOf(*joint);
      added.parent_link = m_link_index.at(joint->parent_link_name);
      added.child_link = m_link_index.at(joint->child_link_name);
      added.X_PJ = poseOf(joint->parent_to_joint_origin_transform);
      m_joint_index[name] = index;
      m_model->m_links[static_cast<std::size_t>(added.child_link)].parent_joint = index;
      if (!isRigid(added.X_PJ)) {
        return {ErrorCode::kInvalidInput, m_urdf_path + ": joint \"" + name + "\": its origin is not finite"};
      }
      if (added.type == JointType::kFixed) continue;
      added.axis = Eigen::Vector3d(joint->axis.x, joint->axis.y, joint->axis.z).normalized();
      addLimits(*joint, added);
    }
    return {};
  }

  void addLimits(const urdf::Joint& joint, Joint& added) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    added.lower = added.type == JointType::kContinuous ? -kInfinity : joint.limits->lower;
    added.upper = added.type == JointType::kContinuous ? kInfinity : joint.limits->upper;
    if (joint.limits) added.max_velocity = joint.limits->velocity;
    if (!joint.mimic) return;
    added.mimic_multiplier = joint.mimic->multiplier;
    added.mimic_offset = joint.mimic->offset;
    m_mimic_source[added.name] = joint.mimic->joint_name;  // Resolved when all joints are known.
  }

  /// A mimic of a mimic becomes a mimic of the joint that moves both.
  Status resolveMimics() {
    const auto parsed = mimicNames();
    if (!parsed) return parsed.error();
    for (auto& [index, source] : *parsed) {
      Joint& joint = m_model->m_joints[static_cast<std::size_t>(index)];
      double multiplier = joint.mimic_multiplier, offset = joint.mimic_offset;
      int at = source;
      for (auto next = parsed->find(at); next != parsed->end(); next = parsed->find(at)) {
        const auto& [a, b] = m_raw_mimic.at(at);
        offset += multiplier * b;
        multiplier *= a;
        at = next->second;
      }
      if (m_model->m_joints[static_cast<std::size_t>(at)].type == JointType::kFixed) {
        return {ErrorCode::kInvalidInput, m_urdf_path + ": joint \"" + joint.name +
                                              "\" mimics a fixed joint; expected one that moves"};
      }
      joint.mimic_of = at;
      joint.mimic_multiplier = multiplier;
      joint.mimic_offset = offset;
    }
    return {};
  }

  /// Mimic joint -> joint it names.
  Result<std::map<int, int>> mimicNames() {
    std::map<int, int> sources;
    for (std::size_t i = 0; i < m_model->m_joints.size(); ++i) {
      const Joint& joint = m_model->m_joints[i];
      const auto source = m_mimic_source.find(joint.name);
      if (source == m_mimic_source.end()) continue;
      const auto found = m_joint_index.find(source->second);
      if (found == m_joint_index.end()) return lost("mimicked joint", source->second).error();
      sources[static_cast<int>(i)] = found->second;
      m_raw_mimic[static_cast<int>(i)] = {joint.mimic_multiplier, joint.mimic_offset};
    }
    return sources;
  }

  void orderDepthFirst() {
    std::vector<std::vector<int>> children(m_model->m_links.size());
    for (std::size_t i = 0; i < m_model->m_joints.size(); ++i) {
      children[static_cast<std::size_t>(m_model->m_joints[i].parent_link)].push_back(static_cast<int>(i));
    }
    const auto root = std::find_if(m_model->m_links.begin(), m_model->m_links.end(),
                                   [](const Link& link) { return link.parent_joint < 0; });
    m_model->m_root = static_cast<int>(root - m_model->m_links.begin());
    std::vector<int> stack(children[static_cast<std::size_t>(m_model->m_root)].rbegin(),
                           children[static_cast<std::size_t>(m_model->m_root)].rend());
    while (!stack.empty()) {
      const int index = stack.back();
      stack.pop_back();
      m_model->m_topological.push_back(index);
      Joint& joint = m_model->m_joints[static_cast<std::size_t>(index)];
      if (joint.type != JointType::kFixed && joint.mimic_of < 0) {
        joint.q_index = static_cast<int>(m_model->m_actuated.size());
        m_model->m_actuated.push_back(index);
        m_model->m_actuated_names.push_back(joint.name);
      }
      const auto& below = children[static_cast<std::size_t>(joint.child_link)];
      stack.insert(stack.end(), below.rbegin(), below.rend());
    }
  }

  Status readSrdf() {
    if (m_srdf_path.empty()) return {};
    const auto text = internal::readBoundedXml(m_srdf_path);
    if (!text) return text.error();
    const auto srdf = internal::parseSrdf(*text, m_srdf_path);
    if (!srdf) return srdf.error();
    takeStates(*srdf);
    takePairs(*srdf);
    takeGroups(*srdf);
    return {};
  }

  void takeStates(const internal::SrdfContent& srdf) {
    for (const auto& [name, values] : srdf.states) {
      for (const auto& [joint, value] : values) {
        const auto found = m_joint_index.find(joint);
        if (found == m_joint_index.end()) {
          warnSrdf("group_state \"" + name + "\" names joint \"" + joint + "\", which the robot does not have");
          continue;
        }
        const Joint& known = m_model->m_joints[static_cast<std::size_t>(found->second)];
        if (value < known.lower - 1e-9 || value > known.upper + 1e-9) {
          warnSrdf("group_state \"" + name + "\": joint \"" + joint + "\" at " + formatNumber(value) +
                   " is outside its limits " + formatNumber(known.lower) + " ... " + formatNumber(known.upper));
        }
        m_model->m_named_states[name][joint] = value;
      }
    }
  }

  void takePairs(const internal::SrdfContent& srdf) {
    auto& pairs = m_model->m_srdf_pairs.emplace();
    for (const auto& [first, second] : srdf.allowed_pairs) {
      const auto a = m_link_index.find(first), b = m_link_index.find(second);
      if (a == m_link_index.end() || b == m_link_index.end()) {
        warnSrdf("disable_collisions names link \"" + (a == m_link_index.end() ? first : second) +
                 "\", which the robot does not have");
        continue;
      }
      pairs.insert(std::minmax(a->second, b->second));
    }
  }

  void takeGroups(const internal::SrdfContent& srdf) {
    for (const auto& group : srdf.groups) {
      if (group.base_link.empty()) continue;
      auto chain = m_model->chain(group.base_link, group.tip_link);
      if (!chain) {
        warnSrdf("group \"" + group.name + "\": " + chain.error().message);
        continue;
      }
      chain->name = group.name;
      m_model->m_groups.push_back(*std::move(chain));
    }
  }

  void warnSrdf(const std::string& what) { m_model->m_warnings.push_back(m_srdf_path + ": " + what); }

  std::string m_urdf_path, m_srdf_path;
  LoadOptions m_options;
  internal::MeshResolver m_resolver;
  std::unique_ptr<RobotModel> m_model;
  std::map<std::string, int> m_link_index, m_joint_index;
  std::map<std::string, std::string> m_mimic_source;
  std::map<int, std::pair<double, double>> m_raw_mimic;
  std::map<std::tuple<std::string, double, double, double>, Result<std::shared_ptr<const TriangleMesh>>> m_meshes;
};

Result<std::shared_ptr<const RobotModel>> RobotModel::load(const std::string& urdf_path,
                                                           const std::string& srdf_path,
                                                           const LoadOptions& options) {
  try {
    return printable(RobotLoader(urdf_path, srdf_path, options).run());
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInternal, urdf_path + ": reading failed: " + e.what()};
  }
}

}  // namespace longarm::planning
