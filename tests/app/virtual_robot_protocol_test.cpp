#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "app/virtual_robot/camera_rig.h"
#include "app/virtual_robot/virtual_robot.h"
#include "planning/world/workcell.h"
#include "tests/app/virtual_robot_rig.h"
#include "tests/support/fuzz.h"

namespace longarm::virtual_robot {
namespace {

using nlohmann::json;

/// A robot in lockstep and a client that keeps all it was sent.
class Session {
 public:
  explicit Session(RobotOptions options = lockstep()) {
    RobotOutlets outlets;
    outlets.send = [this](const Frame& frame) { m_frames.push_back(frame); };
    outlets.wake = [] {};
    outlets.quit = [this] { m_quit = true; };
    outlets.log = [](const std::string&) {};
    auto robot = VirtualRobot::create(options, outlets);
    EXPECT_TRUE(robot.ok()) << robot.error().message;
    m_robot = std::move(*robot);
    m_robot->protocol().connected();
  }
  static RobotOptions lockstep() {
    RobotOptions options;
    options.lockstep = true;
    options.cameras = false;
    return options;
  }

  VirtualRobot& robot() { return *m_robot; }
  const RobotBody& body() { return m_robot->body(); }
  bool quit() const { return m_quit; }
  void say(const json& operation) { m_robot->protocol().receiveText(operation.dump()); }
  void publish(const std::string& topic, const json& message) {
    say({{"op", "publish"}, {"topic", topic}, {"msg", message}});
  }
  void subscribe(const std::string& topic, int throttle = 0, const std::string& compression = "none") {
    say({{"op", "subscribe"}, {"topic", topic}, {"throttle_rate", throttle}, {"compression", compression}});
  }
  /// The answer of a service.
  json call(const std::string& service, const json& args = json::object()) {
    say({{"op", "call_service"}, {"service", service}, {"args", args}, {"id", "x"}});
    const json answer = json::parse(m_frames.back().bytes);
    EXPECT_EQ(answer["op"], "service_response");
    EXPECT_EQ(answer["id"], "x");
    return answer;
  }
  void step(double seconds) { call("/virtual_robot/step", {{"seconds", seconds}}); }
  /// Steps with heartbeats between.
  void run(double seconds) {
    for (double t = 0; t < seconds - 1e-9; t += 0.05) {
      publish("/longarm/heartbeat", json::object());
      step(0.05);
    }
  }

  std::vector<json> on(const std::string& topic) const {
    std::vector<json> out;
    for (const auto& frame : m_frames) {
      if (frame.binary) continue;
      const json value = json::parse(frame.bytes);
      if (value.value("topic", "") == topic) out.push_back(value["msg"]);
    }
    return out;
  }
  /// Sentences of status operations, joined.
  std::string told() const {
    std::string out;
    for (const auto& frame : m_frames) {
      if (frame.binary) continue;
      const json value = json::parse(frame.bytes);
      if (value["op"] == "status") out += value["level"].get<std::string>() + ": " + value["msg"].get<std::string>() + "\n";
    }
    return out;
  }
  std::string allBytes() const {
    std::string out;
    for (const auto& frame : m_frames) out += frame.bytes;
    return out;
  }
  std::vector<Frame>& frames() { return m_frames; }
  void forget() { m_frames.clear(); }

