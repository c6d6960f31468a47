#include "app/virtual_robot/robot_protocol.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

namespace longarm::virtual_robot {
namespace {

constexpr double kRepeat_s = 1.0;        // of the same sentence
constexpr double kStatePeriod_s = 0.2;   // of states that are published on change
constexpr std::size_t kMaxTold = 64;
constexpr std::size_t kMaxDelayed = 4096;
constexpr const char* kJoints = "/joint_states";
constexpr const char* kHolding = "/gripper_controller/holding";
constexpr const char* kDrive = "/cmd_vel";
constexpr const char* kOdometry = "/odom";
constexpr const char* kImu = "/imu/data";
constexpr double kImuPeriod_s = 0.05;

// "NAME" of "<before>NAME<after>", or nothing.
std::optional<std::string> between(const std::string& topic, const std::string& before, const std::string& after) {
  if (topic.size() <= before.size() + after.size() || topic.rfind(before, 0) != 0) return {};
  if (topic.compare(topic.size() - after.size(), after.size(), after) != 0) return {};
  return topic.substr(before.size(), topic.size() - before.size() - after.size());
}

std::string imageTopic(const std::string& camera) { return "/camera/" + camera + "/image/compressed"; }
std::string infoTopic(const std::string& camera) { return "/camera/" + camera + "/camera_info"; }
std::string zoomTopic(const std::string& camera) { return "/camera/" + camera + "/zoom_state"; }
std::string focusTopic(const std::string& camera) { return "/camera/" + camera + "/focus_state"; }

rosbridge::CameraInfoMessage infoMessage(const Picture& picture, const std::string& frame) {
  const vision::CameraModel& lens = picture.lens;
  rosbridge::CameraInfoMessage out;
  out.header.stamp_s = picture.time_s;
  out.header.frame_id = frame;
  out.width = static_cast<std::uint32_t>(lens.width);
  out.height = static_cast<std::uint32_t>(lens.height);
  out.d.assign(lens.distortion.begin(), lens.distortion.end());
  out.k = {lens.fx, lens.skew, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1};
  out.p = {lens.fx, 0, lens.cx, 0, 0, lens.fy, lens.cy, 0, 0, 0, 1, 0};
  return out;
}

Error unknownTopic(const std::string& topic) {
  return {ErrorCode::kNotFound, "this robot takes nothing on topic \"" + topic + "\""};
}

}  // namespace

RobotProtocol::RobotProtocol(RobotBody& body, CameraRig& rig, RobotServices& services, bool cameras,
                             std::function<void(Frame)> send)
    : m_body(body), m_rig(rig), m_services(services), m_cameras(cameras), m_send(std::move(send)) {}

void RobotProtocol::connected() { m_connected = true; }

void RobotProtocol::disconnected() {
  m_connected = false;
  m_subscriptions.clear();
  m_outgoing.clear();
  m_incoming.clear();
  m_told.clear();
  updateCameras();
  m_body.clientLost();
}

void RobotProtocol::receiveText(std::string_view frame) { receive(rosbridge::decodeText(frame)); }

void RobotProtocol::receiveBinary(std::string_view frame) { receive(rosbridge::decodeBinary(frame)); }

void RobotProtocol::receive(const Result<rosbridge::Operation>& operation) {
  if (!operation) {
    tell("error", operation.error().message);
    return;
  }
  if (const auto* call = std::get_if<rosbridge::CallService>(&*operation)) {
    send({false, rosbridge::encodeText(m_services.call(*call))}, false);
    return;
  }
  if (m_body.faults().active("link_cut")) return;
  if (m_body.faults().active("link_delay") || !m_incoming.empty()) {
    if (m_incoming.size() < kMaxDelayed) m_incoming.push_back({m_body.time_s() + kDelay_s, *operation});
    return;
  }
  act(*operation);
}

void RobotProtocol::act(const rosbridge::Operation& operation) {
  if (const auto* message = std::get_if<rosbridge::Publish>(&operation)) {
    act(*message);
  } else if (const auto* wish = std::get_if<rosbridge::Subscribe>(&operation)) {
    subscribe(*wish);
  } else if (const auto* end = std::get_if<rosbridge::Unsubscribe>(&operation)) {
    m_subscriptions.remove(*end);
    updateCameras();
  } else if (std::holds_alternative<rosbridge::ServiceResponse>(operation)) {
    tell("warning", "a service response came although no service was called");
  }
}

void RobotProtocol::act(const rosbridge::Publish& message) {
  if (auto status = command(message); !status) tell("error", status.error().message);
}

Status RobotProtocol::command(const rosbridge::Publish& message) {
  const std::string& topic = message.topic;
  if (topic == "/longarm/heartbeat") {
    m_body.heartbeat();
    return {};
  }
  if (topic == "/arm_controller/joint_trajectory") return followHorizon(message.message);
  if (topic == "/arm_controller/stop") {
    m_body.stop();
    return {};
  }
  if (topic == kDrive) {
    const auto read = rosbridge::readAs<rosbridge::TwistMessage>(message.message);
    const auto twist = read ? rosbridge::toTwist(*read) : Result<BaseTwist>(read.error());
    return twist ? m_body.drive(*twist) : Status(twist.error());
  }
  if (const auto name = between(topic, "/pan_tilt/", "/command")) return aim(*name, message.message);
  const auto zoomed = between(topic, "/camera/", "/zoom"), focused = between(topic, "/camera/", "/focus");
  if (topic != "/gripper_controller/command" && !zoomed && !focused) return unknownTopic(topic);
  const auto value = rosbridge::readAs<rosbridge::Float64Message>(message.message);
  if (!value) return value.error();
  if (focused) return m_rig.setFocus(*focused, value->data);
  return zoomed ? m_rig.setZoom(*zoomed, value->data) : m_body.moveGripper(value->data);
}

Status RobotProtocol::followHorizon(const rosbridge::Body& message) {
  const auto trajectory = rosbridge::readAs<rosbridge::JointTrajectoryMessage>(message);
  if (!trajectory) return trajectory.error();
  const auto horizon = rosbridge::toHorizon(*trajectory);
  return horizon ? m_body.follow(*horizon) : Status(horizon.error());
}

Status RobotProtocol::aim(const std::string& pan_tilt, const rosbridge::Body& message) {
  const auto trajectory = rosbridge::readAs<rosbridge::JointTrajectoryMessage>(message);
  if (!trajectory) return trajectory.error();
  const auto path = rosbridge::toHorizon(*trajectory);
  if (!path) return path.error();
  if (path->points.size() != 1) {
    return {ErrorCode::kInvalidInput, "a command of pan-tilt \"" + pan_tilt + "\" has " +
                                          std::to_string(path->points.size()) + " points; expected 1"};
  }
  std::map<std::string, double> joints;
  for (std::size_t i = 0; i < path->joint_names.size(); ++i) {
    joints[path->joint_names[i]] = path->points.front().positions[static_cast<Eigen::Index>(i)];
  }
  return m_body.aim(pan_tilt, joints);
}

void RobotProtocol::subscribe(const rosbridge::Subscribe& wish) {
  std::set<std::string> known = {kJoints, kHolding};
  if (m_body.base() != nullptr) known.insert(kOdometry);
  if (m_body.workcell().imu) known.insert(kImu);
  for (const auto& camera : m_rig.names()) {
    known.insert({imageTopic(camera), infoTopic(camera)});
    if (m_rig.zooms(camera)) known.insert({zoomTopic(camera), focusTopic(camera)});
  }
  if (known.count(wish.topic) == 0) {
    tell("warning", "this robot publishes nothing on topic \"" + wish.topic + "\"");
    return;
  }
  if (wish.compression != "none" && wish.compression != "cbor" && !wish.compression.empty()) {
    tell("warning", "compression \"" + wish.compression + "\" is not known; \"none\" is used on " + wish.topic);
  }
  if (!m_cameras && between(wish.topic, "/camera/", "/image/compressed")) {
    tell("warning", "this robot runs without cameras; nothing will come on " + wish.topic);
  }
  m_subscriptions.add(wish);
  m_published_s.erase(wish.topic);       // a state comes at once
  updateCameras();
}

void RobotProtocol::updateCameras() {
  for (const auto& camera : m_rig.names()) {
    const bool on = m_cameras && m_subscriptions.wanted(imageTopic(camera));
    m_rig.want(camera, on, on ? m_subscriptions.period_s(imageTopic(camera)) : 0);
  }
}

template <typename Message>
void RobotProtocol::publish(const std::string& topic, const Message& message) {
  const auto delivery = m_subscriptions.take(topic, m_body.time_s());
  if (!delivery) return;
  const auto operation = rosbridge::publish(topic, message, delivery->dialect);
  send(delivery->cbor ? Frame{true, rosbridge::encodeBinary(operation)}
                      : Frame{false, rosbridge::encodeText(operation)},
       true);
}

void RobotProtocol::publish(const Picture& picture) {
  rosbridge::CompressedImageMessage message;
  message.header.stamp_s = picture.time_s;
  message.header.frame_id = m_body.workcell().camera(picture.camera)->link;
  message.format = "jpeg";
  message.data = picture.jpeg;
  publish(imageTopic(picture.camera), message);
  publish(infoTopic(picture.camera), infoMessage(picture, message.header.frame_id));
}

void RobotProtocol::publishStates() {
  const double now_s = m_body.time_s();
  const auto due = [&](const std::string& topic, double value) {
    const auto before = m_published_s.find(topic);
    const bool due_now = before == m_published_s.end() || m_published[topic] != value ||
                         now_s - before->second >= kStatePeriod_s - 1e-9;
    if (!due_now || !m_subscriptions.wanted(topic)) return false;
    m_published[topic] = value;
    m_published_s[topic] = now_s;
    return true;
  };
  if (due(kHolding, m_body.holding() ? 1 : 0)) publish(kHolding, rosbridge::BoolMessage{m_body.holding()});
  for (const auto& camera : m_rig.names()) {
    if (!m_rig.zooms(camera)) continue;
    const double zoom = m_rig.zoom(camera), focus = m_rig.focus(camera);
    if (due(zoomTopic(camera), zoom)) publish(zoomTopic(camera), rosbridge::Float64Message{zoom});
    if (due(focusTopic(camera), focus)) publish(focusTopic(camera), rosbridge::Float64Message{focus});
  }
}

void RobotProtocol::afterTick() {
  flushDelayed();
  if (!m_connected || !m_body.readingIsNew()) return;
  publish(kJoints, rosbridge::toMessage(m_body.measured(), m_body.measured().stamp_s));
  if (m_body.base() != nullptr)
    publish(kOdometry, rosbridge::toMessage(m_body.base()->odometry(), m_body.time_s()));
  publishAttitude();
  publishStates();
}

void RobotProtocol::publishAttitude() {
  const auto attitude = m_body.attitude();
  const auto before = m_published_s.find(kImu);
  if (!attitude || (before != m_published_s.end() && m_body.time_s() - before->second < kImuPeriod_s - 1e-9)) return;
  m_published_s[kImu] = m_body.time_s();
  publish(kImu, rosbridge::toMessage(*attitude, attitude->stamp_s, m_body.workcell().imu->link));
}

void RobotProtocol::tell(const std::string& level, const std::string& text) {
  const double now_s = m_body.time_s();
  std::string key;                       // the sentence without its numbers
  std::copy_if(text.begin(), text.end(), std::back_inserter(key), [](unsigned char c) { return std::isdigit(c) == 0; });
  const auto before = m_told.find(key);
  if (before != m_told.end() && now_s - before->second < kRepeat_s) return;
  if (m_told.size() >= kMaxTold) m_told.clear();
  m_told[key] = now_s;
  send({false, rosbridge::encodeText(rosbridge::StatusReport{level, text, {}})}, true);
}

void RobotProtocol::send(Frame frame, bool delayed) {
  if (!m_connected) return;
  if (!delayed) {
    m_send(std::move(frame));
    return;
  }
  if (m_body.faults().active("link_cut")) return;
  if (m_body.faults().active("link_delay") || !m_outgoing.empty()) {
    if (m_outgoing.size() < kMaxDelayed) m_outgoing.emplace_back(m_body.time_s() + kDelay_s, std::move(frame));
    return;
  }
  m_send(std::move(frame));
}

void RobotProtocol::flushDelayed() {
  const double now_s = m_body.faults().active("link_delay") ? m_body.time_s() : 1e12;
  while (!m_outgoing.empty() && m_outgoing.front().first <= now_s) {
    Frame frame = std::move(m_outgoing.front().second);
    m_outgoing.pop_front();
    m_send(std::move(frame));
  }
  while (!m_incoming.empty() && m_incoming.front().due_s <= now_s) {
    const rosbridge::Operation operation = std::move(m_incoming.front().operation);
    m_incoming.pop_front();
    act(operation);
  }
}

}  // namespace longarm::virtual_robot
