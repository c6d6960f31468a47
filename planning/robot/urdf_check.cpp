#include "planning/robot/urdf_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include <pugixml.hpp>

#include "core/text.h"
#include "planning/robot/xml_bounds.h"

namespace longarm::planning::internal {
namespace {

/// How many numbers an attribute holds and which values are allowed.
struct NumberRule {
  const char* element;
  const char* attribute;
  int count;
  bool positive;
};

constexpr std::array<NumberRule, 15> kRules{{{"origin", "xyz", 3, false},
                                             {"origin", "rpy", 3, false},
                                             {"axis", "xyz", 3, false},
                                             {"limit", "lower", 1, false},
                                             {"limit", "upper", 1, false},
                                             {"limit", "velocity", 1, false},
                                             {"limit", "effort", 1, false},
                                             {"mimic", "multiplier", 1, false},
                                             {"mimic", "offset", 1, false},
                                             {"box", "size", 3, true},
                                             {"cylinder", "radius", 1, true},
                                             {"cylinder", "length", 1, true},
                                             {"sphere", "radius", 1, true},
                                             {"mesh", "scale", 3, false},
                                             {"color", "rgba", 4, false}}};

const std::set<std::string> kJointTypes{"fixed", "revolute", "continuous", "prismatic", "floating", "planar"};

struct JointOutline {
  std::string name, type, parent, child, mimic;
  pugi::xml_node node;
};

class UrdfCheck {
 public:
  UrdfCheck(std::string_view text, const std::string& name) : m_text(text), m_name(name) {}

  Result<UrdfOutline> run() {
    const auto parsed = m_document.load_buffer(m_text.data(), m_text.size());
    if (!parsed) {
      return invalidAt(static_cast<std::size_t>(std::max<std::ptrdiff_t>(parsed.offset, 0)),
                       std::string("not well-formed XML: ") + parsed.description());
    }
    const pugi::xml_node robot = m_document.child("robot");
    if (!robot) return Error{ErrorCode::kInvalidInput, m_name + ": no <robot> element; expected a URDF"};
    for (const auto step : {&UrdfCheck::collectLinks, &UrdfCheck::collectJoints}) {
      if (const Status status = (this->*step)(robot); !status) return status.error();
    }
    for (const auto step : {&UrdfCheck::checkTree, &UrdfCheck::checkMimics}) {
      if (const Status status = (this->*step)(); !status) return status.error();
    }
    for (const auto material : robot.children("material")) {
      if (const Status status = checkNumbers(material, "material \"" + nameOf(material) + "\""); !status) {
        return status.error();
      }
    }
    return m_outline;
  }

 private:
  static std::string nameOf(const pugi::xml_node& node) { return node.attribute("name").value(); }

  Error invalidAt(std::size_t offset, const std::string& what) const {
    constexpr std::size_t kLongest = 400;  // Names and values come from the file and may be megabytes.
    return {ErrorCode::kInvalidInput, m_name + ":" + std::to_string(lineOfOffset(m_text, offset)) + ": " +
                                          (what.size() > kLongest ? what.substr(0, kLongest) + "..." : what)};
  }
  Error invalid(const pugi::xml_node& node, const std::string& what) const {
    return invalidAt(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), what);
  }

  Status collectLinks(const pugi::xml_node& robot) {
    for (const auto link : robot.children("link")) {
      const std::string name = nameOf(link);
      if (name.empty()) return invalid(link, "a <link> has no name");
      if (!m_links.insert(name).second) return invalid(link, "two links are named \"" + name + "\"");
      m_outline.links.push_back(name);
      if (const Status status = checkNumbers(link, "link \"" + name + "\""); !status) return status;
      if (const Status status = checkGeometries(link, name); !status) return status;
    }
    if (m_links.empty()) return invalid(robot, "the robot has no link");
    return {};
  }

  Status checkGeometries(const pugi::xml_node& link, const std::string& name) const {
    for (const char* kind : {"visual", "collision"}) {
      for (const auto shape : link.children(kind)) {
        const pugi::xml_node geometry = shape.child("geometry");
        const std::string where = "link \"" + name + "\", <" + kind + ">";
        if (!geometry) return invalid(shape, where + ": no <geometry>");
        if (const Status status = checkGeometry(geometry, where); !status) return status;
      }
    }
    return {};
  }