 private:
  std::vector<Frame> m_frames;
  bool m_quit = false;
  std::unique_ptr<VirtualRobot> m_robot;
};

json trajectory(const Horizon& horizon, double stamp_s = 0) {
  return rosbridge::write(rosbridge::toMessage(horizon, stamp_s)).json();
}

Horizon smallMove(const RobotBody& body, double by, double seconds = 0.5) {
  const Eigen::VectorXd q = body.arm().commandedAt(body.time_s()).positions;
  return quinticTo(body.arm().joints(), q, q + sweep(by), seconds);
}

TEST(VirtualProtocol, SendsJointStatesAHundredTimesASecondOfItsOwnTime) {
  Session s;
  s.subscribe("/joint_states");
  s.step(1.0);
  const auto states = s.on("/joint_states");
  ASSERT_EQ(states.size(), 100u);
  const double first = states[0]["header"]["stamp"]["nsecs"].get<double>() * 1e-9;
  const double second = states[1]["header"]["stamp"]["nsecs"].get<double>() * 1e-9;
  EXPECT_NEAR(second - first, 0.01, 1e-9);
  EXPECT_EQ(states[0]["name"].size(), states[0]["velocity"].size());
}

TEST(VirtualProtocol, TellsWhichWayIsUpAlsoOnASlope) {
  RobotOptions options = Session::lockstep();
  options.scenario = "slope";
  Session s(options);
  s.subscribe("/imu/data");
  s.step(0.5);
  const auto messages = s.on("/imu/data");
  EXPECT_GE(messages.size(), 9u);
  EXPECT_LE(messages.size(), 11u) << "twenty times a second";
  const json& q = messages.back().at("orientation");
  const Eigen::Quaterniond orientation(q.at("w").get<double>(), q.at("x").get<double>(), q.at("y").get<double>(), q.at("z").get<double>());
  const Eigen::Vector3d up = orientation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up - s.body().scenario().up).norm(), 1e-9) << "base_link is the world's frame at the start";
  EXPECT_LT(up.z(), 0.995) << "it stands on a slope";
}

TEST(VirtualProtocol, SendsNothingUnasked) {
  Session s;
  s.robot().protocol().receiveText(R"({"op": "advertise", "topic": "/longarm/heartbeat", "type": "std_msgs/Empty"})");
  s.step(0.2);
  EXPECT_EQ(s.frames().size(), 1u) << "only the answer";
}

TEST(VirtualProtocol, KeepsTheThrottleAndEndsWithUnsubscribe) {
  Session s;
  s.subscribe("/joint_states", 100);
  s.step(1.0);
  EXPECT_EQ(s.on("/joint_states").size(), 10u);
  s.say({{"op", "unsubscribe"}, {"topic", "/joint_states"}});
  s.forget();
  s.step(0.5);
  EXPECT_TRUE(s.on("/joint_states").empty());
}

TEST(VirtualProtocol, WritesForRos2WhenTheTypeIsOfRos2) {
  Session s;
  s.say({{"op", "subscribe"}, {"topic", "/joint_states"}, {"type", "sensor_msgs/msg/JointState"}});
  s.step(0.02);
  EXPECT_TRUE(s.on("/joint_states")[0]["header"]["stamp"].contains("nanosec"));
}

TEST(VirtualProtocol, MovesTheArmByAHorizonAndStopsItByTheTopic) {
  Session s;
  s.run(0.1);
  const double from = s.body().arm().commandedAt(0.1).positions[0];
  s.publish("/arm_controller/joint_trajectory", trajectory(smallMove(s.body(), 0.6, 1.5)));
  s.run(0.7);
  EXPECT_TRUE(s.body().arm().moving(s.body().time_s()));
  s.publish("/arm_controller/stop", json::object());
  s.run(0.2);
  EXPECT_FALSE(s.body().arm().moving(s.body().time_s()));
  const double stopped = s.body().arm().commandedAt(s.body().time_s()).positions[0];
  EXPECT_GT(stopped, from + 0.1);
  EXPECT_LT(stopped, from + 0.5);
  EXPECT_EQ(s.told(), "");
}

TEST(VirtualProtocol, AnswersARefusedHorizonWithAStatusOncePerSecond) {
  Session s;
  s.run(0.1);
  for (int i = 0; i < 10; ++i) {
    auto wrong = smallMove(s.body(), 0.1);
    wrong.points.pop_back();
    s.publish("/arm_controller/joint_trajectory", trajectory(wrong));
  }
  EXPECT_NE(s.told().find("error: the arm refuses a horizon"), std::string::npos);
  const std::string told = s.told();
  EXPECT_EQ(std::count(told.begin(), told.end(), '\n'), 1);
  EXPECT_FALSE(s.body().arm().moving(0.2));
}

