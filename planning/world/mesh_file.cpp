#include "planning/world/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "core/printable.h"
#include "core/text.h"

namespace longarm::planning {
namespace {

std::string endingOf(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending.empty() ? ending : ending.substr(1);
}

bool isReadInChild(const std::string& ending) {
  for (const char* known : {"dae", "ply", "off", "3ds", "glb"}) {
    if (ending == known) return true;
  }
  return false;
}

Result<TriangleMesh> parse(const std::string& content, const std::string& path, const MeshLimits& limits) {
  const std::string ending = endingOf(path);
  if (ending == "stl") return internal::parseStl(content, path, limits);
  if (ending == "obj") return internal::parseObj(content, path, limits);
  if (isReadInChild(ending)) return internal::readMeshInChild(content, ending, path, limits);
  return Error{ErrorCode::kInvalidInput,
               path + ": mesh of kind \"" + ending + "\"; expected stl, obj, dae, ply, off, 3ds or glb"};
}

void applyScale(const Eigen::Vector3d& scale, TriangleMesh& mesh) {
  if (scale == Eigen::Vector3d::Ones()) return;
  for (auto& vertex : mesh.vertices) vertex = vertex.cwiseProduct(scale);
  if (scale.prod() >= 0) return;
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

}  // namespace

Result<std::shared_ptr<const TriangleMesh>> loadMesh(const std::string& path, const Eigen::Vector3d& scale,
                                                     const MeshLimits& limits) {
  const auto content = readTextFile(path, limits.max_bytes);
  if (!content) return content.error();
  auto mesh = parse(*content, path, limits);
  if (!mesh) return printable(mesh.error());
  mesh->source = path;
  applyScale(scale, *mesh);
  if (const Status status = internal::validateMesh(*mesh, path); !status) return status.error();
  return std::shared_ptr<const TriangleMesh>(std::make_shared<TriangleMesh>(*std::move(mesh)));
}

Status internal::validateMesh(const TriangleMesh& mesh, const std::string& name) {
  constexpr double kLargest = 1e6;  // [m] Beyond it squares of distances lose millimetres.
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& v = mesh.vertices[i];
    if (v.allFinite() && v.cwiseAbs().maxCoeff() < kLargest) continue;
    return {ErrorCode::kInvalidInput, name + ": vertex " + std::to_string(i + 1) + " is (" + formatNumber(v.x()) +
                                          ", " + formatNumber(v.y()) + ", " + formatNumber(v.z()) +
                                          "); expected finite numbers below 1e6"};
  }
  const int count = static_cast<int>(mesh.vertices.size());
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) {
      if (index >= 0 && index < count) continue;
      return {ErrorCode::kInvalidInput, name + ": a face names vertex " + std::to_string(index + 1) + " of " +
                                            std::to_string(count)};
    }
  }
  if (mesh.triangles.empty()) return {ErrorCode::kInvalidInput, name + ": holds no triangles; expected at least one"};
  return {};
}

}  // namespace longarm::planning
