/// STL, ASCII and binary.  Equal vertices are welded, so that neighbours share them.

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "core/text.h"
#include "planning/world/mesh_file.h"

namespace longarm::planning::internal {
namespace {

constexpr std::size_t kHeader = 80, kFacet = 50;

struct VertexHash {
  std::size_t operator()(const std::array<double, 3>& v) const {
    std::size_t h = 0;
    for (const double c : v) h = h * 1000003u ^ std::hash<double>()(c);
    return h;
  }
};

/// Collects triangles and gives equal corners one index; triangles without area are left out.
class Welder {
 public:
  void add(const std::array<Eigen::Vector3d, 3>& corners) {
    std::array<int, 3> triangle{};
    for (std::size_t i = 0; i < 3; ++i) triangle[i] = indexOf(corners[i]);
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) return;
    m_mesh.triangles.push_back(triangle);
  }
  TriangleMesh take() { return std::move(m_mesh); }

 private:
  int indexOf(const Eigen::Vector3d& v) {
    const std::array<double, 3> key{v.x() + 0.0, v.y() + 0.0, v.z() + 0.0};  // -0 becomes 0.
    const auto [found, inserted] = m_known.emplace(key, static_cast<int>(m_mesh.vertices.size()));
    if (inserted) m_mesh.vertices.push_back(v);
    return found->second;
  }

  TriangleMesh m_mesh;
  std::unordered_map<std::array<double, 3>, int, VertexHash> m_known;
};

Error invalid(const std::string& name, const std::string& what) {
  return {ErrorCode::kInvalidInput, name + ": " + what};
}

float floatAt(const char* bytes) {
  float value = 0;  // STL is little endian, as is every machine this runs on.
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

Result<TriangleMesh> parseBinary(std::string_view content, std::size_t count, const std::string& name) {
  Welder welder;
  for (std::size_t i = 0; i < count; ++i) {
    const char* facet = content.data() + kHeader + 4 + i * kFacet;
    std::array<Eigen::Vector3d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) {
      const char* at = facet + 12 + 12 * c;
      corners[c] = Eigen::Vector3d(floatAt(at), floatAt(at + 4), floatAt(at + 8));
      if (!corners[c].allFinite()) {
        return invalid(name, "triangle " + std::to_string(i + 1) + " has a corner that is not finite");
      }
    }
    welder.add(corners);
  }
  return welder.take();
}

/// Words and their line numbers.
class Words {
 public:
  explicit Words(std::string_view text) : m_text(text) {}
  std::string_view next() {
    while (m_at < m_text.size() && isBlank(m_text[m_at])) m_line += m_text[m_at++] == '\n' ? 1 : 0;
    const std::size_t begin = m_at;
    while (m_at < m_text.size() && !isBlank(m_text[m_at])) ++m_at;
    return m_text.substr(begin, m_at - begin);
  }
  void skipLine() {
    while (m_at < m_text.size() && m_text[m_at] != '\n') ++m_at;
  }
  int line() const { return m_line; }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  std::string_view m_text;
  std::size_t m_at = 0;
  int m_line = 1;
};

class AsciiStl {
 public:
  AsciiStl(std::string_view content, const std::string& name, const MeshLimits& limits)
      : m_words(content), m_name(name), m_limits(limits) {}

  Result<TriangleMesh> run() {
    if (const Status status = expect("solid"); !status) return status.error();
    m_words.skipLine();
    for (std::string_view word = m_words.next();; word = m_words.next()) {
      if (word == "endsolid") {
        m_words.skipLine();
        if (m_words.next().empty()) return m_welder.take();
        m_words.skipLine();  // Another solid follows in the same file.
        continue;
      }
      if (word != "facet") return bad("facet or endsolid", word);
      if (++m_count > m_limits.max_triangles) {
        return invalid(m_name, "more than " + std::to_string(m_limits.max_triangles) + " triangles");
      }
      if (const Status status = facet(); !status) return status.error();
    }
  }

 private:
  Status facet() {
    if (const Status status = expect("normal"); !status) return status;
    if (const auto normal = vector(); !normal) return normal.error();
    for (const char* word : {"outer", "loop"}) {
      if (const Status status = expect(word); !status) return status;
    }
    std::array<Eigen::Vector3d, 3> corners;
    for (auto& corner : corners) {
      if (const Status status = expect("vertex"); !status) return status;
      const auto read = vector();
      if (!read) return read.error();
      if (!read->allFinite()) return bad("finite numbers", "a vertex that is not finite");
      corner = *read;
    }
    for (const char* word : {"endloop", "endfacet"}) {
      if (const Status status = expect(word); !status) return status;
    }
    m_welder.add(corners);
    return {};
  }

  /// Three numbers; a normal may be anything that reads as a number, "nan" too.
  Result<Eigen::Vector3d> vector() {
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) {
      const auto word = m_words.next();
      const auto number = parseNumber(word);
      if (!number) return bad("a number", word);
      v[i] = *number;
    }
    return v;
  }

  Status expect(std::string_view wanted) {
    const auto word = m_words.next();
    if (word == wanted) return {};
    return bad("\"" + std::string(wanted) + "\"", word);
  }

  Error bad(const std::string& wanted, std::string_view got) const {
    return invalid(m_name + ":" + std::to_string(m_words.line()),
                   "expected " + wanted + ", got \"" + std::string(got.substr(0, 40)) + "\"");
  }

  Words m_words;
  const std::string& m_name;
  MeshLimits m_limits;
  Welder m_welder;
  std::size_t m_count = 0;
};

}  // namespace

Result<TriangleMesh> parseStl(std::string_view content, const std::string& name, const MeshLimits& limits) {
  std::optional<std::size_t> count;
  if (content.size() >= kHeader + 4) {
    std::uint32_t stated = 0;
    std::memcpy(&stated, content.data() + kHeader, sizeof stated);
    count = stated;
  }
  if (count && content.size() == kHeader + 4 + *count * kFacet) {
    if (*count > limits.max_triangles) {
      return invalid(name, std::to_string(*count) + " triangles; at most " + std::to_string(limits.max_triangles));
    }
    return parseBinary(content, *count, name);
  }
  if (trimmed(content.substr(0, 512)).substr(0, 5) == "solid") return AsciiStl(content, name, limits).run();
  if (!count) return invalid(name, std::to_string(content.size()) + " bytes are too few for an STL");
  return invalid(name, "states " + std::to_string(*count) + " triangles, which needs " +
                           std::to_string(kHeader + 4 + *count * kFacet) + " bytes; the file has " +
                           std::to_string(content.size()));
}

}  // namespace longarm::planning::internal
