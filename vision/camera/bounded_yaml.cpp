#include "vision/camera/bounded_yaml.h"

#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <nlohmann/json.hpp>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include "core/text.h"

namespace longarm::vision {
namespace {

using nlohmann::json;

struct YamlRefusal : std::runtime_error {
  using std::runtime_error::runtime_error;
};

[[noreturn]] void refuse(const YAML::Mark& mark, const std::string& what) {
  throw YamlRefusal("line " + std::to_string(mark.line + 1) + ": " + what);
}

json scalarOf(const std::string& tag, const std::string& value) {
  // "?" is yaml-cpp's tag of a plain scalar, "!" of a quoted one.
  if (tag != "?" && !tag.empty()) return value;
  if (value == "~" || value == "null" || value == "Null" || value == "NULL") return nullptr;
  if (value == "true" || value == "True" || value == "TRUE") return true;
  if (value == "false" || value == "False" || value == "FALSE") return false;
  if (const auto integer = parseInteger(value)) return *integer;
  if (const auto number = parseNumber(value); number && std::isfinite(*number)) return *number;
  return value;
}

std::size_t countValues(const json& value) {
  std::size_t count = 1;
  if (value.is_structured()) {
    for (const auto& child : value) count += countValues(child);
  }
  return count;
}

std::size_t depthOf(const json& value) {
  if (!value.is_structured()) return 0;
  std::size_t deepest = 0;
  for (const auto& child : value) deepest = std::max(deepest, depthOf(child));
  return deepest + 1;
}

// Builds the value from the parser's events and stops it as soon as a limit is exceeded.
class JsonBuilder : public YAML::EventHandler {
 public:
  explicit JsonBuilder(const YamlLimits& limits) : m_limits(limits) {}

  json take() { return std::move(m_root); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(mark, anchor, nullptr); }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    if (!m_stack.empty() && m_stack.back().expects_key) {
      if (m_stack.back().value.contains(value)) refuse(mark, "key \"" + value.substr(0, 60) + "\" is given twice");
      m_stack.back().key = value;
      m_stack.back().expects_key = false;
      count(mark, 1);
      return;
    }
    add(mark, anchor, scalarOf(tag, value));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = m_anchors.find(anchor);
    if (found == m_anchors.end()) refuse(mark, "an alias refers to a value that contains it");
    count(mark, found->second.count);
    if (m_stack.size() + found->second.depth > m_limits.max_depth) refuseDepth(mark);
    place(mark, found->second.value);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor, json::array());
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor, json::object());
    m_stack.back().expects_key = true;
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    json value;
    YAML::Mark mark;
    YAML::anchor_t anchor = 0;
    bool expects_key = false;
    std::string key;
  };
  struct Anchor {
    json value;
    std::size_t count = 0, depth = 0;
  };

  [[noreturn]] void refuseDepth(const YAML::Mark& mark) const {
    refuse(mark, "nested deeper than " + std::to_string(m_limits.max_depth) + " levels");
  }
  void count(const YAML::Mark& mark, std::size_t values) {
    m_count += values;
    if (m_count > m_limits.max_values) {
      refuse(mark, "more than " + std::to_string(m_limits.max_values) + " values");
    }
  }
  void open(const YAML::Mark& mark, YAML::anchor_t anchor, json empty) {
    if (m_stack.size() >= m_limits.max_depth) refuseDepth(mark);
    if (!m_stack.empty() && m_stack.back().expects_key) refuse(mark, "a key must be a word, not a list or a map");
    count(mark, 1);
    m_stack.push_back({std::move(empty), mark, anchor, false, {}});
  }
  void close() {
    Level level = std::move(m_stack.back());
    m_stack.pop_back();
    remember(level.anchor, level.value);
    place(level.mark, std::move(level.value));
  }
  void add(const YAML::Mark& mark, YAML::anchor_t anchor, json value) {
    count(mark, 1);
    remember(anchor, value);
    place(mark, std::move(value));
  }
  void remember(YAML::anchor_t anchor, const json& value) {
    if (anchor == 0) return;
    const std::size_t values = countValues(value);
    m_kept += values;  // what anchors hold counts too: they are copies
    if (m_kept > m_limits.max_values) throw YamlRefusal("too many values behind anchors (&name)");
    m_anchors[anchor] = {value, values, depthOf(value)};
  }
  void place(const YAML::Mark& mark, json value) {
    if (m_stack.empty()) {
      m_root = std::move(value);
      return;
    }
    Level& top = m_stack.back();
    if (top.value.is_array()) {
      top.value.push_back(std::move(value));
      return;
    }
    if (top.expects_key) refuse(mark, "a key must be a word");
    top.value[top.key] = std::move(value);
    top.expects_key = true;
  }

  YamlLimits m_limits;
  std::size_t m_count = 0, m_kept = 0;
  std::vector<Level> m_stack;
  std::map<YAML::anchor_t, Anchor> m_anchors;
  json m_root;
};

// yaml-cpp's scanner looks ahead over all that is open; brackets are counted before it sees them.
bool opensTooDeep(std::string_view text, std::size_t limit) {
  std::size_t open = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') {
      if (++open > limit) return true;
    } else if ((c == ']' || c == '}') && open > 0) {
      --open;
    }
  }
  return false;
}

std::string withoutFileStorageHeader(std::string_view text) {
  std::string out(text);
  if (out.compare(0, 3, "\xEF\xBB\xBF") == 0) out.erase(0, 3);
  // "%YAML:1.0" is OpenCV's own; the directive is "%YAML 1.0".  A comment keeps the line numbers.
  if (out.compare(0, 6, "%YAML:") == 0) out[0] = '#';
  return out;
}

}  // namespace

Result<json> jsonFromYaml(std::string_view text, const YamlLimits& limits) {
  // A scanner that keeps lists of open flow collections is quadratic in them; ordinary files open a few
  // hundred at most before they close, counted here with what stands in comments and quotes.
  if (opensTooDeep(text, 8 * limits.max_depth)) {
    return Error{ErrorCode::kInvalidInput, "nested deeper than " + std::to_string(limits.max_depth) + " levels"};
  }
  if (text.find('\0') != std::string_view::npos) {
    return Error{ErrorCode::kInvalidInput, "holds zero bytes; this is not a YAML text"};
  }
  try {
    std::istringstream stream(withoutFileStorageHeader(text));
    stream.imbue(std::locale::classic());
    YAML::Parser parser(stream);
    JsonBuilder builder(limits);
    if (!parser.HandleNextDocument(builder)) return json(nullptr);
    JsonBuilder rest(limits);
    if (parser.HandleNextDocument(rest)) {
      return Error{ErrorCode::kInvalidInput, "holds more than one YAML document"};
    }
    return builder.take();
  } catch (const YamlRefusal& refusal) {
    return Error{ErrorCode::kInvalidInput, refusal.what()};
  } catch (const YAML::Exception& exception) {
    return Error{ErrorCode::kInvalidInput,
                 "line " + std::to_string(exception.mark.line + 1) + ": broken YAML: " + exception.msg};
  } catch (const std::exception& exception) {
    return Error{ErrorCode::kInvalidInput, std::string("broken YAML: ") + exception.what()};
  }
}

}  // namespace longarm::vision
