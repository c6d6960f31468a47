#pragma once

/// @file
/// Relay: one direction of one proxied connection.  Internal to the fault proxy.

#include <deque>
#include <string>
#include <string_view>

namespace longarm::hardware::internal {

/// What one direction does to its bytes; times on a steady clock.
struct FaultState {
  double delay_s = 0;
  double held_until_s = -1;              ///< In the past: not held.
  double swallowed_until_s = -1;
};

/// Bytes on their way, with the time they may go on.  Thread-compatible.
class Relay {
 public:
  /// Takes what has come from the source.
  void take(std::string_view bytes, double now_s, const FaultState& fault);
  /// Writes what is due to a socket that does not block.  @returns bytes written, -1 when the socket is broken.
  long pass(int socket, double now_s, const FaultState& fault);
  bool empty() const { return m_parts.empty(); }
  /// Whether something is due now.
  bool due(double now_s, const FaultState& fault) const;
  std::size_t waiting() const { return m_waiting; }

 private:
  struct Part {
    double due_s;
    std::string bytes;
  };
  std::deque<Part> m_parts;
  std::size_t m_waiting = 0;
};

}  // namespace longarm::hardware::internal
