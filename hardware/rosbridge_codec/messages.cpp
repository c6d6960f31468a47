#include "hardware/rosbridge_codec/messages.h"

#include <cmath>
#include <cstring>
#include <exception>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "hardware/rosbridge_codec/value_reader.h"

namespace longarm::rosbridge {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxJoints = 1024;
constexpr std::size_t kMaxPoints = 10000;
constexpr std::size_t kMaxName = 4096;
constexpr double kMaxSeconds = 1e11;     // far beyond any clock, small enough for 64-bit nanoseconds

// Raised only inside this file and caught at its edge.
struct BadField : std::exception {
  std::string text;
  explicit BadField(std::string t) : text(std::move(t)) {}
  const char* what() const noexcept override { return text.c_str(); }
};

bool hasBinary(const Json& value) {
  if (value.is_binary()) return true;
  if (!value.is_structured()) return false;
  for (const auto& item : value) {
    if (hasBinary(item)) return true;
  }
  return false;
}

std::string bytesOf(const Json& value) {
  const auto& bytes = value.get_binary();
  return std::string(bytes.begin(), bytes.end());
}

// JSON text has no binary data: as rosbridge does, it becomes base64.
Json textForm(const Json& value) {
  if (value.is_binary()) return encodeBase64(bytesOf(value));
  if (!value.is_structured()) return value;
  Json out = value.is_array() ? Json::array() : Json::object();
  for (const auto& item : value.items()) {
    if (value.is_array()) {
      out.push_back(textForm(item.value()));
    } else {
      out[item.key()] = textForm(item.value());
    }
  }
  return out;
}

const Json* find(const Json& object, const char* key, const char* other = nullptr) {
  if (!object.is_object()) throw BadField("is not an object");
  auto it = object.find(key);
  if (it == object.end() && other != nullptr) it = object.find(other);
  return it == object.end() || it->is_null() ? nullptr : &*it;
}

const Json& need(const Json& object, const char* key, const char* other = nullptr) {
  const Json* value = find(object, key, other);
  if (value == nullptr) throw BadField(std::string("has no \"") + key + "\"");
  return *value;
}

double number(const Json& value, const char* key) {
  if (!value.is_number()) throw BadField(std::string("\"") + key + "\" is not a number");
  return value.get<double>();
}

std::string text(const Json& value, const char* key) {
  if (!value.is_string()) throw BadField(std::string("\"") + key + "\" is not text");
  const auto& s = value.get_ref<const std::string&>();
  if (s.size() > kMaxName) throw BadField(std::string("\"") + key + "\" is too long");
  return s;
}

// A typed array as rosbridge writes number arrays in CBOR (RFC 8746): little-endian float64 or float32.
template <typename Scalar>
std::vector<double> typedArray(const std::string& bytes, const char* key) {
  if (bytes.size() % sizeof(Scalar) != 0) throw BadField(std::string("\"") + key + "\" is cut short");
  std::vector<double> out(bytes.size() / sizeof(Scalar));
  for (std::size_t i = 0; i < out.size(); ++i) {
    Scalar value;
    std::memcpy(&value, bytes.data() + i * sizeof(Scalar), sizeof(Scalar));
    out[i] = static_cast<double>(value);
  }
  return out;
}

std::vector<double> numbers(const Json* value, const char* key) {
  std::vector<double> out;
  if (value == nullptr) return out;
  if (value->is_binary()) {
    const auto& binary = value->get_binary();
    const auto tag = binary.has_subtype() ? binary.subtype() : 0;
    if (tag == 86) out = typedArray<double>(bytesOf(*value), key);
    else if (tag == 85) out = typedArray<float>(bytesOf(*value), key);
    else throw BadField(std::string("\"") + key + "\" is a typed array of an unknown kind");
  } else if (value->is_array()) {
    if (value->size() > kMaxJoints) throw BadField(std::string("\"") + key + "\" has too many entries");
    for (const auto& item : *value) out.push_back(number(item, key));
  } else {
    throw BadField(std::string("\"") + key + "\" is not a list");
  }
  if (out.size() > kMaxJoints) throw BadField(std::string("\"") + key + "\" has too many entries");
  return out;
}

std::vector<std::string> names(const Json* value, const char* key) {
  std::vector<std::string> out;
  if (value == nullptr) return out;
  if (!value->is_array() || value->size() > kMaxJoints) {
    throw BadField(std::string("\"") + key + "\" is not a list of at most " + std::to_string(kMaxJoints));
  }
  for (const auto& item : *value) out.push_back(text(item, key));
  return out;
}

template <std::size_t N>
std::array<double, N> matrix(const Json* value, const char* key) {
  const auto list = numbers(value, key);
  if (list.size() != N) {
    throw BadField(std::string("\"") + key + "\" has " + std::to_string(list.size()) + " numbers; expected " +
                   std::to_string(N));
  }
  std::array<double, N> out{};
  std::copy(list.begin(), list.end(), out.begin());
  return out;
}

std::array<double, 3> readVector(const Json& value) {
  return {number(need(value, "x"), "x"), number(need(value, "y"), "y"), number(need(value, "z"), "z")};
}

std::array<double, 4> readQuaternion(const Json& q) {
  return {number(need(q, "x"), "x"), number(need(q, "y"), "y"), number(need(q, "z"), "z"), number(need(q, "w"), "w")};
}

TwistMessage readTwist(const Json& value) {
  return {readVector(need(value, "linear")), readVector(need(value, "angular"))};
}

Json vectorJson(const std::array<double, 3>& v) { return {{"x", v[0]}, {"y", v[1]}, {"z", v[2]}}; }

Json quaternionJson(const std::array<double, 4>& q) { return {{"x", q[0]}, {"y", q[1]}, {"z", q[2]}, {"w", q[3]}}; }

Json twistJson(const TwistMessage& m) {
  return {{"linear", vectorJson(m.linear)}, {"angular", vectorJson(m.angular)}};
}

double readTime(const Json& value, const char* key) {
  if (!value.is_object()) throw BadField(std::string("\"") + key + "\" is not a time");
  const Json* sec = find(value, "secs", "sec");
  const Json* nsec = find(value, "nsecs", "nanosec");
  const double s = sec == nullptr ? 0 : number(*sec, key);
  const double ns = nsec == nullptr ? 0 : number(*nsec, key);
  if (!(std::abs(s) <= kMaxSeconds && std::abs(ns) <= 4.3e9)) {
    throw BadField(std::string("\"") + key + "\" is out of range");
  }
  return s + ns * 1e-9;
}

Json writeTime(double seconds, Dialect dialect) {
  const bool valid = std::isfinite(seconds) && std::abs(seconds) <= kMaxSeconds;
  const auto whole = valid ? static_cast<std::int64_t>(std::floor(seconds)) : 0;
  auto nanos = valid ? std::llround((seconds - static_cast<double>(whole)) * 1e9) : 0;
  const std::int64_t carry = nanos >= 1'000'000'000 ? 1 : 0;
  nanos -= carry * 1'000'000'000;
  if (dialect == Dialect::kRos2) return {{"sec", whole + carry}, {"nanosec", nanos}};
  return {{"secs", whole + carry}, {"nsecs", nanos}};
}

Header readHeader(const Json& object) {
  Header out;
  const Json* header = find(object, "header");
  if (header == nullptr) return out;
  if (const Json* seq = find(*header, "seq")) {
    const double value = number(*seq, "seq");
    out.seq = value >= 0 && value <= 4294967295.0 ? static_cast<std::uint32_t>(value) : 0u;
  }
  if (const Json* stamp = find(*header, "stamp")) out.stamp_s = readTime(*stamp, "stamp");
  if (const Json* frame = find(*header, "frame_id")) out.frame_id = text(*frame, "frame_id");
  return out;
}

Json writeHeader(const Header& header, Dialect dialect) {
  Json out = {{"stamp", writeTime(header.stamp_s, dialect)}, {"frame_id", header.frame_id}};
  if (dialect == Dialect::kRos1) out["seq"] = header.seq;
  return out;
}

JointTrajectoryPointMessage readPoint(const Json& value) {
  JointTrajectoryPointMessage out;
  out.positions = numbers(find(value, "positions"), "positions");
  out.velocities = numbers(find(value, "velocities"), "velocities");
  out.accelerations = numbers(find(value, "accelerations"), "accelerations");
  out.time_from_start_s = readTime(need(value, "time_from_start"), "time_from_start");
  return out;
}

void checkSizes(const JointStateMessage& m) {
  for (const auto* list : {&m.position, &m.velocity, &m.effort}) {
    if (!list->empty() && list->size() != m.name.size()) {
      throw BadField("has " + std::to_string(m.name.size()) + " names but " + std::to_string(list->size()) +
                     " numbers beside them");
    }
  }
}

// Runs a reader and turns what it throws into the sentence of its message type.
template <typename Message, typename Reader>
Status guarded(const Body& body, Message& message, Reader reader) {
  try {
    Message out;
    reader(body.json(), out);
    message = std::move(out);
    return {};
  } catch (const std::exception& e) {
    return {ErrorCode::kInvalidInput, std::string(Message::kType) + " message: " + e.what()};
  }
}

}  // namespace

