/// OBJ: vertices and faces; everything else of the format is skipped.

#include <cmath>
#include <vector>

#include "core/text.h"
#include "planning/world/mesh_file.h"

namespace longarm::planning::internal {
namespace {

class ObjParser {
 public:
  ObjParser(std::string_view content, const std::string& name, const MeshLimits& limits)
      : m_content(content), m_name(name), m_limits(limits) {}

  Result<TriangleMesh> run() {
    std::size_t begin = 0;
    while (begin < m_content.size()) {
      ++m_line;
      const std::size_t end = std::min(m_content.find('\n', begin), m_content.size());
      if (const Status status = line(m_content.substr(begin, end - begin)); !status) return status.error();
      begin = end + 1;
    }
    return std::move(m_mesh);
  }

 private:
  Status line(std::string_view text) {
    splitWords(text);
    if (m_words.empty()) return {};
    if (m_words[0] == "v") return vertex();
    if (m_words[0] == "f") return face();
    return {};
  }

  void splitWords(std::string_view text) {
    m_words.clear();
    std::size_t at = 0;
    while (at < text.size()) {
      while (at < text.size() && (text[at] == ' ' || text[at] == '\t' || text[at] == '\r')) ++at;
      const std::size_t begin = at;
      while (at < text.size() && text[at] != ' ' && text[at] != '\t' && text[at] != '\r') ++at;
      if (at > begin) m_words.push_back(text.substr(begin, at - begin));
    }
  }

  Status vertex() {
    if (m_words.size() < 4) return bad("v x y z", "only " + std::to_string(m_words.size() - 1) + " numbers");
    if (m_mesh.vertices.size() >= 3 * m_limits.max_triangles) return bad("fewer vertices", "more");
    Eigen::Vector3d v;
    for (int i = 0; i < 3; ++i) {
      const auto word = m_words[static_cast<std::size_t>(i) + 1];
      const auto number = parseNumber(word);
      if (!number || !std::isfinite(*number)) return bad("a finite number", std::string(word.substr(0, 40)));
      v[i] = *number;
    }
    m_mesh.vertices.push_back(v);
    return {};
  }

  Status face() {
    if (m_words.size() < 4) return bad("a face of three or more vertices", std::to_string(m_words.size() - 1));
    m_face.clear();
    for (std::size_t i = 1; i < m_words.size(); ++i) {
      const auto index = vertexIndex(m_words[i]);
      if (!index) return index.error();
      m_face.push_back(*index);
    }
    for (std::size_t i = 2; i < m_face.size(); ++i) {
      if (m_mesh.triangles.size() >= m_limits.max_triangles) {
        return bad("at most " + std::to_string(m_limits.max_triangles) + " triangles", "more");
      }
      m_mesh.triangles.push_back({m_face[0], m_face[i - 1], m_face[i]});
    }
    return {};
  }

  /// "7", "7/1", "7//3", "7/1/3"; negative ones count back from the last vertex.
  Result<int> vertexIndex(std::string_view word) const {
    const auto number = parseInteger(word.substr(0, word.find('/')));
    const auto count = static_cast<long long>(m_mesh.vertices.size());
    const long long index = !number ? -1 : *number > 0 ? *number - 1 : *number < 0 ? count + *number : -1;
    if (index < 0 || index >= count) {
      return bad("a vertex between 1 and " + std::to_string(count), std::string(word.substr(0, 40)));
    }
    return static_cast<int>(index);
  }

  Error bad(const std::string& wanted, const std::string& got) const {
    return {ErrorCode::kInvalidInput,
            m_name + ":" + std::to_string(m_line) + ": expected " + wanted + ", got \"" + got + "\""};
  }

  std::string_view m_content;
  const std::string& m_name;
  MeshLimits m_limits;
  int m_line = 0;
  TriangleMesh m_mesh;
  std::vector<std::string_view> m_words;
  std::vector<int> m_face;
};

}  // namespace

Result<TriangleMesh> parseObj(std::string_view content, const std::string& name, const MeshLimits& limits) {
  return ObjParser(content, name, limits).run();
}

}  // namespace longarm::planning::internal
