#pragma once

/// @file
/// rosbridge v2 operations: what stands around a message on the wire, for either end of the link.
///
/// A console encodes Subscribe, Advertise, Publish, CallService and decodes Publish, ServiceResponse, Status;
/// a robot does it the other way round.  One WebSocket text frame holds one operation in JSON, one binary
/// frame one operation in CBOR (used for pictures when subscribed with compression "cbor").
/// Every function is pure and throws nothing.  Bounds: 32 MB per frame, 32 levels, 2 million values.

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>

#include "core/result.h"
#include "hardware/rosbridge_codec/messages.h"

namespace longarm::rosbridge {

constexpr std::size_t kMaxFrameBytes = 32u << 20;
constexpr int kMaxDepth = 32;
constexpr std::size_t kMaxValues = 2'000'000;

struct Advertise {
  std::string topic, type, id;
};
struct Unadvertise {
  std::string topic, id;
};
struct Publish {
  std::string topic;
  Body message;
  std::string id;
};
struct Subscribe {
  std::string topic, type;
  int throttle_rate_ms = 0;              ///< Least time between two messages [ms].
  int queue_length = 0;                  ///< 0: no queue.
  std::string compression = "none";      ///< "none" or "cbor".
  std::string id;
};
struct Unsubscribe {
  std::string topic, id;
};
struct CallService {
  std::string service;
  Body args;
  std::string id;                        ///< Comes back in the response.
};
struct ServiceResponse {
  std::string service;
  Body values;
  bool result = true;
  std::string id;
};
/// The peer's opinion: "error", "warning", "info".
struct StatusReport {
  std::string level = "error", text, id;
};

using Operation =
    std::variant<Advertise, Unadvertise, Publish, Subscribe, Unsubscribe, CallService, ServiceResponse, StatusReport>;

/// One text frame.  Binary data in it becomes base64; numbers that are not finite become null.
std::string encodeText(const Operation& operation);
/// One binary frame (CBOR).
std::string encodeBinary(const Operation& operation);

/// @returns kInvalidInput: not JSON (with the place), too large or deep, no or unknown "op", or a field of the
/// operation that is missing or of the wrong kind (named).
Result<Operation> decodeText(std::string_view frame);
Result<Operation> decodeBinary(std::string_view frame);

/// Shorthand: a Publish of a typed message.
template <typename Message>
Operation publish(const std::string& topic, const Message& message, Dialect dialect = Dialect::kRos1) {
  return Publish{topic, write(message, dialect), {}};
}

}  // namespace longarm::rosbridge