TEST(VirtualProtocol, AimsTheHeadAndClosesTheGripper) {
  Session s;
  s.subscribe("/gripper_controller/holding");
  s.publish("/pan_tilt/head/command",
            {{"joint_names", {"head_pan_joint", "head_tilt_joint"}},
             {"points", {{{"positions", {0.4, -0.2}}, {"time_from_start", {{"secs", 0}, {"nsecs", 0}}}}}}});
  s.publish("/gripper_controller/command", {{"data", 0.01}});
  s.run(2);
  EXPECT_NEAR(s.body().trueJoints().at("head_pan_joint"), 0.4, 1e-6);
  EXPECT_NEAR(s.body().trueJoints().at("head_tilt_joint"), -0.2, 1e-6);
  EXPECT_NEAR(s.body().trueJoints().at("gripper_joint"), 0.01, 1e-6);
  EXPECT_EQ(s.on("/gripper_controller/holding").size(), 10u) << "at 5 Hz";
  EXPECT_EQ(s.on("/gripper_controller/holding")[0]["data"], false);
}

TEST(VirtualProtocol, SaysWhatItCannotDo) {
  Session s;
  s.publish("/tail/command", {{"data", 1}});
  s.publish("/gripper_controller/command", {{"data", "wide"}});
  s.publish("/camera/wrist/zoom", {{"data", 0.5}});
  s.publish("/pan_tilt/head/command", {{"joint_names", json::array()}, {"points", json::array()}});
  s.subscribe("/odometry");
  s.subscribe("/camera/head_left/image/compressed");
  s.say({{"op", "dance"}});
  s.robot().protocol().receiveText("{nonsense");
  s.robot().protocol().receiveBinary(std::string("\xff\x00", 2));
  for (const char* part : {"/tail/command", "\"data\" is not a number", "\"wrist\" has no zoom", "0 points", "/odometry",
                           "without cameras", "dance"}) {
    EXPECT_NE(s.told().find(part), std::string::npos) << part << " in\n" << s.told();
  }
}

