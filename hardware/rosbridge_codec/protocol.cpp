#include "hardware/rosbridge_codec/protocol.h"

#include <exception>
#include <utility>

#include <nlohmann/json.hpp>

#include "hardware/rosbridge_codec/value_reader.h"

namespace longarm::rosbridge {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxNameLength = 4096;

// Reads the fields of one operation; the first mistake wins.
class Fields {
 public:
  explicit Fields(const Json& object, std::string op) : m_object(object), m_op(std::move(op)) {}

  std::string text(const char* key, bool required, std::string fallback = {}) {
    const auto it = m_object.find(key);
    if (it == m_object.end() || it->is_null()) {
      if (required) fail(std::string("has no \"") + key + "\"");
      return fallback;
    }
    if (!it->is_string()) {
      fail(std::string("\"") + key + "\" is not text");
      return fallback;
    }
    const auto& value = it->get_ref<const std::string&>();
    if (value.size() > kMaxNameLength) {
      fail(std::string("\"") + key + "\" is longer than " + std::to_string(kMaxNameLength) + " characters");
      return fallback;
    }
    return value;
  }

  // An id may be text or a number.
  std::string id() {
    const auto it = m_object.find("id");
    if (it != m_object.end() && it->is_number_integer()) return it->dump();
    return text("id", false);
  }

  int count(const char* key) {
    const auto it = m_object.find(key);
    if (it == m_object.end() || it->is_null()) return 0;
    if (!it->is_number()) {
      fail(std::string("\"") + key + "\" is not a number");
      return 0;
    }
    const double value = it->get<double>();
    if (!(value >= 0 && value <= 1e9)) {
      fail(std::string("\"") + key + "\" is " + it->dump() + "; expected 0 ... 1e9");
      return 0;
    }
    return static_cast<int>(value);
  }

  bool flag(const char* key, bool fallback) {
    const auto it = m_object.find(key);
    if (it == m_object.end() || it->is_null()) return fallback;
    if (!it->is_boolean()) fail(std::string("\"") + key + "\" is neither true nor false");
    return it->is_boolean() ? it->get<bool>() : fallback;
  }

  Body body(const char* key, bool required) {
    const auto it = m_object.find(key);
    if (it == m_object.end() || it->is_null()) {
      if (required) fail(std::string("has no \"") + key + "\"");
      return {};
    }
    return Body(*it);
  }

  Result<Operation> finish(Operation operation) const {
    if (!m_failure.empty()) {
      return Error{ErrorCode::kInvalidInput, "rosbridge \"" + m_op + "\": " + m_failure};
    }
    return operation;
  }

 private:
  void fail(std::string why) {
    if (m_failure.empty()) m_failure = std::move(why);
  }

  const Json& m_object;
  std::string m_op;
  std::string m_failure;
};

Result<Operation> decodeNamed(const std::string& op, Fields f) {
  if (op == "publish") {
    Publish out{f.text("topic", true), f.body("msg", true), f.id()};
    return f.finish(std::move(out));
  }
  if (op == "subscribe") {
    Subscribe out{f.text("topic", true), f.text("type", false), f.count("throttle_rate"), f.count("queue_length"),
                  f.text("compression", false, "none"), f.id()};
    return f.finish(std::move(out));
  }
  if (op == "unsubscribe") return f.finish(Unsubscribe{f.text("topic", true), f.id()});
  if (op == "advertise") return f.finish(Advertise{f.text("topic", true), f.text("type", true), f.id()});
  if (op == "unadvertise") return f.finish(Unadvertise{f.text("topic", true), f.id()});
  if (op == "call_service") {
    return f.finish(CallService{f.text("service", true), f.body("args", false), f.id()});
  }
  if (op == "service_response") {
    ServiceResponse out{f.text("service", false), f.body("values", false), f.flag("result", true), f.id()};
    return f.finish(std::move(out));
  }
  if (op == "status") return f.finish(StatusReport{f.text("level", false, "error"), f.text("msg", false), f.id()});
  return Error{ErrorCode::kInvalidInput,
               "rosbridge operation \"" + op.substr(0, 40) + "\" is unknown; expected publish, subscribe, "
               "unsubscribe, advertise, unadvertise, call_service, service_response or status"};
}

Result<Operation> decodeValue(Result<Json> frame) {
  if (!frame) return frame.error();
  try {
    if (!frame->is_object()) return Error{ErrorCode::kInvalidInput, "rosbridge frame: is not an object"};
    const auto op = frame->find("op");
    if (op == frame->end() || !op->is_string()) {
      return Error{ErrorCode::kInvalidInput, "rosbridge frame: has no \"op\""};
    }
    const auto name = op->get<std::string>();
    return decodeNamed(name, Fields(*frame, name.substr(0, 40)));
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInternal, std::string("rosbridge frame: ") + e.what()};
  }
}

Json withId(Json object, const std::string& id) {
  if (!id.empty()) object["id"] = id;
  return object;
}

struct ToValue {
  Json operator()(const Advertise& o) const {
    return withId({{"op", "advertise"}, {"topic", o.topic}, {"type", o.type}}, o.id);
  }
  Json operator()(const Unadvertise& o) const { return withId({{"op", "unadvertise"}, {"topic", o.topic}}, o.id); }
  Json operator()(const Publish& o) const {
    return withId({{"op", "publish"}, {"topic", o.topic}, {"msg", o.message.json()}}, o.id);
  }
  Json operator()(const Subscribe& o) const {
    Json out = {{"op", "subscribe"}, {"topic", o.topic}};
    if (!o.type.empty()) out["type"] = o.type;
    if (o.throttle_rate_ms > 0) out["throttle_rate"] = o.throttle_rate_ms;
    if (o.queue_length > 0) out["queue_length"] = o.queue_length;
    if (o.compression != "none") out["compression"] = o.compression;
    return withId(std::move(out), o.id);
  }
  Json operator()(const Unsubscribe& o) const { return withId({{"op", "unsubscribe"}, {"topic", o.topic}}, o.id); }
  Json operator()(const CallService& o) const {
    return withId({{"op", "call_service"}, {"service", o.service}, {"args", o.args.json()}}, o.id);
  }
  Json operator()(const ServiceResponse& o) const {
    return withId(
        {{"op", "service_response"}, {"service", o.service}, {"values", o.values.json()}, {"result", o.result}}, o.id);
  }
  Json operator()(const StatusReport& o) const {
    return withId({{"op", "status"}, {"level", o.level}, {"msg", o.text}}, o.id);
  }
};

}  // namespace

std::string encodeText(const Operation& operation) {
  try {
    return Body(std::visit(ToValue{}, operation)).text();
  } catch (const std::exception&) {   // only for want of memory
    return {};
  }
}

std::string encodeBinary(const Operation& operation) {
  try {
    std::string out;
    Json::to_cbor(std::visit(ToValue{}, operation), nlohmann::detail::output_adapter<char, std::string>(out));
    return out;
  } catch (const std::exception&) {
    return {};
  }
}

Result<Operation> decodeText(std::string_view frame) { return decodeValue(internal::readJson(frame)); }

Result<Operation> decodeBinary(std::string_view frame) { return decodeValue(internal::readCbor(frame)); }

}  // namespace longarm::rosbridge
