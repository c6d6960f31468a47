// The real program over a real socket.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include <QCoreApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QTimer>
#include <QUrl>
#include <QWebSocket>

#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <nlohmann/json.hpp>

namespace longarm::virtual_robot {
namespace {

using nlohmann::json;

QCoreApplication& application() {
  static int argc = 1;
  static char name[] = "test_virtual_robot";
  static char* argv[] = {name, nullptr};
  static QCoreApplication app(argc, argv);
  return app;
}

/// Runs the event loop until the condition holds or `ms` have passed.
bool waitFor(const std::function<bool()>& condition, int ms = 10000) {
  QElapsedTimer clock;
  clock.start();
  while (!condition()) {
    if (clock.elapsed() > ms) return false;
    QCoreApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents, 20);
  }
  return true;
}

class Process {
 public:
  explicit Process(std::vector<std::string> arguments) {
    int in[2], out[2];
    EXPECT_EQ(pipe2(in, O_CLOEXEC), 0);
    EXPECT_EQ(pipe2(out, O_CLOEXEC), 0);
    m_pid = fork();
    if (m_pid == 0) {
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      std::vector<char*> argv = {const_cast<char*>(LONGARM_VIRTUAL_ROBOT_BINARY)};
      for (auto& a : arguments) argv.push_back(a.data());
      argv.push_back(nullptr);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    m_input = in[1];
    m_output = out[0];
  }
  ~Process() {
    closeInput();
    if (!m_ended) {
      ::kill(m_pid, SIGKILL);
      waitpid(m_pid, nullptr, 0);
    }
    close(m_output);
  }
  std::string line() {
    std::string out;
    char c = 0;
    pollfd wait{m_output, POLLIN, 0};
    while (poll(&wait, 1, 20000) == 1 && read(m_output, &c, 1) == 1 && c != '\n') out += c;
    return out;
  }
  int port() {
    const std::string text = line();
    const json value = json::parse(text, nullptr, false);
    EXPECT_TRUE(value.is_object()) << text;
    const std::string url = value.is_object() ? value.value("url", "") : "";
    EXPECT_EQ(url.rfind("ws://127.0.0.1:", 0), 0u) << url;
    return url.empty() ? 0 : std::stoi(url.substr(url.rfind(':') + 1));
  }
  void closeInput() {
    if (m_input >= 0) close(m_input);
    m_input = -1;
  }
  void signal(int number) const { ::kill(m_pid, number); }
  /// Exit status, or -1 while it runs, or -2 when a signal ended it.
  int ended() {
    int status = 0;
    if (!m_ended && waitpid(m_pid, &status, WNOHANG) == m_pid) {
      m_ended = true;
      m_status = WIFEXITED(status) ? WEXITSTATUS(status) : -2;
    }
    return m_ended ? m_status : -1;
  }

 private:
  pid_t m_pid = -1;
  int m_input = -1, m_output = -1, m_status = 0;
  bool m_ended = false;
};

class Client {
 public:
  explicit Client(int port) {
    application();
    QObject::connect(&m_socket, &QWebSocket::textMessageReceived, &m_socket,
                     [this](const QString& text) { take(json::parse(text.toStdString())); });
    QObject::connect(&m_socket, &QWebSocket::binaryMessageReceived, &m_socket, [this](const QByteArray& bytes) {
      take(json::from_cbor(bytes.begin(), bytes.end(), true, true, json::cbor_tag_handler_t::ignore));
    });
    QObject::connect(&m_heart, &QTimer::timeout, &m_heart, [this] { publish("/longarm/heartbeat", json::object()); });
    m_socket.open(QUrl(QStringLiteral("ws://127.0.0.1:%1").arg(port)));
  }
  bool open() { return waitFor([this] { return m_socket.isValid(); }, 10000); }
  bool closed() { return waitFor([this] { return m_socket.state() == QAbstractSocket::UnconnectedState; }, 10000); }
  QWebSocket& socket() { return m_socket; }
  void beat() { m_heart.start(50); }
  void silence() { m_heart.stop(); }
  void say(const json& operation) { m_socket.sendTextMessage(QString::fromStdString(operation.dump())); }
  void publish(const std::string& topic, const json& message) {
    say({{"op", "publish"}, {"topic", topic}, {"msg", message}});
  }
  void subscribe(const std::string& topic, const std::string& compression = "none") {
    say({{"op", "subscribe"}, {"topic", topic}, {"compression", compression}});
  }
  json call(const std::string& service, const json& args = json::object()) {
    m_answer = nullptr;
    say({{"op", "call_service"}, {"service", service}, {"args", args}, {"id", "c"}});
    EXPECT_TRUE(waitFor([this] { return !m_answer.is_null(); }, 30000)) << service;
    return m_answer;
  }
  /// Messages of a topic so far.
  std::vector<json>& on(const std::string& topic) { return m_messages[topic]; }

