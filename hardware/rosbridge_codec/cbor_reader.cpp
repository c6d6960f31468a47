// CBOR (RFC 8949) into a JSON value.  Our own because the library's reader recurses on nested tags and
// chunked strings without a bound and copies pictures byte by byte.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <string>

#include "hardware/rosbridge_codec/protocol.h"
#include "hardware/rosbridge_codec/value_reader.h"

namespace longarm::rosbridge::internal {
namespace {

using Json = nlohmann::json;

enum Major { kUnsigned, kNegative, kBytes, kText, kArray, kMap, kTag, kSimple };

struct Head {
  int major = 0;
  int info = 0;                          // low five bits
  std::uint64_t value = 0;
  bool indefinite = false;
};

// IEEE 754 half precision, RFC 8949 appendix D.
double halfToDouble(std::uint64_t half) {
  const int exponent = static_cast<int>((half >> 10) & 0x1f);
  const double mantissa = static_cast<double>(half & 0x3ff);
  double value = 0;
  if (exponent == 0) {
    value = std::ldexp(mantissa, -24);
  } else if (exponent != 31) {
    value = std::ldexp(mantissa + 1024, exponent - 25);
  } else {
    value = mantissa == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  }
  return (half & 0x8000) != 0 ? -value : value;
}

double singleToDouble(std::uint64_t bits) {
  const auto narrow = static_cast<std::uint32_t>(bits);
  float value = 0;
  std::memcpy(&value, &narrow, sizeof value);
  return static_cast<double>(value);
}

double doubleFromBits(std::uint64_t bits) {
  double value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

class CborReader {
 public:
  explicit CborReader(std::string_view bytes) : m_bytes(bytes) {}

  bool readAll(Json& out) {
    if (!readItem(out, 0)) return false;
    return m_at == m_bytes.size() || fail("bytes left over after the value");
  }
  const std::string& failure() const { return m_failure; }

 private:
  bool fail(const std::string& why) {
    if (m_failure.empty()) m_failure = why + " at byte " + std::to_string(m_at);
    return false;
  }

  bool readHead(Head& head) {
    if (m_at >= m_bytes.size()) return fail("cut short");
    const auto first = static_cast<unsigned char>(m_bytes[m_at++]);
    head = Head{first >> 5, first & 0x1f, 0, false};
    if (head.info < 24) {
      head.value = static_cast<std::uint64_t>(head.info);
      return true;
    }
    if (head.info == 31) {
      head.indefinite = true;
      return true;
    }
    if (head.info > 27) return fail("reserved length code");
    const std::size_t count = std::size_t{1} << (head.info - 24);
    if (m_bytes.size() - m_at < count) return fail("cut short");
    for (std::size_t i = 0; i < count; ++i) {
      head.value = (head.value << 8) | static_cast<unsigned char>(m_bytes[m_at++]);
    }
    return true;
  }

  bool atBreak() {
    if (m_at < m_bytes.size() && static_cast<unsigned char>(m_bytes[m_at]) == 0xff) {
      ++m_at;
      return true;
    }
    return false;
  }

  bool appendChunk(const Head& head, std::string& out) {
    if (head.value > m_bytes.size() - m_at) return fail("string longer than the frame");
    out.append(m_bytes.substr(m_at, static_cast<std::size_t>(head.value)));
    m_at += static_cast<std::size_t>(head.value);
    return true;
  }

  bool readString(const Head& head, std::string& out) {
    if (!head.indefinite) return appendChunk(head, out);
    while (!atBreak()) {
      Head chunk;
      if (!readHead(chunk)) return false;
      if (chunk.major != head.major || chunk.indefinite) return fail("wrong chunk in a string");
      if (!appendChunk(chunk, out)) return false;
    }
    return true;
  }

  bool readBinary(const Head& head, Json& out) {
    std::string bytes;
    if (!readString(head, bytes)) return false;
    out = Json::binary(Json::binary_t::container_type(bytes.begin(), bytes.end()));
    return true;
  }

  bool readArray(const Head& head, Json& out, int depth) {
    out = Json::array();
    for (std::uint64_t i = 0; head.indefinite ? !atBreak() : i < head.value; ++i) {
      Json item;
      if (!readItem(item, depth + 1)) return false;
      out.push_back(std::move(item));
    }
    return true;
  }

  bool readMap(const Head& head, Json& out, int depth) {
    out = Json::object();
    for (std::uint64_t i = 0; head.indefinite ? !atBreak() : i < head.value; ++i) {
      Head key_head;
      std::string key;
      if (!readHead(key_head)) return false;
      if (key_head.major != kText) return fail("a key that is not text");
      if (!readString(key_head, key) || !readItem(out[key], depth + 1)) return false;
    }
    return true;
  }

  bool readTagged(const Head& head, Json& out, int depth) {
    if (head.indefinite) return fail("tag without a number");
    if (!readItem(out, depth + 1)) return false;
    if (out.is_binary() && head.value >= 64 && head.value <= 87) out.get_binary().set_subtype(head.value);
    return true;
  }

  bool readSimple(const Head& head, Json& out) {
    switch (head.info) {
      case 20: out = false; return true;
      case 21: out = true; return true;
      case 22:
      case 23: out = nullptr; return true;
      case 25: out = halfToDouble(head.value); return true;
      case 26: out = singleToDouble(head.value); return true;
      case 27: out = doubleFromBits(head.value); return true;
      default: return fail("unknown simple value");
    }
  }

  bool readNegative(const Head& head, Json& out) {
    if (head.value > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
      return fail("integer out of range");
    }
    out = -1 - static_cast<std::int64_t>(head.value);
    return true;
  }

  bool readItem(Json& out, int depth) {
    if (depth > kMaxDepth) return fail("nested deeper than " + std::to_string(kMaxDepth) + " levels");
    if (++m_count > kMaxValues) return fail("more than " + std::to_string(kMaxValues) + " values");
    Head head;
    if (!readHead(head)) return false;
    switch (head.major) {
      case kUnsigned:
        if (head.indefinite) return fail("integer without a value");
        out = head.value;
        return true;
      case kNegative: return head.indefinite ? fail("integer without a value") : readNegative(head, out);
      case kBytes: return readBinary(head, out);
      case kText: {
        std::string text;
        if (!readString(head, text)) return false;
        out = std::move(text);
        return true;
      }
      case kArray: return readArray(head, out, depth);
      case kMap: return readMap(head, out, depth);
      case kTag: return readTagged(head, out, depth);
      default: return readSimple(head, out);
    }
  }

  std::string_view m_bytes;
  std::size_t m_at = 0;
  std::size_t m_count = 0;
  std::string m_failure;
};

Error unreadable(const std::string& why) {
  return {ErrorCode::kInvalidInput, "rosbridge binary frame: " + why};
}

}  // namespace

Result<Json> readCbor(std::string_view bytes) {
  if (bytes.size() > kMaxFrameBytes) {
    return unreadable(std::to_string(bytes.size()) + " bytes; at most " + std::to_string(kMaxFrameBytes));
  }
  try {
    CborReader reader(bytes);
    Json value;
    if (!reader.readAll(value)) return unreadable(reader.failure());
    return value;
  } catch (const std::exception& e) {
    return unreadable(e.what());
  }
}

}  // namespace longarm::rosbridge::internal
