#include "widgets/scene/shape_geometry.h"

#include <array>
#include <cmath>
#include <variant>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkCellArray.h>  // vtkCommonDataModel
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>  // vtkFiltersCore
#include <vtkProperty.h>

namespace longarm::scene::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSides = 28;  // of a cylinder: smooth outline at arm's length, still few triangles
constexpr int kRings = 14;  // of a sphere

/// Collects vertices and triangles.
class MeshBuilder {
 public:
  MeshBuilder() {
    m_points->SetDataTypeToFloat();
    m_normals->SetNumberOfComponents(3);
    m_coordinates->SetNumberOfComponents(2);
  }

  vtkIdType vertex(const Vector3d& p, const Vector3d& n, const Vector2d& uv) {
    m_normals->InsertNextTuple3(n.x(), n.y(), n.z());
    m_coordinates->InsertNextTuple2(uv.x(), uv.y());
    return m_points->InsertNextPoint(p.x(), p.y(), p.z());
  }
  void triangle(vtkIdType a, vtkIdType b, vtkIdType c) {
    m_triangles->InsertNextCell({a, b, c});
  }
  /// Corners counter-clockwise from outside; texture along the first and last edge.
  void quad(const std::array<Vector3d, 4>& corners) {
    const Vector3d along = corners[1] - corners[0], up = corners[3] - corners[0];
    const Vector3d normal = along.cross(up).normalized();
    const double w = along.norm(), h = up.norm();
    const vtkIdType first = vertex(corners[0], normal, {0, 0});
    vertex(corners[1], normal, {w, 0});
    vertex(corners[2], normal, {w, h});
    vertex(corners[3], normal, {0, h});
    triangle(first, first + 1, first + 2);
    triangle(first, first + 2, first + 3);
  }
  vtkSmartPointer<vtkPolyData> finish() const {
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(m_points);
    mesh->SetPolys(m_triangles);
    mesh->GetPointData()->SetNormals(m_normals);
    mesh->GetPointData()->SetTCoords(m_coordinates);
    return mesh;
  }

 private:
  vtkNew<vtkPoints> m_points;
  vtkNew<vtkFloatArray> m_normals, m_coordinates;
  vtkNew<vtkCellArray> m_triangles;
};

vtkSmartPointer<vtkPolyData> boxGeometry(const Vector3d& size) {
  MeshBuilder mesh;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const double sign : {-1.0, 1.0}) {
      const auto corner = [&](double a, double b) {
        Vector3d p;
        p[axis] = sign * size[axis] / 2;
        p[u] = sign * a * size[u] / 2;
        p[v] = b * size[v] / 2;
        return p;
      };
      mesh.quad({corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)});
    }
  }
  return mesh.finish();
}

void addDisc(MeshBuilder& mesh, double radius, double z, double sign) {
  const Vector3d normal(0, 0, sign);
  const vtkIdType center = mesh.vertex({0, 0, z}, normal, {0, 0});
  for (int i = 0; i <= kSides; ++i) {
    const double angle = 2 * M_PI * i / kSides;
    const Vector3d p(radius * std::cos(angle), radius * std::sin(angle), z);
    mesh.vertex(p, normal, p.head<2>());
  }
  for (int i = 1; i <= kSides; ++i) {
    if (sign > 0) mesh.triangle(center, center + i, center + i + 1);
    if (sign < 0) mesh.triangle(center, center + i + 1, center + i);
  }
}

vtkSmartPointer<vtkPolyData> cylinderGeometry(double radius, double length) {
  MeshBuilder mesh;
  for (int i = 0; i <= kSides; ++i) {
    const double angle = 2 * M_PI * i / kSides;
    const Vector3d normal(std::cos(angle), std::sin(angle), 0);
    const Vector3d p = radius * normal;
    mesh.vertex(p - Vector3d(0, 0, length / 2), normal, {radius * angle, 0});
    mesh.vertex(p + Vector3d(0, 0, length / 2), normal, {radius * angle, length});
  }
  for (vtkIdType i = 0; i < 2 * kSides; i += 2) {
    mesh.triangle(i, i + 2, i + 3);
    mesh.triangle(i, i + 3, i + 1);
  }
  addDisc(mesh, radius, length / 2, 1);
  addDisc(mesh, radius, -length / 2, -1);
  return mesh.finish();
}

vtkSmartPointer<vtkPolyData> sphereGeometry(double radius) {
  MeshBuilder mesh;
  for (int ring = 0; ring <= kRings; ++ring) {
    const double polar = M_PI * ring / kRings;
    for (int i = 0; i <= kSides; ++i) {
      const double angle = 2 * M_PI * i / kSides;
      const Vector3d n(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle), std::cos(polar));
      mesh.vertex(radius * n, n, radius * Vector2d(angle, M_PI - polar));
    }
  }
  for (vtkIdType ring = 0; ring < kRings; ++ring) {
    for (vtkIdType i = 0; i < kSides; ++i) {
      const vtkIdType above = ring * (kSides + 1) + i, below = above + kSides + 1;
      mesh.triangle(above, below, below + 1);
      mesh.triangle(above, below + 1, above + 1);
    }
  }
  return mesh.finish();
}

vtkSmartPointer<vtkPolyData> meshGeometry(const planning::TriangleMesh& source) {
  MeshBuilder mesh;
  for (const Vector3d& p : source.vertices) mesh.vertex(p, Vector3d::UnitZ(), p.head<2>());
  for (const auto& t : source.triangles) mesh.triangle(t[0], t[1], t[2]);
  vtkNew<vtkPolyDataNormals> normals;  // shares normals over smooth places, splits at edges
  normals->SetInputData(mesh.finish());
  normals->SetFeatureAngle(35);
  normals->ConsistencyOff();
  normals->Update();
  return normals->GetOutput();
}

struct GeometryMaker {
  vtkSmartPointer<vtkPolyData> operator()(const planning::Box& box) const { return boxGeometry(box.size); }
  vtkSmartPointer<vtkPolyData> operator()(const planning::Cylinder& c) const {
    return cylinderGeometry(c.radius, c.length);
  }
  vtkSmartPointer<vtkPolyData> operator()(const planning::Sphere& s) const { return sphereGeometry(s.radius); }
  vtkSmartPointer<vtkPolyData> operator()(const std::shared_ptr<const planning::TriangleMesh>& mesh) const {
    return mesh ? meshGeometry(*mesh) : vtkSmartPointer<vtkPolyData>::New();
  }
};

}  // namespace

vtkSmartPointer<vtkPolyData> geometryOf(const planning::Shape& shape) { return std::visit(GeometryMaker{}, shape); }

vtkSmartPointer<vtkActor> makeShapeActor(const planning::Shape& shape, const Eigen::Vector4d& rgba) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(geometryOf(shape));
  mapper->SetStatic(true);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  const bool is_mesh = std::holds_alternative<std::shared_ptr<const planning::TriangleMesh>>(shape);
  actor->GetProperty()->SetBackfaceCulling(!is_mesh);
  setSurfaceColor(actor, rgba);
  return actor;
}

void setSurfaceColor(vtkActor* actor, const Eigen::Vector4d& rgba) {
  vtkProperty* property = actor->GetProperty();
  property->SetColor(rgba[0], rgba[1], rgba[2]);
  property->SetOpacity(rgba[3]);
  property->SetAmbient(0.12);
  property->SetDiffuse(0.88);
  property->SetSpecular(0.12);
  property->SetSpecularPower(20);
}

}  // namespace longarm::scene::internal
