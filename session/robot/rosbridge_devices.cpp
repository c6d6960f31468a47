#include "session/robot/rosbridge_devices.h"

#include <utility>

#include "hardware/drivers/rosbridge/rosbridge_arm.h"
#include "hardware/drivers/rosbridge/rosbridge_base.h"
#include "hardware/drivers/rosbridge/rosbridge_camera.h"
#include "hardware/drivers/rosbridge/rosbridge_gripper.h"
#include "hardware/drivers/rosbridge/rosbridge_imu.h"
#include "hardware/drivers/rosbridge/rosbridge_pan_tilt.h"

namespace longarm::session {
namespace {

using hardware::RosbridgeRobot;
using hardware::TopicNames;

// The server's answer to a service, as the session wants it: JSON text both ways.
ServiceCall serviceCall(std::shared_ptr<hardware::Connection> link) {
  return [link](const std::string& service, const std::string& arguments, double timeout_s) -> Result<std::string> {
    const auto body = rosbridge::Body::parse(arguments);
    if (!body) return Error{body.error().code, "arguments of " + service + ": " + body.error().message};
    const auto answer = link->call(service, *body, timeout_s);
    if (!answer) return answer.error();
    return answer->text();
  };
}

Result<hardware::PanTiltSettings::Axis> axisOf(const planning::Workcell& workcell, const std::string& joint) {
  if (!workcell.model) return Error{ErrorCode::kInvalidInput, "the workcell has no robot"};
  const auto index = workcell.model->jointIndex(joint);
  if (!index) return index.error();
  const auto& found = workcell.model->joints()[static_cast<std::size_t>(*index)];
  return hardware::PanTiltSettings::Axis{joint, found.lower, found.upper};
}

Status checkBackend(const planning::Workcell& workcell, const std::string& url) {
  if (workcell.backend.driver != "rosbridge") {
    return {ErrorCode::kInvalidInput, workcell.path + ": backend.driver: \"" + workcell.backend.driver +
                                          "\" is not known; this build has \"rosbridge\""};
  }
  if (url.rfind("ws://", 0) != 0 || url.size() < 8) {
    return {ErrorCode::kInvalidInput,
            workcell.path + ": backend.url: \"" + url + "\" is no address; expected ws://HOST:PORT"};
  }
  return {};
}

Status addPanTilts(const planning::Workcell& workcell, const RosbridgeRobot& robot, const TopicNames& topics,
                   DeviceSet& set) {
  for (const auto& spec : workcell.pan_tilts) {
    const auto pan = axisOf(workcell, spec.pan_joint), tilt = axisOf(workcell, spec.tilt_joint);
    if (!pan) return pan.error();
    if (!tilt) return tilt.error();
    set.pan_tilts[spec.name] = std::make_shared<hardware::RosbridgePanTilt>(
        spec.name, robot, hardware::PanTiltSettings{*pan, *tilt}, topics);
  }
  return {};
}

}  // namespace

Result<DeviceSet> makeRosbridgeDevices(const planning::Workcell& workcell, const std::string& url,
                                       const Clock& clock) {
  if (auto status = checkBackend(workcell, url); !status) return status.error();
  const TopicNames topics(workcell.backend.topics);
  DeviceSet set;
  set.alive_until_s = std::make_shared<std::atomic<double>>(0);
  hardware::ConnectionSettings settings;
  settings.url = url;
  settings.heartbeat_topic = topics.heartbeat();
  settings.alive_until_s = set.alive_until_s;
  RosbridgeRobot robot;
  robot.link = std::make_shared<hardware::Connection>(std::move(settings), clock);
  robot.state = std::make_shared<hardware::RobotState>(robot.link, topics.jointStates());
  robot.clock = &clock;
  set.arm = std::make_shared<hardware::RosbridgeArm>("arm", robot, topics);
  if (workcell.base)
    set.base = std::make_shared<hardware::RosbridgeBase>("base", robot, *workcell.base, topics);
  if (workcell.imu) {
    const auto& topic = workcell.imu->topic;
    set.imu = std::make_shared<hardware::RosbridgeImu>("imu", robot, topic.empty() ? topics.imu() : topic);
  }
  if (workcell.gripper) {
    const auto& spec = *workcell.gripper;
    set.gripper = std::make_shared<hardware::RosbridgeGripper>(
        spec.device.empty() ? "gripper" : spec.device, robot,
        hardware::GripperSettings{spec.joint, spec.closed, spec.open}, topics);
  }
  if (auto status = addPanTilts(workcell, robot, topics, set); !status) return status.error();
  for (const auto& spec : workcell.cameras) {
    hardware::CameraSettings camera;
    camera.zooms = spec.zooms;
    set.cameras[spec.name] = std::make_shared<hardware::RosbridgeCamera>(spec.name, robot, camera, topics);
  }
  set.call_service = serviceCall(robot.link);
  return set;
}

}  // namespace longarm::session
