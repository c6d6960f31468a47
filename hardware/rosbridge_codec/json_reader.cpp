#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "hardware/rosbridge_codec/protocol.h"
#include "hardware/rosbridge_codec/value_reader.h"

namespace longarm::rosbridge::internal {
namespace {

using Json = nlohmann::json;

// Builds a value from parser events and stops the parser at a bound, so that a hostile frame costs no more
// memory than an honest one of the same size.
class BoundedBuilder {
 public:
  Json root;
  std::string failure;

  bool null() { return add(nullptr) != nullptr; }
  bool boolean(bool value) { return add(value) != nullptr; }
  bool number_integer(Json::number_integer_t value) { return add(value) != nullptr; }
  bool number_unsigned(Json::number_unsigned_t value) { return add(value) != nullptr; }
  bool number_float(Json::number_float_t value, const std::string&) { return add(value) != nullptr; }
  bool string(std::string& value) { return add(std::move(value)) != nullptr; }
  bool binary(Json::binary_t&) { return fail("binary data in JSON text"); }
  bool start_object(std::size_t) { return push(Json::object()); }
  bool start_array(std::size_t) { return push(Json::array()); }
  bool end_object() { return pop(); }
  bool end_array() { return pop(); }
  bool key(std::string& name) {
    m_key = std::move(name);
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception&) {
    return fail("not JSON at byte " + std::to_string(position));
  }

 private:
  bool fail(std::string why) {
    if (failure.empty()) failure = std::move(why);
    return false;
  }

  template <typename Value>
  Json* add(Value&& value) {
    if (++m_count > kMaxValues) {
      fail("more than " + std::to_string(kMaxValues) + " values");
      return nullptr;
    }
    if (m_open.empty()) {
      root = Json(std::forward<Value>(value));
      return &root;
    }
    Json& parent = *m_open.back();
    if (parent.is_array()) {
      parent.push_back(Json(std::forward<Value>(value)));
      return &parent.back();
    }
    Json& slot = parent[m_key];
    slot = Json(std::forward<Value>(value));
    return &slot;
  }

  bool push(Json container) {
    if (m_open.size() >= static_cast<std::size_t>(kMaxDepth)) {
      return fail("nested deeper than " + std::to_string(kMaxDepth) + " levels");
    }
    Json* added = add(std::move(container));
    if (added == nullptr) return false;
    m_open.push_back(added);
    return true;
  }

  bool pop() {
    m_open.pop_back();
    return true;
  }

  std::vector<Json*> m_open;
  std::string m_key;
  std::size_t m_count = 0;
};

Error unreadable(const std::string& why) { return {ErrorCode::kInvalidInput, "rosbridge frame: " + why}; }

}  // namespace

Result<Json> readJson(std::string_view text) {
  if (text.size() > kMaxFrameBytes) {
    return unreadable(std::to_string(text.size()) + " bytes; at most " + std::to_string(kMaxFrameBytes));
  }
  try {
    BoundedBuilder builder;
    if (!Json::sax_parse(text.begin(), text.end(), &builder) || !builder.failure.empty()) {
      return unreadable(builder.failure.empty() ? "not JSON" : builder.failure);
    }
    return std::move(builder.root);
  } catch (const std::exception& e) {
    return unreadable(e.what());
  }
}

}  // namespace longarm::rosbridge::internal