 private:
  void take(const json& operation) {
    if (operation["op"] == "service_response") m_answer = operation;
    if (operation["op"] == "publish") m_messages[operation["topic"]].push_back(operation["msg"]);
  }
  QWebSocket m_socket;
  QTimer m_heart;
  json m_answer;
  std::map<std::string, std::vector<json>> m_messages;
};

double stampOf(const json& message) {
  return message["header"]["stamp"]["secs"].get<double>() + 1e-9 * message["header"]["stamp"]["nsecs"].get<double>();
}

TEST(VirtualProcess, EndsWhenItsInputCloses) {
  Process robot({"--no-cameras"});
  ASSERT_GT(robot.port(), 0);
  robot.closeInput();
  EXPECT_TRUE(waitFor([&] { return robot.ended() == 0; }));
}

TEST(VirtualProcess, EndsOnSigtermAndOnQuitWhileAClientIsConnected) {
  Process robot({"--no-cameras"});
  Client client(robot.port());
  ASSERT_TRUE(client.open());
  robot.signal(SIGTERM);
  EXPECT_TRUE(waitFor([&] { return robot.ended() == 0; }));
  Process other({"--no-cameras"});
  Client second(other.port());
  ASSERT_TRUE(second.open());
  second.say({{"op", "call_service"}, {"service", "/virtual_robot/quit"}});
  EXPECT_TRUE(waitFor([&] { return other.ended() == 0; }));
}

TEST(VirtualProcess, SaysWhatIsWrongWithItsArguments) {
  Process unknown({"--scenario", "moon_base"});
  EXPECT_TRUE(waitFor([&] { return unknown.ended() == 3; }));
  Process wrong({"--frobnicate"});
  EXPECT_TRUE(waitFor([&] { return wrong.ended() == 2; }));
  Process version({"--version"});
  EXPECT_FALSE(version.line().empty());
  EXPECT_TRUE(waitFor([&] { return version.ended() == 0; }));
}

TEST(VirtualProcess, RefusesASecondClientWhileTheFirstLivesAndTakesOneAfter) {
  Process robot({"--no-cameras"});
  const int port = robot.port();
  auto first = std::make_unique<Client>(port);
  ASSERT_TRUE(first->open());
  first->subscribe("/joint_states");
  ASSERT_TRUE(waitFor([&] { return !first->on("/joint_states").empty(); }));
  Client second(port);
  EXPECT_TRUE(second.closed());
  EXPECT_TRUE(first->socket().isValid());
  const std::size_t before = first->on("/joint_states").size();
  EXPECT_TRUE(waitFor([&] { return first->on("/joint_states").size() > before + 5; })) << "the first is undisturbed";
  first.reset();
  bool served = false;
  for (int i = 0; i < 50 && !served; ++i) {
    Client third(port);
    served = third.open() && third.call("/virtual_robot/info")["result"] == true;
  }
  EXPECT_TRUE(served);
}

TEST(VirtualProcess, ListensOnThisMachineOnly) {
  Process robot({"--no-cameras"});
  const int port = robot.port();
  ifaddrs* all = nullptr;
  ASSERT_EQ(getifaddrs(&all), 0);
  int tried = 0;
  for (ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    auto address = *reinterpret_cast<sockaddr_in*>(each->ifa_addr);
    const bool loopback = ntohl(address.sin_addr.s_addr) == INADDR_LOOPBACK;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int result = ::connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address);
    EXPECT_EQ(result == 0, loopback) << inet_ntoa(address.sin_addr);
    close(socket);
    ++tried;
  }
  freeifaddrs(all);
  sockaddr_in elsewhere{};               // another address of the loopback net
  elsewhere.sin_family = AF_INET;
  elsewhere.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, "127.0.0.2", &elsewhere.sin_addr);
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  EXPECT_NE(::connect(socket, reinterpret_cast<sockaddr*>(&elsewhere), sizeof elsewhere), 0);
  close(socket);
  EXPECT_GT(tried, 0);
}

TEST(VirtualProcess, AWebPageOfAnotherSiteIsRefused) {
  Process robot({"--no-cameras"});
  const int port = robot.port();
  application();
  QWebSocket page(QStringLiteral("http://example.com"));
  page.open(QUrl(QStringLiteral("ws://127.0.0.1:%1").arg(port)));
  EXPECT_TRUE(waitFor([&] { return page.state() == QAbstractSocket::UnconnectedState; }));
  EXPECT_FALSE(page.isValid());
}

json halfMove(const json& state, double seconds) {
  const std::vector<std::string> joints = {"arm_1_joint", "arm_2_joint", "arm_3_joint",
                                           "arm_4_joint", "arm_5_joint", "arm_6_joint"};
  std::vector<double> from, to, zero(6, 0);
  for (const auto& joint : joints) {
    for (std::size_t i = 0; i < state["name"].size(); ++i) {
      if (state["name"][i] == joint) from.push_back(state["position"][i].get<double>());
    }
  }
  for (std::size_t i = 0; i < from.size(); ++i) to.push_back(from[i] + (i == 0 ? 0.9 : 0));
  const auto point = [&](const std::vector<double>& q, double t) {
    const int whole = static_cast<int>(t);
    return json{{"positions", q}, {"velocities", zero}, {"accelerations", zero},
                {"time_from_start", {{"secs", whole}, {"nsecs", static_cast<int>(1e9 * (t - whole))}}}};
  };
  return {{"joint_names", joints}, {"points", {point(from, 0), point(to, seconds)}}};
}

