// longarm-fault-proxy: a bad link between a console and a robot, for trying out.
#include <csignal>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "core/text.h"
#include "hardware/fault_proxy/fault_proxy.h"

namespace {

using longarm::hardware::FaultProxy;

constexpr const char* kUsage =
    "usage: longarm-fault-proxy ws://HOST:PORT [LISTENING_PORT]\n"
    "Connect the console to the address it prints, then type on standard input:\n"
    "  delay SECONDS | hold SECONDS | swallow SECONDS | cut SECONDS | restore | quit\n"
    "An optional third word, \"to-robot\" or \"to-console\", names the direction.  Negative seconds: until restore.\n";

FaultProxy::Direction directionOf(const std::vector<std::string>& words) {
  if (words.size() > 2 && words[2] == "to-robot") return FaultProxy::Direction::kToTarget;
  if (words.size() > 2 && words[2] == "to-console") return FaultProxy::Direction::kToClient;
  return FaultProxy::Direction::kBoth;
}

// False for a line that is no command.
bool obey(FaultProxy& proxy, const std::string& line) {
  const auto words = longarm::split(std::string(longarm::trimmed(line)), ' ');
  if (words[0] == "restore") {
    proxy.restore();
    return true;
  }
  const auto seconds = words.size() > 1 ? longarm::parseNumber(words[1]) : std::nullopt;
  if (!seconds) return false;
  if (words[0] == "delay") {
    proxy.setDelay(directionOf(words), *seconds);
  } else if (words[0] == "hold") {
    proxy.hold(directionOf(words), *seconds);
  } else if (words[0] == "swallow") {
    proxy.swallow(directionOf(words), *seconds);
  } else if (words[0] == "cut") {
    proxy.cut(*seconds);
  } else {
    return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  const auto port = argc > 2 ? longarm::parseInteger(argv[2]) : std::optional<long long>(0);
  if (argc < 2 || argc > 3 || !port || *port < 0 || *port > 65535) {
    std::fputs(kUsage, stderr);
    return 2;
  }
  auto proxy = FaultProxy::start(argv[1], static_cast<int>(*port));
  if (!proxy) {
    std::fprintf(stderr, "longarm-fault-proxy: %s\n", proxy.error().message.c_str());
    return 3;
  }
  std::printf("%s\n", (*proxy)->url().c_str());
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line) && line != "quit";) {
    if (!longarm::trimmed(line).empty() && !obey(**proxy, line)) std::fputs(kUsage, stderr);
  }
  return 0;
}