Body::Body() : m_value(std::make_shared<const Json>(Json::object())) {}

Body::Body(Json value) : m_value(std::make_shared<const Json>(std::move(value))) {}

std::string Body::text() const {
  constexpr auto kReplace = Json::error_handler_t::replace;   // broken UTF-8 never throws
  if (!hasBinary(*m_value)) return m_value->dump(-1, ' ', false, kReplace);
  return textForm(*m_value).dump(-1, ' ', false, kReplace);
}

Result<Body> Body::parse(std::string_view json_text) {
  auto value = internal::readJson(json_text);
  if (!value) return value.error();
  return Body(std::move(*value));
}

Body write(const JointStateMessage& m, Dialect dialect) {
  return Body(Json{{"header", writeHeader(m.header, dialect)},
                   {"name", m.name},
                   {"position", m.position},
                   {"velocity", m.velocity},
                   {"effort", m.effort}});
}

Body write(const JointTrajectoryMessage& m, Dialect dialect) {
  Json points = Json::array();
  for (const auto& p : m.points) {
    points.push_back({{"positions", p.positions},
                      {"velocities", p.velocities},
                      {"accelerations", p.accelerations},
                      {"effort", Json::array()},
                      {"time_from_start", writeTime(p.time_from_start_s, dialect)}});
  }
  return Body(Json{{"header", writeHeader(m.header, dialect)},
                   {"joint_names", m.joint_names},
                   {"points", std::move(points)}});
}

