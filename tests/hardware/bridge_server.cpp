#include "tests/hardware/bridge_server.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include <QThread>
#include <QTimer>
#include <QWebSocket>
#include <QWebSocketServer>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hardware/drivers/rosbridge/socket_worker.h"

namespace longarm::hardware::tests {
namespace {

constexpr double kSilent_s = 0.25;
const std::string kPicture = "\xff\xd8 a picture";

Eigen::VectorXd vector(std::initializer_list<double> values) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double v : values) out[i++] = v;
  return out;
}

}  // namespace

bool eventually(const std::function<bool()>& condition, double timeout_s) {
  const SteadyClock clock;
  for (const double end = clock.now_s() + timeout_s; clock.now_s() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return condition();
}

struct BridgeServer::Socket {
  QObject context;
  std::unique_ptr<QWebSocketServer> server;
  std::unique_ptr<QTimer> timer;
  std::vector<QWebSocket*> clients;
  int port = 0;
};

BridgeServer::BridgeServer(BridgeOptions options)
    : m_options(options), m_clock(options.lockstep ? static_cast<const Clock&>(m_manual) : m_steady) {
  ensureApplication();
  m_arm = std::make_unique<SimulatedArm>("robot", std::vector<std::string>{"joint_1", "joint_2", "joint_3"},
                                         vector({0, 0, 0}), vector({12, 12, 12}), m_clock);
  m_gripper = std::make_unique<SimulatedGripper>("robot gripper", 0.0, 0.05, 0.1, m_clock);
  m_pan_tilt = std::make_unique<SimulatedPanTilt>("robot head", 1.5, 1.0, m_clock);
  m_base = std::make_unique<SimulatedBase>("base", BaseLimits(), m_clock);
  m_imu = std::make_unique<SimulatedImu>("imu", m_clock);
  (void)m_arm->open();
  for (Device* device : {static_cast<Device*>(m_gripper.get()), static_cast<Device*>(m_pan_tilt.get()),
                         static_cast<Device*>(m_base.get())}) {
    (void)device->open();
    (void)device->activate();
  }
  m_thread = std::make_unique<QThread>();
  m_socket = std::make_unique<Socket>();
  m_socket->context.moveToThread(m_thread.get());
  m_thread->start();
  run([this] {
    m_socket->server = std::make_unique<QWebSocketServer>(QStringLiteral("robot"), QWebSocketServer::NonSecureMode);
    EXPECT_TRUE(m_socket->server->listen(QHostAddress::LocalHost, static_cast<quint16>(m_options.port)));
    m_socket->port = m_socket->server->serverPort();
    QObject::connect(m_socket->server.get(), &QWebSocketServer::newConnection, &m_socket->context, [this] {
      auto* client = m_socket->server->nextPendingConnection();
      m_socket->clients.push_back(client);
      m_clients = static_cast<int>(m_socket->clients.size());
      QObject::connect(client, &QWebSocket::textMessageReceived, &m_socket->context,
                       [this](const QString& text) { take(text.toStdString()); });
      QObject::connect(client, &QWebSocket::disconnected, &m_socket->context, [this, client] {
        auto& all = m_socket->clients;
        all.erase(std::remove(all.begin(), all.end(), client), all.end());
        m_clients = static_cast<int>(all.size());
        client->deleteLater();
        std::lock_guard<std::mutex> lock(m_mutex);
        m_subscriptions.clear();
      });
    });
    m_socket->timer = std::make_unique<QTimer>();
    QObject::connect(m_socket->timer.get(), &QTimer::timeout, &m_socket->context, [this] { turn(); });
    if (!m_options.lockstep) m_socket->timer->start(10);
  });
}

BridgeServer::~BridgeServer() {
  run([this] {
    m_socket->timer.reset();
    for (auto* client : std::exchange(m_socket->clients, {})) {
      client->disconnect();
      delete client;
    }
    m_socket->server.reset();
  });
  m_thread->quit();
  m_thread->wait();
}

void BridgeServer::run(const std::function<void()>& task) {
  QMetaObject::invokeMethod(&m_socket->context, task, Qt::BlockingQueuedConnection);
}

std::string BridgeServer::url() const { return "ws://127.0.0.1:" + std::to_string(port()); }
int BridgeServer::port() const { return m_socket->port; }

void BridgeServer::turn() {
  bool silent = false;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    silent = m_clock.now_s() - m_heard_s > kSilent_s;
  }
  if (silent && m_arm->state() == DeviceState::kActive) m_arm->stop();
  if (!m_quiet) publishAll();
}

