#include "planning/robot/srdf_file.h"

#include <algorithm>
#include <cmath>

#include <pugixml.hpp>

#include "core/text.h"
#include "planning/robot/xml_bounds.h"

namespace longarm::planning::internal {
namespace {

class SrdfParser {
 public:
  SrdfParser(std::string_view text, const std::string& name) : m_text(text), m_name(name) {}

  Result<SrdfContent> run() {
    const auto parsed = m_document.load_buffer(m_text.data(), m_text.size());
    if (!parsed) return invalidAt(parsed.offset, std::string("not well-formed XML: ") + parsed.description());
    const pugi::xml_node robot = m_document.child("robot");
    if (!robot) return Error{ErrorCode::kInvalidInput, m_name + ": no <robot> element; expected an SRDF"};
    m_content.robot = robot.attribute("name").value();
    for (const auto step : {&SrdfParser::readGroups, &SrdfParser::readStates, &SrdfParser::readPairs}) {
      if (const Status status = (this->*step)(robot); !status) return status.error();
    }
    return m_content;
  }

 private:
  Error invalidAt(std::ptrdiff_t offset, const std::string& what) const {
    const auto line = lineOfOffset(m_text, static_cast<std::size_t>(std::max<std::ptrdiff_t>(offset, 0)));
    return {ErrorCode::kInvalidInput, m_name + ":" + std::to_string(line) + ": " + what.substr(0, 400)};
  }

  /// An attribute that must be there.
  Result<std::string> text(const pugi::xml_node& node, const char* attribute) const {
    const std::string value = node.attribute(attribute).value();
    if (!value.empty()) return value;
    return invalidAt(node.offset_debug(), std::string("<") + node.name() + "> has no " + attribute);
  }

  Status readGroups(const pugi::xml_node& robot) {
    for (const auto node : robot.children("group")) {
      const auto name = text(node, "name");
      if (!name) return name.error();
      SrdfGroup group{*name, {}, {}, {}, {}};
      if (const auto chain = node.child("chain")) {
        const auto base = text(chain, "base_link");
        if (!base) return base.error();
        const auto tip = text(chain, "tip_link");
        if (!tip) return tip.error();
        group.base_link = *base;
        group.tip_link = *tip;
      }
      for (const auto joint : node.children("joint")) group.joints.emplace_back(joint.attribute("name").value());
      for (const auto link : node.children("link")) group.links.emplace_back(link.attribute("name").value());
      m_content.groups.push_back(std::move(group));
    }
    return {};
  }

  Status readStates(const pugi::xml_node& robot) {
    for (const auto node : robot.children("group_state")) {
      const auto name = text(node, "name");
      if (!name) return name.error();
      auto& state = m_content.states[*name];
      for (const auto joint : node.children("joint")) {
        const auto joint_name = text(joint, "name");
        if (!joint_name) return joint_name.error();
        const auto value = parseNumber(joint.attribute("value").value());
        if (!value || !std::isfinite(*value)) {
          return invalidAt(joint.offset_debug(), "group_state \"" + *name + "\", joint \"" + *joint_name +
                                                     "\": value=\"" + joint.attribute("value").value() +
                                                     "\"; expected one finite number");
        }
        state[*joint_name] = *value;
      }
    }
    return {};
  }

  Status readPairs(const pugi::xml_node& robot) {
    for (const auto node : robot.children("disable_collisions")) {
      const auto a = text(node, "link1");
      if (!a) return a.error();
      const auto b = text(node, "link2");
      if (!b) return b.error();
      m_content.allowed_pairs.emplace_back(*a, *b);
    }
    return {};
  }

  std::string_view m_text;
  const std::string& m_name;
  pugi::xml_document m_document;
  SrdfContent m_content;
};

}  // namespace

Result<SrdfContent> parseSrdf(std::string_view text, const std::string& name) {
  return SrdfParser(text, name).run();
}

}  // namespace longarm::planning::internal