Body write(const CompressedImageMessage& m, Dialect dialect) {
  Json out = {{"header", writeHeader(m.header, dialect)}, {"format", m.format}};
  out["data"] = Json::binary(Json::binary_t::container_type(m.data.begin(), m.data.end()));
  return Body(std::move(out));
}

Body write(const CameraInfoMessage& m, Dialect dialect) {
  const bool upper = dialect == Dialect::kRos1;
  return Body(Json{{"header", writeHeader(m.header, dialect)},
                   {"height", m.height},
                   {"width", m.width},
                   {"distortion_model", m.distortion_model},
                   {upper ? "D" : "d", m.d},
                   {upper ? "K" : "k", m.k},
                   {upper ? "R" : "r", m.r},
                   {upper ? "P" : "p", m.p}});
}

Body write(const Float64Message& m, Dialect) { return Body(Json{{"data", m.data}}); }
Body write(const TwistMessage& m, Dialect) { return Body(twistJson(m)); }

Body write(const ImuMessage& m, Dialect dialect) {
  return Body(Json{{"header", writeHeader(m.header, dialect)},
                   {"orientation", quaternionJson(m.orientation)},
                   {"orientation_covariance", m.orientation_covariance},
                   {"angular_velocity", vectorJson(m.angular_velocity)},
                   {"linear_acceleration", vectorJson(m.linear_acceleration)}});
}

Body write(const OdometryMessage& m, Dialect dialect) {
  return Body(Json{{"header", writeHeader(m.header, dialect)},
                   {"child_frame_id", m.child_frame_id},
                   {"pose",
                    {{"pose",
                      {{"position", vectorJson(m.position)},
                       {"orientation", quaternionJson(m.orientation)}}}}},
                   {"twist", {{"twist", twistJson(m.twist)}}}});
}

Body write(const BoolMessage& m, Dialect) { return Body(Json{{"data", m.data}}); }
Body write(const StringMessage& m, Dialect) { return Body(Json{{"data", m.data}}); }
Body write(const EmptyMessage&, Dialect) { return Body(); }

Status read(const Body& body, JointStateMessage& message) {
  return guarded(body, message, [](const Json& value, JointStateMessage& m) {
    m.header = readHeader(value);
    m.name = names(&need(value, "name"), "name");
    m.position = numbers(find(value, "position"), "position");
    m.velocity = numbers(find(value, "velocity"), "velocity");
    m.effort = numbers(find(value, "effort"), "effort");
    checkSizes(m);
  });
}

