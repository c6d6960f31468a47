#include "planning/world/shape_triangles.h"

#include <cmath>
#include <utility>

namespace longarm::planning {

using Eigen::Vector3d;

namespace {

int add(TriangleMesh& mesh, const Vector3d& p) {
  mesh.vertices.push_back(p);
  return static_cast<int>(mesh.vertices.size()) - 1;
}

void addQuad(TriangleMesh& mesh, int a, int b, int c, int d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

TriangleMesh boxMesh(const Vector3d& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    add(mesh, {(i & 1 ? 0.5 : -0.5) * size.x(), (i & 2 ? 0.5 : -0.5) * size.y(), (i & 4 ? 0.5 : -0.5) * size.z()});
  }
  addQuad(mesh, 0, 2, 3, 1);
  addQuad(mesh, 4, 5, 7, 6);
  addQuad(mesh, 0, 1, 5, 4);
  addQuad(mesh, 2, 6, 7, 3);
  addQuad(mesh, 0, 4, 6, 2);
  addQuad(mesh, 1, 3, 7, 5);
  return mesh;
}

// Rings from the lower end to the upper one, closed by a point at each end.
TriangleMesh turnedMesh(const std::vector<std::pair<double, double>>& radius_z, double low, double high, int around) {
  TriangleMesh mesh;
  const int bottom = add(mesh, {0, 0, low}), first = bottom + 1;
  for (const auto& [radius, z] : radius_z) {
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * M_PI * i / around;
      add(mesh, {radius * std::cos(angle), radius * std::sin(angle), z});
    }
  }
  const int top = add(mesh, {0, 0, high}), rings = static_cast<int>(radius_z.size());
  for (int i = 0; i < around; ++i) {
    const int next = (i + 1) % around, last = first + (rings - 1) * around;
    mesh.triangles.push_back({bottom, first + next, first + i});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      const int here = first + ring * around, above = here + around;
      addQuad(mesh, here + i, here + next, above + next, above + i);
    }
    mesh.triangles.push_back({top, last + i, last + next});
  }
  return mesh;
}

struct Maker {
  int around;

  std::shared_ptr<const TriangleMesh> operator()(const Box& box) const {
    return std::make_shared<const TriangleMesh>(boxMesh(box.size));
  }
  std::shared_ptr<const TriangleMesh> operator()(const Cylinder& c) const {
    const double half = c.length / 2;
    return std::make_shared<const TriangleMesh>(turnedMesh({{c.radius, -half}, {c.radius, half}}, -half, half, around));
  }
  std::shared_ptr<const TriangleMesh> operator()(const Sphere& s) const {
    std::vector<std::pair<double, double>> rings;
    for (int i = 1; i < around / 2; ++i) {
      const double angle = M_PI * i / (around / 2);
      rings.emplace_back(s.radius * std::sin(angle), -s.radius * std::cos(angle));
    }
    return std::make_shared<const TriangleMesh>(turnedMesh(rings, -s.radius, s.radius, around));
  }
  std::shared_ptr<const TriangleMesh> operator()(const std::shared_ptr<const TriangleMesh>& mesh) const {
    return mesh ? mesh : std::make_shared<const TriangleMesh>();
  }
};

}  // namespace

std::shared_ptr<const TriangleMesh> trianglesOf(const Shape& shape, int around) { return std::visit(Maker{around}, shape); }

}  // namespace longarm::planning
