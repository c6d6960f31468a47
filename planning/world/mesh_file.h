#pragma once

/// @file
/// Reads triangle meshes: STL and OBJ by strict readers of our own, other kinds by Assimp in a child process.

#include <memory>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "core/result.h"
#include "planning/world/shape.h"

namespace longarm::planning {

/// Limits of one mesh file.
struct MeshLimits {
  std::size_t max_bytes = 64u << 20;
  std::size_t max_triangles = 1000000;
};

/// Reads a mesh and multiplies its vertices by `scale` per axis (a mirrored scale keeps faces outward).  The kind
/// is told by the file's ending: .stl and .obj here; .dae, .ply, .off, .3ds, .glb by Assimp in a child process
/// held to 2 GB and 10 s, because such readers crash or bloat on damaged files.
///
/// @returns kNotFound; kInvalidInput naming the file, the place and the value: counts that do not match the file's
///   size, indices out of range, numbers that are not finite, no triangles, too big, unknown ending, or a reader that
///   crashed or ran out of time or memory.
/// @par Thread safety
/// Thread-safe; forks for kinds other than STL and OBJ.
Result<std::shared_ptr<const TriangleMesh>> loadMesh(const std::string& path,
                                                     const Eigen::Vector3d& scale = {1, 1, 1},
                                                     const MeshLimits& limits = {});

namespace internal {

/// The readers behind loadMesh(); `name` stands for the file in messages.  Pure functions.
Result<TriangleMesh> parseStl(std::string_view content, const std::string& name, const MeshLimits& limits = {});
Result<TriangleMesh> parseObj(std::string_view content, const std::string& name, const MeshLimits& limits = {});

/// Finite vertices, indices in range, at least one triangle.
Status validateMesh(const TriangleMesh& mesh, const std::string& name);

/// Reads by Assimp in a forked child.  `content` is the whole file, `ending` its kind ("dae").
Result<TriangleMesh> readMeshInChild(std::string_view content, const std::string& ending, const std::string& name,
                                     const MeshLimits& limits = {});

}  // namespace internal
}  // namespace longarm::planning
