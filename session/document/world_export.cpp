#include "session/document/world_export.h"

#include <array>
#include <cstring>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "session/document/template_json.h"
#include "planning/world/shape_triangles.h"

namespace longarm::session {

using Eigen::Vector3d;
using nlohmann::json;

namespace {

struct Mesh {
  std::string name;
  std::vector<Vector3d> vertices;            // in the world
  std::vector<std::array<int, 3>> triangles;
};

Mesh meshOf(const planning::WorldObject& body) {
  const auto shape = planning::trianglesOf(body.shape);
  Mesh mesh{body.name, {}, shape->triangles};
  for (const auto& p : shape->vertices) mesh.vertices.push_back(body.X_WO * p);
  return mesh;
}

std::vector<Mesh> meshesOf(const std::vector<WorldItem>& items) {
  std::vector<Mesh> meshes;
  for (const auto& item : items) {
    for (const auto& body : bodiesOf(item, false)) meshes.push_back(meshOf(body));
  }
  return meshes;
}

std::string plainName(const std::string& name) {
  std::string plain = name;
  for (char& c : plain) {
    if (static_cast<unsigned char>(c) <= ' ') c = '_';
  }
  return plain.empty() ? "body" : plain;
}

void append32(std::string& out, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) out += static_cast<char>((value >> (8 * i)) & 0xff);
}

void appendFloat(std::string& out, float value) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  append32(out, bits);
}

/// What the binary part holds and how the header names it.
struct GlbParts {
  std::string binary;
  json views = json::array(), accessors = json::array(), meshes = json::array(), nodes = json::array(), roots = json::array();

  std::size_t addView(std::size_t begin, int target) {
    views.push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", binary.size() - begin}, {"target", target}});
    return views.size() - 1;
  }
};

// glTF is y up: world x, y, z become x, z, -y.
Eigen::Vector3f turned(const Vector3d& p) { return Vector3d(p.x(), p.z(), -p.y()).cast<float>(); }

void addMesh(GlbParts& parts, const Mesh& mesh) {
  constexpr int kArrayBuffer = 34962, kIndexBuffer = 34963, kFloat = 5126, kUint32 = 5125;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(3e38F), high = -low;
  const std::size_t first = parts.binary.size();
  for (const auto& vertex : mesh.vertices) {
    const Eigen::Vector3f p = turned(vertex);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    for (int i = 0; i < 3; ++i) appendFloat(parts.binary, p(i));
  }
  const std::size_t positions = parts.addView(first, kArrayBuffer);
  const std::size_t second = parts.binary.size();
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) append32(parts.binary, static_cast<std::uint32_t>(index));
  }
  const std::size_t indices = parts.addView(second, kIndexBuffer);
  parts.accessors.push_back({{"bufferView", positions}, {"componentType", kFloat}, {"count", mesh.vertices.size()}, {"type", "VEC3"},
                             {"min", {low.x(), low.y(), low.z()}}, {"max", {high.x(), high.y(), high.z()}}});
  parts.accessors.push_back({{"bufferView", indices}, {"componentType", kUint32}, {"count", 3 * mesh.triangles.size()}, {"type", "SCALAR"}});
  const std::size_t n = parts.accessors.size();
  parts.meshes.push_back({{"name", mesh.name},
                          {"primitives", {{{"attributes", {{"POSITION", n - 2}}}, {"indices", n - 1}, {"mode", 4}, {"material", 0}}}}});
  parts.nodes.push_back({{"name", mesh.name}, {"mesh", parts.meshes.size() - 1}});
  parts.roots.push_back(parts.nodes.size() - 1);
}

