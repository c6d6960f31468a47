// Damaged meshes of every kind that is read.
#include <cstring>

#include "planning/world/mesh_file.h"
#include "tests/fuzz/damaged_copies.h"

namespace longarm::tests {
namespace {

Status readMesh(const std::string& path) {
  const auto mesh = planning::loadMesh(path);
  if (!mesh) return mesh.error();
  const auto count = static_cast<int>((*mesh)->vertices.size());
  EXPECT_FALSE((*mesh)->triangles.empty());
  for (const auto& vertex : (*mesh)->vertices) EXPECT_TRUE(vertex.allFinite());
  for (const auto& triangle : (*mesh)->triangles) {
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(triangle[i] >= 0 && triangle[i] < count);
  }
  return {};
}

std::string binaryStl() {
  std::string out(80, ' ');
  const std::uint32_t count = 4;
  out.append(reinterpret_cast<const char*>(&count), 4);
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const auto& face : faces) {
    out.append(12, '\0');
    for (const int corner : face) out.append(reinterpret_cast<const char*>(corners[corner]), 12);
    out.append(2, '\0');
  }
  return out;
}

TEST(DamagedFiles, MeshBinaryStl) {
  const ScratchFolder folder;
  readDamagedCopies(folder, "mesh.stl", binaryStl(), readMesh);
}

TEST(DamagedFiles, MeshTextStl) {
  const ScratchFolder folder;
  readDamagedCopies(folder, "mesh.stl",
                    "solid tetra\n"
                    "  facet normal 0 0 -1\n    outer loop\n      vertex 0 0 0\n      vertex 0 1 0\n      vertex 1 0 0\n"
                    "    endloop\n  endfacet\n"
                    "  facet normal 0 -1 0\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n      vertex 0 0 1e-1\n"
                    "    endloop\n  endfacet\nendsolid tetra\n",
                    readMesh);
}

TEST(DamagedFiles, MeshObj) {
  const ScratchFolder folder;
  readDamagedCopies(folder, "mesh.obj",
                    "# tetrahedron\nmtllib a.mtl\no tetra\nv 0 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\n"
                    "usemtl red\ns off\nf 1 3 2\nf 1/1 2/1 4/1\nf 1//1 4//1 3//1\nf -3/1/1 -2/1/1 -1/1/1\n",
                    readMesh);
}

constexpr const char* kCollada = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
 <library_geometries><geometry id="g" name="g"><mesh>
  <source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
   <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s" name="s"><node id="n" name="n"><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";

TEST(DamagedFiles, MeshColladaInTheChild) {
  const ScratchFolder folder;
  readDamagedCopies(folder, "mesh.dae", kCollada, readMesh);
}

}  // namespace
}  // namespace longarm::tests
