#include "session/document/world_export.h"

#include <array>
#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "session/document/template_json.h"

namespace longarm::session {

using Eigen::Vector3d;
using nlohmann::json;

namespace {

constexpr int kAround = 32;                  // sides of a cylinder or sphere

struct Mesh {
  std::string name;
  std::vector<Vector3d> vertices;            // in the world
  std::vector<std::array<std::uint32_t, 3>> triangles;

  std::uint32_t add(const Vector3d& p) {
    vertices.push_back(p);
    return static_cast<std::uint32_t>(vertices.size() - 1);
  }
  void quad(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  }
};

void addBox(Mesh& mesh, const Pose& X, const Vector3d& size) {
  for (int i = 0; i < 8; ++i) {
    mesh.add(X * Vector3d((i & 1 ? 0.5 : -0.5) * size.x(), (i & 2 ? 0.5 : -0.5) * size.y(), (i & 4 ? 0.5 : -0.5) * size.z()));
  }
  mesh.quad(0, 2, 3, 1);
  mesh.quad(4, 5, 7, 6);
  mesh.quad(0, 1, 5, 4);
  mesh.quad(2, 6, 7, 3);
  mesh.quad(0, 4, 6, 2);
  mesh.quad(1, 3, 7, 5);
}

// Rings from the lower end to the upper one, closed by a point at each end.
void addTurned(Mesh& mesh, const Pose& X, const std::vector<std::pair<double, double>>& radius_z, double low, double high) {
  const std::uint32_t bottom = mesh.add(X * Vector3d(0, 0, low));
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const auto& [radius, z] : radius_z) {
    for (int i = 0; i < kAround; ++i) {
      const double angle = 2 * M_PI * i / kAround;
      mesh.add(X * Vector3d(radius * std::cos(angle), radius * std::sin(angle), z));
    }
  }
  const std::uint32_t top = mesh.add(X * Vector3d(0, 0, high));
  const auto rings = static_cast<std::uint32_t>(radius_z.size());
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const std::uint32_t next = (i + 1) % kAround, last = first + (rings - 1) * kAround;
    mesh.triangles.push_back({bottom, first + next, first + i});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t here = first + ring * kAround, above = here + kAround;
      mesh.quad(here + i, here + next, above + next, above + i);
    }
    mesh.triangles.push_back({top, last + i, last + next});
  }
}

Mesh meshOf(const planning::WorldObject& body) {
  Mesh mesh;
  mesh.name = body.name;
  if (const auto* box = std::get_if<planning::Box>(&body.shape)) addBox(mesh, body.X_WO, box->size);
  if (const auto* c = std::get_if<planning::Cylinder>(&body.shape)) {
    const double half = c->length / 2;
    addTurned(mesh, body.X_WO, {{c->radius, -half}, {c->radius, half}}, -half, half);
  }
  if (const auto* s = std::get_if<planning::Sphere>(&body.shape)) {
    std::vector<std::pair<double, double>> rings;
    for (int i = 1; i < kAround / 2; ++i) {
      const double angle = M_PI * i / (kAround / 2);
      rings.emplace_back(s->radius * std::sin(angle), -s->radius * std::cos(angle));
    }
    addTurned(mesh, body.X_WO, rings, -s->radius, s->radius);
  }
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
    for (const std::uint32_t index : triangle) append32(parts.binary, index);
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
