#include "app/virtual_robot/robot_services.h"

#include <unistd.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "core/text.h"

namespace longarm::virtual_robot {
namespace {

using nlohmann::json;

constexpr double kLongestStep_s = 60;

json poseJson(const Pose& X_WO) {
  const Eigen::Vector3d p = X_WO.translation();
  const Eigen::Vector4d q = quaternionXyzw(X_WO.linear());
  return {{"parent", "world"}, {"xyz", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q[0], q[1], q[2], q[3]}}};
}

json contactsJson(const RobotBody& body) {
  json out = json::array();
  for (const auto& c : body.contacts().contacts()) out.push_back({{"a", c.a}, {"b", c.b}, {"time", c.time_s}});
  return out;
}

json goalsJson(const RobotBody& body) {
  json out = json::array();
  for (const auto& state : body.goals()) {
    out.push_back({{"kind", state.goal.kind}, {"object", state.goal.object}, {"reached", state.reached}});
  }
  return out;
}

json linksJson(const RobotBody& body, const CameraRig& rig) {
  json out = {{body.workcell().arm.tip_link, poseJson(body.X_WT())}};
  const auto snapshot = body.snapshot();
  for (const auto& camera : body.workcell().cameras) {
    const auto pose = snapshot.X_WC.find(camera.name);
    if (pose != snapshot.X_WC.end()) out[camera.link] = poseJson(pose->second * rig.mount(camera.name));
  }
  return out;
}

Error wrong(const std::string& what) { return {ErrorCode::kInvalidInput, what}; }

Result<double> numberOf(const rosbridge::Body& args, const char* key, double fallback) {
  const json& values = args.json();
  if (!values.is_object() || !values.contains(key) || values[key].is_null()) return fallback;
  if (!values[key].is_number()) return wrong(std::string("\"") + key + "\" is not a number");
  return values[key].get<double>();
}

Result<std::string> textOf(const rosbridge::Body& args, const char* key) {
  const json& values = args.json();
  if (!values.is_object() || !values.contains(key) || values[key].is_null()) return std::string();
  if (!values[key].is_string()) return wrong(std::string("\"") + key + "\" is not text");
  return values[key].get<std::string>();
}

}  // namespace

RobotServices::RobotServices(RobotBody& body, const CameraRig& rig, std::function<void(double)> advance,
                             std::function<void()> quit)
    : m_body(body), m_rig(rig), m_advance(std::move(advance)), m_quit(std::move(quit)) {}

RobotServices::Answer RobotServices::info() const {
  return rosbridge::Body(json{{"scenario", m_body.scenario().name},
                              {"variant", m_body.scenario().variant},
                              {"seed", m_body.seed()},
                              {"cameras", m_rig.names()},
                              {"pid", static_cast<int>(getpid())},
                              {"time", m_body.time_s()}});
}

RobotServices::Answer RobotServices::truth() const {
  json objects = json::array();
  for (const auto& object : m_body.world().objects()) {
    objects.push_back({{"name", object.body.name}, {"pose", poseJson(object.body.X_WO)}});
  }
  json mechanisms = json::object();
  for (const auto& mechanism : m_body.world().mechanisms()) mechanisms[mechanism.spec().name] = mechanism.value();
  return rosbridge::Body(json{{"time", m_body.time_s()},
                              {"base", poseJson(m_body.X_WB())},
                              {"mechanisms", mechanisms},
                              {"joints", m_body.trueJoints()},
                              {"objects", objects},
                              {"held", m_body.world().heldName()},
                              {"contacts", contactsJson(m_body)},
                              {"goals", goalsJson(m_body)},
                              {"links", linksJson(m_body, m_rig)}});
}

RobotServices::Answer RobotServices::step(const rosbridge::Body& args) {
  if (!m_advance) return Error{ErrorCode::kRefused, "time runs by itself; start the robot with --lockstep to step it"};
  const auto seconds = numberOf(args, "seconds", 0.02);
  if (!seconds) return seconds.error();
  if (!(*seconds > 0 && *seconds <= kLongestStep_s)) {
    return wrong("a step of " + formatNumber(*seconds) + " s is not within 0 ... " + formatNumber(kLongestStep_s) +
                 " s");
  }
  m_advance(*seconds);
  return rosbridge::Body(json{{"time", m_body.time_s()}});
}

RobotServices::Answer RobotServices::fault(const rosbridge::Body& args) {
  const auto name = textOf(args, "name");
  if (!name) return name.error();
  const auto target = textOf(args, "target");
  if (!target) return target.error();
  const auto duration = numberOf(args, "duration_s", 0);
  if (!duration) return duration.error();
  if (!(*duration >= 0)) return wrong("\"duration_s\" is negative");
  if (auto status = m_body.faults().start(*name, m_body.time_s(), *duration, *target); !status) return status.error();
  return rosbridge::Body(json{{"started", true}});
}

rosbridge::ServiceResponse RobotServices::call(const rosbridge::CallService& call) {
  const auto answer = [&]() -> Answer {
    if (call.service == "/virtual_robot/info") return info();
    if (call.service == "/virtual_robot/truth") return truth();
    if (call.service == "/virtual_robot/step") return step(call.args);
    if (call.service == "/virtual_robot/fault") return fault(call.args);
    if (call.service == "/virtual_robot/quit") {
      m_quit();
      return rosbridge::Body();
    }
    return Error{ErrorCode::kNotFound, "there is no service \"" + call.service + "\""};
  }();
  if (answer) return {call.service, *answer, true, call.id};
  return {call.service, rosbridge::Body(json{{"error", answer.error().message}}), false, call.id};
}

}  // namespace longarm::virtual_robot
