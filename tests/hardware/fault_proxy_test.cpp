#include "hardware/fault_proxy/fault_proxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "core/clock.h"
#include "core/text.h"
#include "tests/hardware/bridge_server.h"

namespace longarm::hardware::tests {
namespace {

// A plain TCP end: connects, or listens for one.
class End {
 public:
  explicit End(int socket) : m_socket(socket) {}
  ~End() {
    if (m_socket >= 0) ::close(m_socket);
  }
  static End listening(int* port) {
    End out(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(::bind(out.m_socket, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(out.m_socket, 4), 0);
    ::getsockname(out.m_socket, reinterpret_cast<sockaddr*>(&address), &size);
    *port = ntohs(address.sin_port);
    return out;
  }
  static End connectedTo(int port) {
    End out(::socket(AF_INET, SOCK_STREAM, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(::connect(out.m_socket, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    return out;
  }
  End(End&& other) noexcept : m_socket(std::exchange(other.m_socket, -1)) {}

  End accept() const { return End(::accept(m_socket, nullptr, nullptr)); }
  void send(const std::string& bytes) const {
    EXPECT_EQ(::send(m_socket, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// What comes within the time; "<closed>" at the end of the connection.
  std::string receive(double timeout_s) const {
    pollfd ready{m_socket, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(timeout_s * 1000)) <= 0) return "";
    char buffer[4096];
    const auto count = ::recv(m_socket, buffer, sizeof(buffer), 0);
    return count > 0 ? std::string(buffer, static_cast<std::size_t>(count)) : "<closed>";
  }

 private:
  int m_socket;
};

class FaultProxyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto started = FaultProxy::start("ws://127.0.0.1:" + std::to_string(m_port) + "/path");
    ASSERT_TRUE(started.ok()) << started.error().message;
    m_proxy = std::move(*started);
  }
  int proxyPort() const {
    const std::string& url = m_proxy->url();
    const auto colon = url.rfind(':');
    return static_cast<int>(*parseInteger(url.substr(colon + 1, url.rfind('/') - colon - 1)));
  }

  int m_port = 0;
  End m_listener = End::listening(&m_port);
  std::unique_ptr<FaultProxy> m_proxy;
  SteadyClock m_clock;
};

TEST_F(FaultProxyTest, PassesBytesBothWaysAndKeepsTheFormOfTheAddress) {
  EXPECT_EQ(m_proxy->url().rfind("ws://127.0.0.1:", 0), 0u);
  EXPECT_EQ(m_proxy->url().substr(m_proxy->url().size() - 5), "/path");
  const End client = End::connectedTo(proxyPort());
  const End target = m_listener.accept();
  client.send("hello");
  EXPECT_EQ(target.receive(2), "hello");
  target.send("you");
  EXPECT_EQ(client.receive(2), "you");
  EXPECT_TRUE(eventually([&] { return m_proxy->bytesToTarget() == 5 && m_proxy->bytesToClient() == 3; }));
}

TEST_F(FaultProxyTest, DelaysOneDirectionOnly) {
  const End client = End::connectedTo(proxyPort());
  const End target = m_listener.accept();
  m_proxy->setDelay(FaultProxy::Direction::kToTarget, 0.2);
  const double begin = m_clock.now_s();
  client.send("late");
  target.send("soon");
  EXPECT_EQ(client.receive(0.15), "soon");
  EXPECT_EQ(target.receive(2), "late");
  EXPECT_GE(m_clock.now_s() - begin, 0.199);
}

TEST_F(FaultProxyTest, HoldsBytesThroughAGapAndLosesNone) {
  const End client = End::connectedTo(proxyPort());
  const End target = m_listener.accept();
  m_proxy->hold(FaultProxy::Direction::kBoth, 0.2);
  client.send("one ");
  EXPECT_EQ(target.receive(0.1), "");
  client.send("two");
  std::string got;
  EXPECT_TRUE(eventually([&] { return (got += target.receive(0.01)) == "one two"; })) << got;
}

TEST_F(FaultProxyTest, SwallowsBytesForATime) {
  const End client = End::connectedTo(proxyPort());
  const End target = m_listener.accept();
  m_proxy->swallow(FaultProxy::Direction::kToTarget, -1);
  client.send("lost");
  EXPECT_EQ(target.receive(0.1), "");
  m_proxy->restore();
  client.send("found");
  EXPECT_EQ(target.receive(2), "found");
}

TEST_F(FaultProxyTest, CutsEveryConnectionAndRefusesNewOnesUntilItIsOver) {
  const End client = End::connectedTo(proxyPort());
  const End target = m_listener.accept();
  m_proxy->cut(-1);
  EXPECT_EQ(client.receive(2), "<closed>");
  EXPECT_EQ(target.receive(2), "<closed>");
  EXPECT_EQ(End::connectedTo(proxyPort()).receive(2), "<closed>");
  m_proxy->restore();
  const End again = End::connectedTo(proxyPort());
  const End target_again = m_listener.accept();
  again.send("back");
  EXPECT_EQ(target_again.receive(2), "back");
}

TEST_F(FaultProxyTest, InjectsBytes) {
  const End client = End::connectedTo(proxyPort());
  const End target = m_listener.accept();
  ASSERT_TRUE(eventually([&] { return m_proxy->connections() == 1; }));
  m_proxy->inject(FaultProxy::Direction::kToClient, "noise");
  EXPECT_EQ(client.receive(2), "noise");
}

TEST(FaultProxy, RefusesWhatIsNoAddress) {
  for (const char* wrong : {"", "ws://", "ws://host", "ws://host:", "ws://host:0", "ws://host:70000", "ws://:80", "ws://host:12x"}) {
    const auto started = FaultProxy::start(wrong);
    ASSERT_FALSE(started.ok()) << wrong;
    EXPECT_EQ(started.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(started.error().message.find(wrong), std::string::npos) << started.error().message;
  }
}

}  // namespace
}  // namespace longarm::hardware::tests
