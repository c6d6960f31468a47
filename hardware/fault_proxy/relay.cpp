#include "hardware/fault_proxy/relay.h"

#include <sys/socket.h>

#include <cerrno>

namespace longarm::hardware::internal {

void Relay::take(std::string_view bytes, double now_s, const FaultState& fault) {
  if (now_s < fault.swallowed_until_s) return;
  m_parts.push_back({now_s + fault.delay_s, std::string(bytes)});
  m_waiting += bytes.size();
}

bool Relay::due(double now_s, const FaultState& fault) const {
  return !m_parts.empty() && m_parts.front().due_s <= now_s && now_s >= fault.held_until_s;
}

long Relay::pass(int socket, double now_s, const FaultState& fault) {
  long passed = 0;
  while (due(now_s, fault)) {
    std::string& bytes = m_parts.front().bytes;
    const auto count = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0) return errno == EAGAIN || errno == EINTR ? passed : -1;
    passed += count;
    m_waiting -= static_cast<std::size_t>(count);
    if (static_cast<std::size_t>(count) < bytes.size()) {
      bytes.erase(0, static_cast<std::size_t>(count));
      return passed;
    }
    m_parts.pop_front();
  }
  return passed;
}

}  // namespace longarm::hardware::internal
