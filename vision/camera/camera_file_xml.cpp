// OpenCV's FileStorage XML, read with pugixml: cv::FileStorage can be made to spin for minutes.
#include <cmath>
#include <sstream>
#include <vector>

#include <nlohmann/json.hpp>
#include <pugixml.hpp>

#include "core/text.h"
#include "vision/camera/camera_file_internal.h"

namespace longarm::vision::internal {
namespace {

using nlohmann::json;

constexpr int kMaxDepth = 16;
constexpr std::size_t kMaxElements = 20000, kMaxNumbers = 200000;

Error broken(const std::string& what) { return {ErrorCode::kInvalidInput, what}; }

std::size_t lineAt(std::string_view text, std::ptrdiff_t offset) {
  std::size_t line = 1;
  for (std::ptrdiff_t i = 0; i < offset && i < static_cast<std::ptrdiff_t>(text.size()); ++i) {
    if (text[static_cast<std::size_t>(i)] == '\n') ++line;
  }
  return line;
}

json wordOf(std::string_view word) {
  if (const auto integer = parseInteger(word)) return *integer;
  if (const auto number = parseNumber(word); number && std::isfinite(*number)) return *number;
  return std::string(word);
}

// Text of an element: one word, a list of words, or a quoted string.
json textValue(std::string_view text, std::size_t* numbers) {
  text = trimmed(text);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') return std::string(text.substr(1, text.size() - 2));
  json words = json::array();
  std::size_t at = 0;
  while (at < text.size() && *numbers < kMaxNumbers) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n", at);
    if (begin == std::string_view::npos) break;
    const std::size_t end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
    words.push_back(wordOf(text.substr(begin, end - begin)));
    ++*numbers;
    at = end;
  }
  if (words.empty()) return nullptr;
  if (words.size() == 1) return words[0];
  // A sentence stays a sentence; only lists of numbers become lists.
  for (const auto& word : words) {
    if (!word.is_number()) return std::string(text);
  }
  return words;
}

struct Converter {
  std::size_t elements = 0, numbers = 0;
  std::string failure;

  json convert(const pugi::xml_node& node, int depth) {
    if (depth > kMaxDepth || ++elements > kMaxElements) {
      failure = "nested deeper than " + std::to_string(kMaxDepth) + " levels or more than " +
                std::to_string(kMaxElements) + " elements";
      return nullptr;
    }
    json object = json::object(), list = json::array();
    for (const auto& child : node.children()) {
      if (child.type() != pugi::node_element || !failure.empty()) continue;
      json value = convert(child, depth + 1);
      const std::string name = child.name();
      if (name == "_") {
        list.push_back(std::move(value));
      } else if (object.contains(name)) {
        failure = "element <" + name.substr(0, 60) + "> is given twice";
      } else {
        object[name] = std::move(value);
      }
    }
    if (!object.empty()) return object;
    return list.empty() ? textValue(node.text().get(), &numbers) : list;
  }
};

constexpr unsigned int kParseFlags =
    pugi::parse_cdata | pugi::parse_escapes | pugi::parse_doctype | pugi::parse_eol | pugi::parse_wconv_attribute;

Status load(std::string_view text, pugi::xml_document* document) {
  const auto result = document->load_buffer(text.data(), text.size(), kParseFlags, pugi::encoding_utf8);
  if (!result) {
    return broken("line " + std::to_string(lineAt(text, result.offset)) + ": broken XML: " + result.description());
  }
  for (const auto& node : document->children()) {
    if (node.type() == pugi::node_doctype) {
      return broken("document type declarations (<!DOCTYPE ...>) are not accepted; remove it");
    }
  }
  return {};
}

}  // namespace

Result<json> jsonFromOpenCvXml(std::string_view text) {
  pugi::xml_document document;
  if (auto status = load(text, &document); !status) return status.error();
  const pugi::xml_node root = document.document_element();
  if (std::string(root.name()) != "opencv_storage") {
    return broken("root element is <" + std::string(root.name()).substr(0, 60) +
                  ">; expected <opencv_storage> or <SR_world>");
  }
  Converter converter;
  json out = converter.convert(root, 0);
  if (!converter.failure.empty()) return broken(converter.failure);
  if (converter.numbers >= kMaxNumbers) return broken("more than " + std::to_string(kMaxNumbers) + " numbers");
  return out;
}

bool isZoomXml(std::string_view text) {
  pugi::xml_document document;
  return load(text, &document).ok() && std::string(document.document_element().name()) == "SR_world";
}

}  // namespace longarm::vision::internal