json vectorJson(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

std::string worldAsObj(const std::vector<WorldItem>& items) {
  std::string out = "# Sketched world, metres, z up\n";
  std::size_t base = 1;
  for (const auto& mesh : meshesOf(items)) {
    out += "o " + plainName(mesh.name) + "\n";
    for (const auto& v : mesh.vertices) out += "v " + formatNumber(v.x()) + " " + formatNumber(v.y()) + " " + formatNumber(v.z()) + "\n";
    for (const auto& t : mesh.triangles) {
      out += "f " + std::to_string(base + t[0]) + " " + std::to_string(base + t[1]) + " " + std::to_string(base + t[2]) + "\n";
    }
    base += mesh.vertices.size();
  }
  return out;
}

// Khronos, glTF 2.0 Specification, chapter 4.4: a header, a JSON chunk and a binary chunk, each a multiple of four bytes.
std::string worldAsGlb(const std::vector<WorldItem>& items) {
  GlbParts parts;
  for (const auto& mesh : meshesOf(items)) addMesh(parts, mesh);
  const json material = {{"name", "sketched"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.72, 0.55, 0.95, 1.0}}, {"metallicFactor", 0.0}}}};
  const json root = {{"asset", {{"version", "2.0"}, {"generator", "Longarm"}}}, {"scene", 0}, {"scenes", {{{"nodes", parts.roots}}}},
                     {"nodes", parts.nodes}, {"meshes", parts.meshes}, {"materials", {material}}, {"accessors", parts.accessors},
                     {"bufferViews", parts.views}, {"buffers", {{{"byteLength", parts.binary.size()}}}}};
  std::string head = root.dump(-1, ' ', false, json::error_handler_t::replace);
  while (head.size() % 4 != 0) head += ' ';
  while (parts.binary.size() % 4 != 0) parts.binary += '\0';
  std::string out = "glTF";
  append32(out, 2);
  append32(out, static_cast<std::uint32_t>(12 + 8 + head.size() + 8 + parts.binary.size()));
  append32(out, static_cast<std::uint32_t>(head.size()));
  out += "JSON" + head;
  append32(out, static_cast<std::uint32_t>(parts.binary.size()));
  out += std::string("BIN\0", 4) + parts.binary;
  return out;
}

std::string worldAsJson(const std::vector<WorldItem>& items) {
  json objects = json::array();
  for (const auto& item : items) {
    const Eigen::Vector4d q = quaternionXyzw(item.X_WO.linear());
    json object = {{"name", item.name}, {"kind", toString(item.kind)}, {"size", vectorJson(item.size)},
                   {"margin_m", item.margin_m}, {"role", toString(item.role)}};
    if (item.kind == WorldKind::kTemplate) object.update(templateJson(item));
    if (item.kind == WorldKind::kPoints) {
      for (const auto& point : item.points) object["points"].push_back(vectorJson(point));
    } else {
      object["pose"] = {{"parent", item.parent}, {"xyz", vectorJson(item.X_WO.translation())}, {"quaternion_xyzw", {q(0), q(1), q(2), q(3)}}};
    }
    objects.push_back(std::move(object));
  }
  const json root = {{"frame", items.empty() ? std::string() : items.front().parent}, {"objects", std::move(objects)}};
  return root.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

Status exportWorld(const std::string& path, const std::vector<WorldItem>& items) {
  if (items.empty()) return {ErrorCode::kInvalidInput, "There is nothing in the sketched world to export. Add a box, plane, pipe or points first."};
  for (const auto& item : items) {
    if (item.parent == items.front().parent) continue;
    return {ErrorCode::kInvalidInput, "'" + item.name + "' stands in frame " + item.parent + ", '" + items.front().name + "' in " +
                                          items.front().parent + ": a file has one frame. Remove one of them."};
  }
  const auto ends = [&path](const char* ending) {
    const std::size_t n = std::strlen(ending);
    return path.size() > n && path.compare(path.size() - n, n, ending) == 0;
  };
  if (ends(".obj")) return writeFileAtomically(path, worldAsObj(items));
  if (ends(".glb")) return writeFileAtomically(path, worldAsGlb(items));
  if (ends(".json")) return writeFileAtomically(path, worldAsJson(items));
  return {ErrorCode::kInvalidInput, path + ": the name must end in .glb, .obj or .json"};
}

}  // namespace longarm::session