  Status checkGeometry(const pugi::xml_node& geometry, const std::string& where) const {
    const pugi::xml_node shape = geometry.find_child([](const pugi::xml_node& n) {
      return n.type() == pugi::node_element;
    });
    const std::string kind = shape.name();
    std::vector<const char*> needed;
    if (kind == "box") needed = {"size"};
    if (kind == "cylinder") needed = {"radius", "length"};
    if (kind == "sphere") needed = {"radius"};
    if (kind == "mesh") needed = {"filename"};
    if (needed.empty()) {
      return invalid(geometry, where + ": <geometry> holds \"" + kind +
                                   "\"; expected box, cylinder, sphere or mesh");
    }
    for (const char* attribute : needed) {
      if (shape.attribute(attribute).empty()) {
        return invalid(shape, where + ": <" + kind + "> has no " + attribute);
      }
    }
    return {};
  }

  Status collectJoints(const pugi::xml_node& robot) {
    std::set<std::string> names;
    for (const auto node : robot.children("joint")) {
      JointOutline joint{nameOf(node),
                         node.attribute("type").value(),
                         node.child("parent").attribute("link").value(),
                         node.child("child").attribute("link").value(),
                         node.child("mimic").attribute("joint").value(),
                         node};
      if (joint.name.empty()) return invalid(node, "a <joint> has no name");
      if (!names.insert(joint.name).second) {
        return invalid(node, "two joints are named \"" + joint.name + "\"");
      }
      if (const Status status = checkJoint(joint); !status) return status;
      m_outline.joints.push_back(joint.name);
      m_joints.push_back(std::move(joint));
    }
    return {};
  }

  Status checkJoint(const JointOutline& joint) {
    const std::string where = "joint \"" + joint.name + "\"";
    if (kJointTypes.count(joint.type) == 0) {
      return invalid(joint.node, where + ": type \"" + joint.type +
                                     "\"; expected fixed, revolute, continuous or prismatic");
    }
    if (joint.type == "floating" || joint.type == "planar") {
      m_outline.warnings.push_back(m_name + ": " + where + " is " + joint.type + "; it is taken as fixed");
    }
    for (const auto& [role, link] : {std::pair{"parent", &joint.parent}, std::pair{"child", &joint.child}}) {
      if (m_links.count(*link) == 0) {
        return invalid(joint.node, where + ": " + role + " link \"" + *link + "\" does not exist");
      }
    }
    if (joint.parent == joint.child) {
      return invalid(joint.node, where + ": parent and child are both \"" + joint.parent + "\"");
    }
    if (const Status status = checkNumbers(joint.node, where); !status) return status;
    return checkMotion(joint, where);
  }

  Status checkMotion(const JointOutline& joint, const std::string& where) const {
    const bool moves = joint.type == "revolute" || joint.type == "continuous" || joint.type == "prismatic";
    if (!moves) return {};
    const pugi::xml_node axis = joint.node.child("axis");
    if (!axis.attribute("xyz").empty()) {
      double norm = 0;
      const auto direction = parseNumbers(axis.attribute("xyz").value()).valueOr({});
      for (const double v : direction) norm = std::max(norm, std::abs(v));
      if (norm < 1e-6) {
        return invalid(axis, where + ": <axis xyz=\"" + axis.attribute("xyz").value() +
                                 "\"> has no direction; expected a vector that is not zero");
      }
    }
    return checkLimits(joint, where);
  }

  Status checkLimits(const JointOutline& joint, const std::string& where) const {
    const pugi::xml_node limit = joint.node.child("limit");
    if (joint.type == "continuous" && !limit) return {};
    if (!limit) {
      return invalid(joint.node, where + ": a " + joint.type + " joint needs <limit lower upper velocity effort>");
    }
    const auto value = [&](const char* name) { return parseNumber(limit.attribute(name).value()).value_or(0); };
    if (joint.type != "continuous" && value("lower") > value("upper")) {
      return invalid(limit, where + ": lower limit " + formatNumber(value("lower")) + " is above upper limit " +
                                formatNumber(value("upper")));
    }
    for (const char* name : {"velocity", "effort"}) {
      if (value(name) < 0) {
        return invalid(limit, where + ": <limit " + name + "=\"" + limit.attribute(name).value() +
                                  "\"> is negative");
      }
    }
    return {};
  }

