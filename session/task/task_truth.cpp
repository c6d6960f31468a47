#include "session/task/task_truth.h"

#include <exception>

#include <nlohmann/json.hpp>

namespace longarm::session {
namespace {

using Json = nlohmann::json;

Pose poseOf(const Json& json) {
  const auto& xyz = json.at("xyz");
  const auto& q = json.at("quaternion_xyzw");
  return poseFrom({xyz.at(0).get<double>(), xyz.at(1).get<double>(), xyz.at(2).get<double>()},
                  {q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>()});
}

}  // namespace

Result<TaskTruth> parseTruth(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    TaskTruth out;
    out.time_s = json.at("time").get<double>();
    out.joints = json.at("joints").get<std::map<std::string, double>>();
    for (const auto& object : json.at("objects")) {
      out.objects[object.at("name").get<std::string>()] = poseOf(object.at("pose"));
    }
    out.held = json.at("held").get<std::string>();
    for (const auto& c : json.at("contacts")) {
      out.contacts.push_back({c.at("a").get<std::string>(), c.at("b").get<std::string>(), c.at("time").get<double>()});
    }
    for (const auto& g : json.at("goals")) {
      out.goals.push_back({g.at("kind").get<std::string>(), g.at("object").get<std::string>(), g.at("reached").get<bool>()});
    }
    for (const auto& [name, pose] : json.at("links").items()) out.links[name] = poseOf(pose);
    return out;
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInvalidInput, std::string("the answer of /virtual_robot/truth: ") + e.what()};
  }
}

}  // namespace longarm::session