double armOne(const json& truth) { return truth["values"]["joints"]["arm_1_joint"].get<double>(); }

TEST(VirtualProcess, AnArmWhoseClientDiesStandsStillAndIsThereForTheNext) {
  Process robot({"--no-cameras", "--ideal"});
  const int port = robot.port();
  auto client = std::make_unique<Client>(port);
  ASSERT_TRUE(client->open());
  client->beat();
  client->subscribe("/joint_states");
  ASSERT_TRUE(waitFor([&] { return client->on("/joint_states").size() > 10; }));
  client->publish("/longarm/heartbeat", json::object());
  client->publish("/arm_controller/joint_trajectory", halfMove(client->on("/joint_states").back(), 1.8));
  ASSERT_TRUE(waitFor([&] {
    const auto& state = client->on("/joint_states").back();
    for (std::size_t i = 0; i < state["name"].size(); ++i) {
      if (state["name"][i] == "arm_1_joint" && state["position"][i].get<double>() > 0.2) return true;
    }
    return false;
  }));
  client->socket().abort();              // as when the console is killed
  client.reset();
  std::unique_ptr<Client> next;
  json first;
  for (int i = 0; i < 50 && first.is_null(); ++i) {
    next = std::make_unique<Client>(port);
    if (next->open()) first = next->call("/virtual_robot/truth");
  }
  ASSERT_FALSE(first.is_null());
  json still = first, later;
  ASSERT_TRUE(waitFor([&] {
    later = next->call("/virtual_robot/truth");
    const bool rests = later["values"]["time"].get<double>() > still["values"]["time"].get<double>() + 0.05 &&
                       armOne(later) == armOne(still);
    if (armOne(later) != armOne(still)) still = later;
    return rests;
  }));
  EXPECT_LT(still["values"]["time"].get<double>() - first["values"]["time"].get<double>(), 0.4);
  EXPECT_GT(armOne(later), 0.2);
  EXPECT_LT(armOne(later), 0.75) << "it did not finish the motion";
}

TEST(VirtualProcess, ServesPicturesInLockstepThatAreTheSameEachTime) {
  const auto session = [] {
    Process robot({"--lockstep", "--seed", "4"});
    Client client(robot.port());
    EXPECT_TRUE(client.open());
    client.subscribe("/camera/head_left/image/compressed", "cbor");
    client.subscribe("/camera/head_right/image/compressed", "cbor");
    client.subscribe("/camera/head_left/camera_info");
    client.call("/virtual_robot/step", {{"seconds", 0.25}});
    const auto& left = client.on("/camera/head_left/image/compressed");
    const auto& right = client.on("/camera/head_right/image/compressed");
    EXPECT_EQ(left.size(), 3u);
    EXPECT_EQ(right.size(), 3u);
    for (std::size_t i = 0; i < left.size() && i < right.size(); ++i) EXPECT_EQ(stampOf(left[i]), stampOf(right[i]));
    EXPECT_EQ(client.on("/camera/head_left/camera_info").size(), 3u);
    EXPECT_EQ(client.on("/camera/head_left/camera_info")[0]["K"][0], 741.2);
    std::string bytes;
    for (const auto& message : left) {
      const auto& data = message["data"].get_binary();
      bytes.append(data.begin(), data.end());
    }
    return bytes;
  };
  const std::string first = session();
  EXPECT_GT(first.size(), 30000u);
  EXPECT_EQ(first, session());
}

TEST(VirtualProcess, PicturesDoNotHoldUpJointStates) {
  Process robot({});
  Client client(robot.port());
  ASSERT_TRUE(client.open());
  client.subscribe("/joint_states");
  client.subscribe("/camera/head_left/image/compressed", "cbor");
  client.subscribe("/camera/head_right/image/compressed", "cbor");
  ASSERT_TRUE(waitFor([&] { return client.on("/camera/head_right/image/compressed").size() >= 3; }, 60000));
  const auto& states = client.on("/joint_states");
  for (std::size_t i = 1; i < states.size(); ++i) {
    EXPECT_NEAR(stampOf(states[i]) - stampOf(states[i - 1]), 0.01, 1e-6) << "every reading was sent";
  }
  const auto& left = client.on("/camera/head_left/image/compressed");
  EXPECT_EQ(stampOf(left[1]), stampOf(client.on("/camera/head_right/image/compressed")[1]));
}

}  // namespace
}  // namespace longarm::virtual_robot