rosbridge::JointStateMessage BridgeServer::jointStates() const {
  JointState state = *m_arm->jointState();
  rosbridge::JointStateMessage out = rosbridge::toMessage(state, state.stamp_s + m_options.clock_ahead_s);
  const std::pair<const char*, double> others[] = {
      {"finger", m_gripper->position()}, {"pan", m_pan_tilt->pan()}, {"tilt", m_pan_tilt->tilt()}};
  out.velocity.clear();                  // the driver finds the speeds of the small ones by itself
  for (const auto& [name, position] : others) {
    out.name.emplace_back(name);
    out.position.push_back(position);
  }
  return out;
}

void BridgeServer::publishAll() {
  const auto wants = [this](const std::string& topic) {
    std::lock_guard<std::mutex> lock(m_mutex);
    return m_subscriptions.count(topic) != 0;
  };
  if (wants("/joint_states")) reply(rosbridge::publish("/joint_states", jointStates(), m_options.dialect));
  if (wants("/gripper_controller/holding")) {
    reply(rosbridge::publish("/gripper_controller/holding", rosbridge::BoolMessage{m_gripper->holding()}));
  }
  if (wants("/imu/data")) {
    const Attitude attitude = *m_imu->attitude();
    reply(rosbridge::publish("/imu/data", rosbridge::toMessage(attitude, attitude.stamp_s + m_options.clock_ahead_s, "imu_link"),
                             m_options.dialect));
  }
  if (wants("/odom")) {
    const BaseState state = *m_base->odometry();
    reply(rosbridge::publish("/odom", rosbridge::toMessage(state, state.stamp_s + m_options.clock_ahead_s),
                             m_options.dialect));
  }
  if (++m_turns % 5 == 0) publishPictures();
}

void BridgeServer::publishPictures() {
  std::vector<rosbridge::Subscribe> wanted;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    for (const auto& [topic, what] : m_subscriptions) {
      if (topic.find("/image/") != std::string::npos) wanted.push_back(what);
    }
  }
  for (const auto& what : wanted) {
    rosbridge::CompressedImageMessage picture;
    picture.header.stamp_s = m_clock.now_s() + m_options.clock_ahead_s - 0.01;
    picture.format = "bgr8; jpeg compressed bgr8";
    picture.data = kPicture;
    reply(rosbridge::publish(what.topic, picture, m_options.dialect), m_options.cbor && what.compression == "cbor");
  }
}

void BridgeServer::reply(const rosbridge::Operation& operation, bool binary) {
  for (auto* client : m_socket->clients) {
    if (binary) {
      client->sendBinaryMessage(QByteArray::fromStdString(rosbridge::encodeBinary(operation)));
    } else {
      client->sendTextMessage(QString::fromStdString(rosbridge::encodeText(operation)));
    }
  }
}

void BridgeServer::take(const std::string& frame) {
  const double now_s = m_steady.now_s();
  const auto operation = rosbridge::decodeText(frame);
  ASSERT_TRUE(operation.ok()) << operation.error().message << ": " << frame;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_received.push_back({*operation, now_s});
    if (const auto* message = std::get_if<rosbridge::Publish>(&*operation)) {
      Topic& topic = m_topics[message->topic];
      ++topic.count;
      topic.newest = message->message;
      topic.times.push_back(now_s);
    }
    if (const auto* what = std::get_if<rosbridge::Subscribe>(&*operation)) m_subscriptions[what->topic] = *what;
    if (const auto* what = std::get_if<rosbridge::Unsubscribe>(&*operation)) m_subscriptions.erase(what->topic);
  }
  if (const auto* message = std::get_if<rosbridge::Publish>(&*operation)) obey(*message);
  if (const auto* call = std::get_if<rosbridge::CallService>(&*operation)) {
    if (call->service != "/silent") reply(serve(*call));
  }
}