Status read(const Body& body, JointTrajectoryMessage& message) {
  return guarded(body, message, [](const Json& value, JointTrajectoryMessage& m) {
    m.header = readHeader(value);
    m.joint_names = names(&need(value, "joint_names"), "joint_names");
    const Json& points = need(value, "points");
    if (!points.is_array() || points.size() > kMaxPoints) {
      throw BadField("\"points\" is not a list of at most " + std::to_string(kMaxPoints));
    }
    for (const auto& point : points) m.points.push_back(readPoint(point));
  });
}

Status read(const Body& body, CompressedImageMessage& message) {
  return guarded(body, message, [](const Json& value, CompressedImageMessage& m) {
    m.header = readHeader(value);
    m.format = text(need(value, "format"), "format");
    const Json& data = need(value, "data");
    if (data.is_binary()) {
      m.data = bytesOf(data);
      return;
    }
    if (!data.is_string()) throw BadField("\"data\" is neither bytes nor base64 text");
    auto bytes = decodeBase64(data.get_ref<const std::string&>());
    if (!bytes) throw BadField("\"data\": " + bytes.error().message);
    m.data = std::move(*bytes);
  });
}

Status read(const Body& body, CameraInfoMessage& message) {
  return guarded(body, message, [](const Json& value, CameraInfoMessage& m) {
    m.header = readHeader(value);
    const double height = number(need(value, "height"), "height");
    const double width = number(need(value, "width"), "width");
    if (!(height >= 0 && height <= 65536 && width >= 0 && width <= 65536)) {
      throw BadField("\"width\" or \"height\" is not within 0 ... 65536");
    }
    m.height = static_cast<std::uint32_t>(height);
    m.width = static_cast<std::uint32_t>(width);
    m.distortion_model = text(need(value, "distortion_model"), "distortion_model");
    m.d = numbers(find(value, "D", "d"), "D");
    m.k = matrix<9>(find(value, "K", "k"), "K");
    if (const Json* r = find(value, "R", "r")) m.r = matrix<9>(r, "R");
    if (const Json* p = find(value, "P", "p")) m.p = matrix<12>(p, "P");
  });
}

Status read(const Body& body, TwistMessage& message) {
  return guarded(body, message, [](const Json& value, TwistMessage& m) { m = readTwist(value); });
}

// What else it may hold (rates, accelerations) nobody here asks for.
Status read(const Body& body, ImuMessage& message) {
  return guarded(body, message, [](const Json& value, ImuMessage& m) {
    m.header = readHeader(value);
    m.orientation = readQuaternion(need(value, "orientation"));
    if (const Json* covariance = find(value, "orientation_covariance")) m.orientation_covariance = matrix<9>(covariance, "orientation_covariance");
  });
}

Status read(const Body& body, OdometryMessage& message) {
  return guarded(body, message, [](const Json& value, OdometryMessage& m) {
    m.header = readHeader(value);
    if (const Json* frame = find(value, "child_frame_id")) m.child_frame_id = text(*frame, "child_frame_id");
    const Json& pose = need(need(value, "pose"), "pose");
    m.position = readVector(need(pose, "position"));
    m.orientation = readQuaternion(need(pose, "orientation"));
    m.twist = readTwist(need(need(value, "twist"), "twist"));
  });
}

Status read(const Body& body, Float64Message& message) {
  return guarded(body, message,
                 [](const Json& value, Float64Message& m) { m.data = number(need(value, "data"), "data"); });
}

Status read(const Body& body, BoolMessage& message) {
  return guarded(body, message, [](const Json& value, BoolMessage& m) {
    const Json& data = need(value, "data");
    if (!data.is_boolean()) throw BadField("\"data\" is neither true nor false");
    m.data = data.get<bool>();
  });
}

Status read(const Body& body, StringMessage& message) {
  return guarded(body, message, [](const Json& value, StringMessage& m) {
    const Json& data = need(value, "data");
    if (!data.is_string()) throw BadField("\"data\" is not text");
    m.data = data.get<std::string>();
  });
}

Status read(const Body& body, EmptyMessage& message) {
  return guarded(body, message, [](const Json& value, EmptyMessage&) { find(value, ""); });
}

}  // namespace longarm::rosbridge
