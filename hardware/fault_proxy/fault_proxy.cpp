#include "hardware/fault_proxy/fault_proxy.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <limits>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "core/text.h"
#include "hardware/fault_proxy/relay.h"

namespace longarm::hardware {
namespace {

using internal::FaultState;
using internal::Relay;

constexpr int kTurn_ms = 2;              // how finely faults are timed
constexpr std::size_t kMaxWaiting = 64u << 20;
constexpr double kForever = std::numeric_limits<double>::infinity();

enum Way : std::size_t { kUp = 0, kDown = 1 };   // client to target, target to client

// One proxied connection.
struct Pair {
  std::array<int, 2> sockets{-1, -1};    // client, target
  std::array<Relay, 2> relays;           // by Way
  bool ended = false;

  Pair(int client, int target) : sockets{client, target} {}
  Pair(const Pair&) = delete;
  Pair& operator=(const Pair&) = delete;
  ~Pair() {
    for (const int s : sockets) ::close(s);
  }
};

struct Target {
  std::string before, host, after;       // "ws://", "host", "/path"
  int port = 0;
};

Result<Target> parseTarget(const std::string& text) {
  Target out;
  std::string rest = text;
  if (const auto scheme = rest.find("://"); scheme != std::string::npos) {
    out.before = rest.substr(0, scheme + 3);
    rest = rest.substr(scheme + 3);
  }
  if (const auto slash = rest.find('/'); slash != std::string::npos) {
    out.after = rest.substr(slash);
    rest = rest.substr(0, slash);
  }
  const auto colon = rest.rfind(':');
  const auto port = colon == std::string::npos ? std::nullopt : parseInteger(rest.substr(colon + 1));
  if (!port || *port < 1 || *port > 65535 || colon == 0) {
    return Error{ErrorCode::kInvalidInput, "\"" + text + "\" is no address; expected ws://HOST:PORT"};
  }
  out.host = rest.substr(0, colon);
  out.port = static_cast<int>(*port);
  return out;
}

Result<sockaddr_in> lookUp(const Target& target) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (::getaddrinfo(target.host.c_str(), nullptr, &hints, &found) != 0 || found == nullptr) {
    return Error{ErrorCode::kNotFound, "host \"" + target.host + "\" is not known"};
  }
  sockaddr_in out{};
  std::memcpy(&out, found->ai_addr, sizeof(out));
  ::freeaddrinfo(found);
  out.sin_port = htons(static_cast<std::uint16_t>(target.port));
  return out;
}

void makeQuick(int socket) {
  const int on = 1;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof(on));
  ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) | O_NONBLOCK);
}

double until(double now_s, double seconds) { return seconds < 0 ? kForever : now_s + seconds; }

}  // namespace

struct FaultProxy::Impl {
  sockaddr_in target{};
  std::string url;
  int listener = -1;
  const SteadyClock clock;
  std::thread thread;
  std::atomic<bool> quit{false};
  std::array<std::atomic<std::size_t>, 2> bytes{};
  std::atomic<int> open{0};

  std::mutex mutex;                      // guards what follows
  std::array<FaultState, 2> faults;      // by Way
  std::array<std::string, 2> injected;
  double cut_until_s = -1;

  std::list<Pair> pairs;                 // the thread's own

  ~Impl() {
    quit = true;
    if (thread.joinable()) thread.join();
    if (listener >= 0) ::close(listener);
  }

  template <typename Change>
  void change(Direction direction, Change&& apply) {
    std::lock_guard<std::mutex> lock(mutex);
    if (direction != Direction::kToClient) apply(kUp);
    if (direction != Direction::kToTarget) apply(kDown);
  }

  Status listen(int port);
  void run();
  void turn();
  void accept(double now_s);
  void read(Pair& pair, std::size_t side, double now_s, const std::array<FaultState, 2>& current);
};