void BridgeServer::obey(const rosbridge::Publish& message) {
  if (message.topic == "/longarm/heartbeat") {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_heard_s = m_clock.now_s();
  } else if (message.topic == "/arm_controller/stop") {
    m_arm->stop();
  } else if (message.topic == "/gripper_controller/command") {
    const auto wanted = rosbridge::readAs<rosbridge::Float64Message>(message.message);
    ASSERT_TRUE(wanted.ok());
    (void)m_gripper->setOpening(wanted->data);
  } else if (message.topic == "/cmd_vel") {
    const auto read = rosbridge::readAs<rosbridge::TwistMessage>(message.message);
    ASSERT_TRUE(read.ok()) << read.error().message;
    (void)m_base->drive(*rosbridge::toTwist(*read));
  } else if (message.topic.rfind("/pan_tilt/", 0) == 0) {
    const auto wanted = rosbridge::readAs<rosbridge::JointTrajectoryMessage>(message.message);
    ASSERT_TRUE(wanted.ok() && wanted->points.size() == 1);
    (void)m_pan_tilt->moveTo(wanted->points[0].positions[0], wanted->points[0].positions[1]);
  } else if (message.topic == "/arm_controller/joint_trajectory") {
    const auto read = rosbridge::readAs<rosbridge::JointTrajectoryMessage>(message.message);
    ASSERT_TRUE(read.ok()) << read.error().message;
    auto horizon = rosbridge::toHorizon(*read);
    ASSERT_TRUE(horizon.ok()) << horizon.error().message;
    horizon->start_s = horizon->start_s == 0 ? m_clock.now_s() : horizon->start_s - m_options.clock_ahead_s;
    if (m_arm->state() == DeviceState::kIdle) (void)m_arm->activate();
    (void)m_arm->send(*horizon);
  }
}

rosbridge::ServiceResponse BridgeServer::serve(const rosbridge::CallService& call) {
  rosbridge::ServiceResponse out{call.service, {}, true, call.id};
  if (call.service == "/virtual_robot/step" && m_options.lockstep) {
    const int steps = static_cast<int>(std::lround(call.args.json().value("seconds", 0.0) / 0.01));
    for (int i = 0; i < steps; ++i) {
      m_manual.advance(0.01);
      turn();
    }
    out.values = rosbridge::Body(nlohmann::json{{"time", m_manual.now_s()}});
  } else if (call.service == "/echo") {
    out.values = call.args;
  } else {
    out.result = false;
    out.values = rosbridge::Body(nlohmann::json("no service " + call.service));
  }
  return out;
}

std::vector<Received> BridgeServer::received() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_received;
}

int BridgeServer::published(const std::string& topic) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const auto found = m_topics.find(topic);
  return found == m_topics.end() ? 0 : found->second.count;
}

rosbridge::Body BridgeServer::newest(const std::string& topic) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const auto found = m_topics.find(topic);
  return found == m_topics.end() ? rosbridge::Body() : found->second.newest;
}

bool BridgeServer::subscribed(const std::string& topic) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_subscriptions.count(topic) != 0;
}

double BridgeServer::cameAt(const std::string& topic, double since_s) const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const auto found = m_topics.find(topic);
  if (found == m_topics.end()) return -1;
  const auto& times = found->second.times;
  const auto at = std::lower_bound(times.begin(), times.end(), since_s);
  return at == times.end() ? -1 : *at;
}

void BridgeServer::sendText(const std::string& frame) {
  run([&] {
    for (auto* client : m_socket->clients) client->sendTextMessage(QString::fromUtf8(frame.data(), static_cast<int>(frame.size())));
  });
}

void BridgeServer::sendBinary(const std::string& frame) {
  run([&] {
    for (auto* client : m_socket->clients) client->sendBinaryMessage(QByteArray::fromStdString(frame));
  });
}

void BridgeServer::closeClients() {
  run([this] {
    for (auto* client : std::vector<QWebSocket*>(m_socket->clients)) client->abort();
  });
}

}  // namespace longarm::hardware::tests
