#include "planning/robot/xml_bounds.h"

#include <algorithm>

#include "core/text.h"

namespace longarm::planning::internal {
namespace {

/// Walks over tags without building anything.
class TagScanner {
 public:
  TagScanner(std::string_view text, const std::string& name, const XmlBounds& bounds)
      : m_text(text), m_name(name), m_bounds(bounds) {}

  Status run() {
    if (const auto nul = m_text.find('\0'); nul != std::string_view::npos) {
      return bad(nul, "holds a NUL byte; expected XML text");
    }
    for (std::size_t at = m_text.find('<'); at != std::string_view::npos; at = m_text.find('<', m_end)) {
      if (const Status status = tag(at); !status) return status;
    }
    return {};
  }

 private:
  Status tag(std::size_t at) {
    const std::string_view rest = m_text.substr(at);
    if (rest.substr(0, 4) == "<!--") return skipTo(at, 4, "-->");
    if (rest.substr(0, 9) == "<![CDATA[") return skipTo(at, 9, "]]>");
    if (rest.substr(0, 2) == "<?") return skipTo(at, 2, "?>");
    if (rest.substr(0, 2) == "<!") {
      return bad(at, "holds a document type declaration; remove it: entities are not read");
    }
    return element(at);
  }

  Status element(std::size_t at) {
    const bool closing = at + 1 < m_text.size() && m_text[at + 1] == '/';
    const std::size_t end = endOfTag(at);
    if (end == std::string_view::npos) return bad(at, "has a tag without an end (\">\")");
    m_end = end + 1;
    if (closing) {
      --m_depth;
      return {};
    }
    if (++m_elements > m_bounds.max_elements) {
      return bad(at, "has more than " + std::to_string(m_bounds.max_elements) + " elements");
    }
    if (++m_depth > m_bounds.max_depth) {
      return bad(at, "is nested deeper than " + std::to_string(m_bounds.max_depth) + " elements");
    }
    if (m_text[end - 1] == '/') --m_depth;
    return {};
  }

  /// The ">" that ends a tag, attribute values in quotes skipped.
  std::size_t endOfTag(std::size_t at) const {
    char quote = 0;
    for (std::size_t i = at + 1; i < m_text.size(); ++i) {
      const char c = m_text[i];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        return i;
      }
    }
    return std::string_view::npos;
  }

  Status skipTo(std::size_t at, std::size_t opening, std::string_view closing) {
    const std::size_t end = m_text.find(closing, at + opening);
    if (end == std::string_view::npos) {
      return bad(at, "has a comment or section without its end \"" + std::string(closing) + "\"");
    }
    m_end = end + closing.size();
    return {};
  }

  Status bad(std::size_t at, const std::string& what) const {
    return Error{ErrorCode::kInvalidInput,
                 m_name + ":" + std::to_string(lineOfOffset(m_text, at)) + ": the file " + what};
  }

  std::string_view m_text;
  const std::string& m_name;
  XmlBounds m_bounds;
  std::size_t m_end = 0;
  int m_depth = 0, m_elements = 0;
};

}  // namespace

int lineOfOffset(std::string_view text, std::size_t offset) {
  offset = std::min(offset, text.size());
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<long>(offset), '\n'));
}

Status checkXmlBounds(std::string_view text, const std::string& name, const XmlBounds& bounds) {
  if (text.size() > bounds.max_bytes) {
    return Error{ErrorCode::kInvalidInput, name + ": " + std::to_string(text.size()) + " bytes; at most " +
                                               std::to_string(bounds.max_bytes) + " are read"};
  }
  return TagScanner(text, name, bounds).run();
}

Result<std::string> readBoundedXml(const std::string& path, const XmlBounds& bounds) {
  auto text = readTextFile(path, bounds.max_bytes);
  if (!text) return text.error();
  if (const Status status = checkXmlBounds(*text, path, bounds); !status) return status.error();
  return text;
}

}  // namespace longarm::planning::internal