Status FaultProxy::Impl::listen(int port) {
  listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  ::setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof(address);
  if (listener < 0 || ::bind(listener, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      ::listen(listener, 16) != 0 || ::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return {ErrorCode::kInternal, "port " + std::to_string(port) + " cannot be listened on: " + std::strerror(errno)};
  }
  ::fcntl(listener, F_SETFL, ::fcntl(listener, F_GETFL) | O_NONBLOCK);
  url = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  return {};
}

void FaultProxy::Impl::run() {
  while (!quit) {
    std::vector<pollfd> waits = {{listener, POLLIN, 0}};
    for (const auto& pair : pairs) {
      for (const int socket : pair.sockets) waits.push_back({socket, POLLIN, 0});
    }
    // What waits for its time has no event of its own, and a fault may begin at any moment.
    ::poll(waits.data(), waits.size(), kTurn_ms);
    turn();
  }
  pairs.clear();
}

void FaultProxy::Impl::turn() {
  const double now_s = clock.now_s();
  std::array<FaultState, 2> current;
  std::array<std::string, 2> extra;
  bool is_cut = false;
  {
    std::lock_guard<std::mutex> lock(mutex);
    current = faults;
    extra.swap(injected);
    is_cut = now_s < cut_until_s;
  }
  if (is_cut) pairs.clear();
  for (auto& pair : pairs) {
    for (const auto way : {kUp, kDown}) {
      read(pair, way, now_s, current);
      if (!extra[way].empty()) pair.relays[way].take(extra[way], now_s, {});
      const long passed = pair.relays[way].pass(pair.sockets[1 - way], now_s, current[way]);
      if (passed > 0) bytes[way] += static_cast<std::size_t>(passed);
      if (passed < 0) pair.ended = true;
    }
  }
  pairs.remove_if([](const Pair& pair) { return pair.ended && pair.relays[kUp].empty() && pair.relays[kDown].empty(); });
  accept(now_s);
  open = static_cast<int>(pairs.size());
}

// A side that has closed ends the pair, when what it said before has been passed on.
void FaultProxy::Impl::read(Pair& pair, std::size_t side, double now_s, const std::array<FaultState, 2>& current) {
  char buffer[65536];
  while (!pair.ended && pair.relays[side].waiting() < kMaxWaiting) {
    const auto count = ::recv(pair.sockets[side], buffer, sizeof(buffer), 0);
    if (count < 0) {
      if (errno != EAGAIN && errno != EINTR) pair.ended = true;
      return;
    }
    if (count == 0) {
      pair.ended = true;
      return;
    }
    pair.relays[side].take({buffer, static_cast<std::size_t>(count)}, now_s, current[side]);
  }
}

void FaultProxy::Impl::accept(double now_s) {
  for (;;) {
    const int client = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (client < 0) return;
    bool is_cut = false;
    {
      std::lock_guard<std::mutex> lock(mutex);
      is_cut = now_s < cut_until_s;
    }
    const int onward = is_cut ? -1 : ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (onward < 0 || ::connect(onward, reinterpret_cast<const sockaddr*>(&target), sizeof(target)) != 0) {
      if (onward >= 0) ::close(onward);
      ::close(client);
      continue;
    }
    makeQuick(client);
    makeQuick(onward);
    pairs.emplace_back(client, onward);
  }
}

FaultProxy::FaultProxy() : m_impl(std::make_unique<Impl>()) {}
FaultProxy::~FaultProxy() = default;

Result<std::unique_ptr<FaultProxy>> FaultProxy::start(const std::string& target, int port) {
  const auto parsed = parseTarget(target);
  if (!parsed) return parsed.error();
  const auto address = lookUp(*parsed);
  if (!address) return address.error();
  std::unique_ptr<FaultProxy> proxy(new FaultProxy());
  proxy->m_impl->target = *address;
  if (auto status = proxy->m_impl->listen(port); !status) return status.error();
  proxy->m_impl->url = parsed->before + proxy->m_impl->url + parsed->after;
  proxy->m_impl->thread = std::thread([impl = proxy->m_impl.get()] { impl->run(); });
  return proxy;
}

const std::string& FaultProxy::url() const { return m_impl->url; }

void FaultProxy::setDelay(Direction direction, double seconds) {
  m_impl->change(direction, [&](Way way) { m_impl->faults[way].delay_s = seconds; });
}

void FaultProxy::hold(Direction direction, double seconds) {
  const double end = until(m_impl->clock.now_s(), seconds);
  m_impl->change(direction, [&](Way way) { m_impl->faults[way].held_until_s = end; });
}

void FaultProxy::swallow(Direction direction, double seconds) {
  const double end = until(m_impl->clock.now_s(), seconds);
  m_impl->change(direction, [&](Way way) { m_impl->faults[way].swallowed_until_s = end; });
}

void FaultProxy::cut(double seconds) {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  m_impl->cut_until_s = until(m_impl->clock.now_s(), seconds);
}

void FaultProxy::inject(Direction direction, std::string_view bytes) {
  m_impl->change(direction, [&](Way way) { m_impl->injected[way].append(bytes); });
}

void FaultProxy::restore() {
  std::lock_guard<std::mutex> lock(m_impl->mutex);
  m_impl->faults = {};
  m_impl->cut_until_s = -1;
}

std::size_t FaultProxy::bytesToTarget() const { return m_impl->bytes[kUp]; }
std::size_t FaultProxy::bytesToClient() const { return m_impl->bytes[kDown]; }
int FaultProxy::connections() const { return m_impl->open; }

}  // namespace longarm::hardware
