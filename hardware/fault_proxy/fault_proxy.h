#pragma once

/// @file
/// FaultProxy: a TCP relay that drops, delays and cuts, to try out bad links.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "core/result.h"

namespace longarm::hardware {

/// Listens on 127.0.0.1 and passes everything on to one target.  Faults are in real time.  Thread-safe; a thread of its
/// own does the work.
class FaultProxy {
 public:
  enum class Direction { kToTarget, kToClient, kBoth };

  /// @param target  "ws://host:port" (what follows is kept in url()) or "host:port"; the host is a name or IPv4 address.
  /// @param port    To listen on; 0: any free one.
  /// @returns kInvalidInput naming the target, kNotFound when its host is unknown, kInternal when no port can be had.
  static Result<std::unique_ptr<FaultProxy>> start(const std::string& target, int port = 0);
  ~FaultProxy();                         ///< Closes every connection.

  /// As the target was given, with this proxy's host and port.
  const std::string& url() const;

  /// What comes is passed on so much later [s]; 0 ends it.
  void setDelay(Direction direction, double seconds);
  /// A radio gap: nothing passes for so long, then all of it comes late, in order.  < 0: until restore().
  void hold(Direction direction, double seconds);
  /// Bytes are lost for so long: what follows makes no sense to the receiver.  < 0: until restore().
  void swallow(Direction direction, double seconds);
  /// Every connection is closed and new ones are refused for so long [s]; < 0: until restore().
  void cut(double seconds);
  /// Puts bytes of its own into every connection.
  void inject(Direction direction, std::string_view bytes);
  /// Ends every fault.
  void restore();

  /// Bytes that were passed on so far.
  std::size_t bytesToTarget() const;
  std::size_t bytesToClient() const;
  int connections() const;               ///< Open now.

 private:
  FaultProxy();
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::hardware