TEST(VirtualProtocol, AnswersItsServices) {
  Session s;
  const json info = s.call("/virtual_robot/info")["values"];
  EXPECT_EQ(info["scenario"], "grab_pipe");
  EXPECT_EQ(info["cameras"].size(), 5u);
  const json stepped = s.call("/virtual_robot/step", {{"seconds", 0.5}});
  EXPECT_NEAR(stepped["values"]["time"].get<double>(), 0.5, 1e-9);
  const json truth = s.call("/virtual_robot/truth")["values"];
  EXPECT_NEAR(truth["time"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(truth["objects"][0]["name"], "pipe");
  EXPECT_EQ(truth["objects"][0]["pose"]["quaternion_xyzw"].size(), 4u);
  EXPECT_EQ(truth["held"], "");
  EXPECT_EQ(truth["goals"][0]["reached"], false);
  EXPECT_TRUE(truth["links"].contains("tool_tip"));
  EXPECT_TRUE(truth["links"].contains("head_left_optical"));
  EXPECT_EQ(s.call("/virtual_robot/fault", {{"name", "glare"}, {"duration_s", 1}})["values"]["started"], true);
  EXPECT_TRUE(s.body().faults().active("glare"));
  EXPECT_EQ(s.call("/virtual_robot/fault", {{"name", "flood"}})["result"], false);
  EXPECT_EQ(s.call("/virtual_robot/step", {{"seconds", -1}})["result"], false);
  EXPECT_EQ(s.call("/virtual_robot/step", {{"seconds", "soon"}})["result"], false);
  EXPECT_EQ(s.call("/rosapi/topics")["result"], false);
  s.call("/virtual_robot/quit");
  EXPECT_TRUE(s.quit());
}

TEST(VirtualProtocol, RefusesToStepWhenTimeRunsByItself) {
  RobotOptions options = Session::lockstep();
  options.lockstep = false;
  Session s(options);
  EXPECT_EQ(s.call("/virtual_robot/step", {{"seconds", 0.1}})["result"], false);
  s.robot().advanceTo(0.1);
  EXPECT_NEAR(s.body().time_s(), 0.1, 1e-9);
  s.robot().advanceTo(100);
  EXPECT_LE(s.body().time_s(), 0.1 + VirtualRobot::kMostAtOnce_s + 1e-9) << "after a long sleep time goes on";
}

TEST(VirtualProtocol, ACutLinkCarriesNothingEitherWayButAnswersServices) {
  Session s;
  s.subscribe("/joint_states");
  s.call("/virtual_robot/fault", {{"name", "link_cut"}, {"duration_s", 0.4}});
  s.forget();
  s.publish("/gripper_controller/command", {{"data", 0.0}});
  s.step(0.3);
  EXPECT_TRUE(s.on("/joint_states").empty());
  s.step(0.3);
  EXPECT_NEAR(s.on("/joint_states").size(), 20, 2);
  EXPECT_NEAR(s.body().trueJoints().at("gripper_joint"), 0.05, 1e-9) << "the command was lost";
}

TEST(VirtualProtocol, ADelayedLinkCarriesEverythingLater) {
  Session s;
  s.subscribe("/joint_states");
  s.call("/virtual_robot/fault", {{"name", "link_delay"}});
  s.forget();
  s.publish("/gripper_controller/command", {{"data", 0.0}});
  s.step(1.0);
  const auto states = s.on("/joint_states");
  EXPECT_NEAR(states.size(), 70, 2);
  EXPECT_NEAR(states[0]["header"]["stamp"]["nsecs"].get<double>() * 1e-9, 0.01, 0.011) << "stamps stay";
  EXPECT_NEAR(s.body().trueJoints().at("gripper_joint"), 0.0, 1e-3);
  s.call("/virtual_robot/fault", {{"name", "clear"}});
  s.step(0.05);
  EXPECT_NEAR(s.on("/joint_states").size(), 105, 2) << "what was on its way arrives";
}

TEST(VirtualProtocol, ForgetsSubscriptionsButNotTheRobotWhenTheClientGoes) {
  Session s;
  s.subscribe("/joint_states");
  s.run(0.1);
  s.publish("/arm_controller/joint_trajectory", trajectory(smallMove(s.body(), 0.6, 1.5)));
  s.run(0.6);
  s.robot().protocol().disconnected();
  s.robot().protocol().connected();
  s.forget();
  s.step(0.5);
  EXPECT_TRUE(s.on("/joint_states").empty());
  EXPECT_FALSE(s.body().arm().moving(s.body().time_s()));
  EXPECT_GT(armOf(s.body())[0], 0.02) << "it stands where it stopped";
}

TEST(VirtualProtocol, TheSameSeedAndFramesGiveTheSameBytes) {
  const auto play = [](unsigned seed) {
    RobotOptions options = Session::lockstep();
    options.seed = seed;
    Session s(options);
    s.subscribe("/joint_states");
    s.subscribe("/gripper_controller/holding");
    s.run(0.2);
    s.publish("/arm_controller/joint_trajectory", trajectory(smallMove(s.body(), 0.1)));
    s.publish("/gripper_controller/command", {{"data", 0.0}});
    s.run(1.0);
    s.call("/virtual_robot/truth");
    return s.allBytes();
  };
  const std::string first = play(7);
  EXPECT_GT(first.size(), 10000u);
  EXPECT_EQ(first, play(7));
  EXPECT_NE(first, play(8));
}

TEST(VirtualProtocol, PtzCamerasZoomAndSaySo) {
  RobotOptions options = Session::lockstep();
  options.variant = "ptz";
  Session s(options);
  s.subscribe("/camera/ptz_left/zoom_state");
  s.publish("/camera/ptz_left/zoom", {{"data", 0.5}});
  s.step(2);
  const auto states = s.on("/camera/ptz_left/zoom_state");
  ASSERT_GT(states.size(), 20u);
  EXPECT_NEAR(states.back()["data"].get<double>(), 0.5, 1e-6);
  s.publish("/camera/ptz_left/zoom", {{"data", 1.5}});
  EXPECT_NE(s.told().find("1.5"), std::string::npos);
}

TEST(VirtualProtocol, PtzCamerasFocusByHand) {
  RobotOptions options = Session::lockstep();
  options.variant = "ptz";
  Session s(options);
  s.subscribe("/camera/ptz_left/focus_state");
  s.publish("/camera/ptz_left/focus", {{"data", 0.1}});
  s.step(2);
  const auto focus = [&] { return s.on("/camera/ptz_left/focus_state").back()["data"].get<double>(); };
  ASSERT_FALSE(s.on("/camera/ptz_left/focus_state").empty());
  EXPECT_NEAR(focus(), 0.1, 1e-6);
}

TEST(CameraRig, FocusesByItselfOnWhatItsPictureShows) {
  auto rig = CameraRig::load(*planning::loadBuiltInWorkcell("ptz"));
  ASSERT_TRUE(rig.ok()) << rig.error().message;
  ASSERT_TRUE(rig->setFocus("ptz_left", 0.1).ok());
  rig->tick(2);
  rig->see("ptz_left", 5);
  rig->tick(2);
  EXPECT_NEAR(rig->focus("ptz_left"), 0.1, 1e-6) << "set by hand it stays";
  ASSERT_TRUE(rig->setFocus("ptz_left", -1).ok());
  rig->see("ptz_left", 5);
  rig->tick(2);
  EXPECT_GT(rig->focus("ptz_left"), 0.8);
  EXPECT_LT(rig->blur_px("ptz_left", 5), 0.2);
}

TEST(VirtualProtocol, SurvivesThousandsOfDamagedFrames) {
  Session s;
  s.subscribe("/joint_states");
  const std::vector<std::string> good = {
      json{{"op", "publish"}, {"topic", "/arm_controller/joint_trajectory"}, {"msg", trajectory(smallMove(s.body(), 0.02))}}.dump(),
      R"({"op": "publish", "topic": "/gripper_controller/command", "msg": {"data": 0.02}})",
      R"({"op": "publish", "topic": "/pan_tilt/head/command", "msg": {"joint_names": ["head_pan_joint", "head_tilt_joint"],
          "points": [{"positions": [0.1, 0.2], "time_from_start": {"secs": 0, "nsecs": 0}}]}})",
      R"({"op": "subscribe", "topic": "/joint_states", "throttle_rate": 10, "id": "a"})",
      R"({"op": "call_service", "service": "/virtual_robot/fault", "args": {"name": "glare", "duration_s": 0.1}})",
      R"({"op": "publish", "topic": "/longarm/heartbeat", "msg": {}})"};
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const std::string frame = tests::mutate(good[i % good.size()], i);
    s.robot().protocol().receiveText(frame);
    s.robot().protocol().receiveBinary(frame);
    if (i % 50 == 0) s.step(0.01);
    if (s.frames().size() > 5000) s.forget();
  }
  for (const auto& [name, value] : s.body().trueJoints()) EXPECT_TRUE(std::isfinite(value)) << name;
  s.call("/virtual_robot/fault", {{"name", "clear"}});
  s.say({{"op", "unsubscribe"}, {"topic", "/joint_states"}});
  s.step(0.5);
  s.subscribe("/joint_states");
  s.forget();
  s.step(0.1);
  EXPECT_EQ(s.on("/joint_states").size(), 10u) << "it still serves";
}

}  // namespace
}  // namespace longarm::virtual_robot