  /// Every number of `node` and what is below it, by kRules.
  Status checkNumbers(const pugi::xml_node& node, const std::string& where) const {
    for (const auto child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      for (const NumberRule& rule : kRules) {
        if (std::string_view(child.name()) != rule.element) continue;
        if (const Status status = checkAttribute(child, rule, where); !status) return status;
      }
      if (const Status status = checkNumbers(child, where); !status) return status;
    }
    return {};
  }

  Status checkAttribute(const pugi::xml_node& node, const NumberRule& rule, const std::string& where) const {
    const pugi::xml_attribute attribute = node.attribute(rule.attribute);
    if (!attribute) return {};
    const auto numbers = parseNumbers(attribute.value());
    bool good = numbers.ok() && static_cast<int>(numbers->size()) == rule.count;
    for (std::size_t i = 0; good && i < numbers->size(); ++i) {
      good = std::isfinite((*numbers)[i]) && (!rule.positive || (*numbers)[i] > 0);
    }
    if (good) return {};
    return invalid(node, where + ": <" + rule.element + " " + rule.attribute + "=\"" + attribute.value() +
                             "\">: expected " + std::to_string(rule.count) +
                             (rule.positive ? " positive finite number" : " finite number") +
                             (rule.count > 1 ? "s" : ""));
  }

  Status checkTree() const {
    std::map<std::string, const JointOutline*> parent_of;
    for (const auto& joint : m_joints) {
      const auto [found, inserted] = parent_of.emplace(joint.child, &joint);
      if (!inserted) {
        return invalid(joint.node, "link \"" + joint.child + "\" has two parents: joints \"" +
                                       found->second->name + "\" and \"" + joint.name + "\"");
      }
    }
    std::string root;
    for (const auto& link : m_outline.links) {
      if (parent_of.count(link) != 0) continue;
      if (!root.empty()) {
        return Error{ErrorCode::kInvalidInput, m_name + ": links \"" + root + "\" and \"" + link +
                                                   "\" are both without a parent; expected one root"};
      }
      root = link;
    }
    return checkNoLoop(parent_of);
  }

  Status checkNoLoop(const std::map<std::string, const JointOutline*>& parent_of) const {
    std::set<std::string> reaches_root;
    for (const auto& link : m_outline.links) {
      std::set<std::string> path;
      std::string at = link;
      for (auto up = parent_of.find(at); up != parent_of.end(); up = parent_of.find(at)) {
        if (reaches_root.count(at) != 0) break;
        if (!path.insert(at).second) {
          return invalid(up->second->node, "link \"" + at + "\" is its own ancestor by joint \"" +
                                               up->second->name + "\": the links form a loop");
        }
        at = up->second->parent;
      }
      reaches_root.insert(path.begin(), path.end());
    }
    return {};
  }

  Status checkMimics() const {
    std::map<std::string, const JointOutline*> by_name;
    for (const auto& joint : m_joints) by_name.emplace(joint.name, &joint);
    for (const auto& joint : m_joints) {
      if (!joint.node.child("mimic")) continue;
      std::set<std::string> seen{joint.name};
      for (const JointOutline* at = &joint; at->node.child("mimic");) {
        const auto next = by_name.find(at->mimic);
        if (next == by_name.end()) {
          return invalid(at->node, "joint \"" + at->name + "\": it mimics \"" + at->mimic +
                                       "\", which does not exist");
        }
        if (!seen.insert(at->mimic).second) {
          return invalid(at->node, "joint \"" + at->name + "\": it mimics itself by way of \"" + at->mimic + "\"");
        }
        at = next->second;
      }
    }
    return {};
  }

  std::string_view m_text;
  const std::string& m_name;
  pugi::xml_document m_document;
  UrdfOutline m_outline;
  std::set<std::string> m_links;
  std::vector<JointOutline> m_joints;
};

}  // namespace

Result<UrdfOutline> checkUrdf(std::string_view text, const std::string& name) {
  return UrdfCheck(text, name).run();
}

}  // namespace longarm::planning::internal
