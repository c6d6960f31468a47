#include "widgets/scene/sketch_rep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <vtkActor.h>  // vtkRenderingCore
#include <vtkBillboardTextActor3D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkSmartPointer.h>

#include "widgets/scene/scene_text.h"
#include "widgets/scene/shape_geometry.h"
#include "widgets/scene/vtk_convert.h"

namespace longarm::scene {
namespace {

using Edge = std::pair<int, int>;

std::vector<Edge> edgesOf(vision::FeatureKind kind) {
  switch (kind) {
    case vision::FeatureKind::kPoint: return {};
    case vision::FeatureKind::kLine: return {{0, 1}};
    case vision::FeatureKind::kPlane: return {{0, 1}, {1, 2}, {2, 3}, {3, 0}};  // 3: the fourth corner
    case vision::FeatureKind::kTriad: return {{0, 1}, {0, 2}, {0, 3}};
  }
  return {};
}

/// Vertices, and for a plane its completed fourth corner.
std::vector<Eigen::Vector3d> cornersOf(const vision::Feature& feature) {
  std::vector<Eigen::Vector3d> corners;
  for (const vision::FeatureVertex& vertex : feature.vertices) corners.push_back(vertex.xyz);
  if (feature.kind == vision::FeatureKind::kPlane && corners.size() == 3) {
    corners.push_back(corners[0] + corners[2] - corners[1]);
  }
  return corners;
}

vtkSmartPointer<vtkActor> actorOf(vtkPolyData* data, const Eigen::Vector3d& color) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetProperty()->LightingOff();
  return actor;
}

vtkSmartPointer<vtkActor> makeMarks(const std::vector<Eigen::Vector3d>& corners, const std::vector<Edge>& edges,
                                    std::size_t vertex_count, const Eigen::Vector3d& color, bool selected) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines, vertices;
  for (const Eigen::Vector3d& p : corners) points->InsertNextPoint(p.data());
  for (const Edge& edge : edges) {
    if (static_cast<std::size_t>(std::max(edge.first, edge.second)) < corners.size()) {
      lines->InsertNextCell({edge.first, edge.second});
    }
  }
  for (std::size_t i = 0; i < vertex_count; ++i) vertices->InsertNextCell({static_cast<vtkIdType>(i)});
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  data->SetVerts(vertices);
  auto actor = actorOf(data, color);
  actor->GetProperty()->SetLineWidth(selected ? 4.0F : 2.5F);
  actor->GetProperty()->SetPointSize(selected ? 11.0F : 8.0F);
  return actor;
}

// A measured box or pipe, seen through.
vtkSmartPointer<vtkActor> makeSolid(const vision::Feature& feature, const Eigen::Vector3d& color) {
  constexpr double kSeenThrough = 0.3;
  const Eigen::Vector4d rgba(color[0], color[1], color[2], kSeenThrough);
  vtkSmartPointer<vtkActor> actor;
  if (feature.box && feature.box->is_box && feature.box->size.minCoeff() > 0) {
    actor = internal::makeShapeActor(planning::Box{feature.box->size}, rgba);
    internal::setActorPose(actor, feature.box->X_WB);
  } else if (feature.pipe && feature.vertices.size() == 2 && feature.length() > 0 && feature.pipe->radius > 0) {
    actor = internal::makeShapeActor(planning::Cylinder{feature.pipe->radius, feature.length()}, rgba);
    internal::setActorPose(actor, vision::pipePose(feature));
  }
  return actor;
}

vtkSmartPointer<vtkActor> makeEllipsoid(const vision::FeatureVertex& vertex, const Eigen::Vector3d& color,
                                        double scale) {
  Eigen::Matrix3d axes = scale * ellipsoidAxes(vertex.covariance);
  for (int i = 0; i < 3; ++i) {  // a flat ellipsoid would have no normals
    if (axes.col(i).norm() < 1e-6) axes.col(i) = 1e-6 * axes.col((i + 1) % 3).cross(axes.col((i + 2) % 3)).normalized();
  }
  if (!axes.allFinite() || std::abs(axes.determinant()) < 1e-24) return nullptr;
  auto actor = internal::makeShapeActor(planning::Sphere{1}, {color[0], color[1], color[2], 0.45});
  Pose X = Pose::Identity();
  X.matrix().topLeftCorner<3, 3>() = axes;
  X.translation() = vertex.xyz;
  internal::setActorPose(actor, X);
  return actor;
}

}  // namespace

Eigen::Matrix3d ellipsoidAxes(const Eigen::Matrix3d& covariance) {
  if (!covariance.allFinite()) return Eigen::Matrix3d::Zero();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver((covariance + covariance.transpose()) / 2);
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0) axes.col(0) *= -1;
  for (int i = 0; i < 3; ++i) axes.col(i) *= std::sqrt(kChi2Of95Percent3 * std::max(0.0, solver.eigenvalues()[i]));
  return axes;
}

struct SketchRep::Impl {
  SketchLook look;
  std::vector<SketchItem> items;
};

SketchRep::SketchRep() : m_impl(std::make_unique<Impl>()) {}

SketchRep::~SketchRep() = default;

void SketchRep::update(const std::vector<SketchItem>& items) {
  m_impl->items = items;
  clearProps();
  for (const SketchItem& item : items) {
    const std::vector<Eigen::Vector3d> corners = cornersOf(item.feature);
    const bool finite = std::all_of(corners.begin(), corners.end(), [](const auto& p) { return p.allFinite(); });
    if (!item.visible || corners.empty() || !finite) continue;
    const Eigen::Vector3d color = item.stale      ? m_impl->look.stale_color
                                  : item.selected ? m_impl->look.selected_color
                                                  : m_impl->look.color;
    addProp(makeMarks(corners, edgesOf(item.feature.kind), item.feature.vertices.size(), color, item.selected));
    if (const auto solid = makeSolid(item.feature, color)) addProp(solid);
    if (m_impl->look.ellipsoids) {
      for (const vision::FeatureVertex& vertex : item.feature.vertices) {
        const auto ellipsoid = makeEllipsoid(vertex, color, m_impl->look.ellipsoid_scale);
        if (ellipsoid != nullptr) addProp(ellipsoid);
      }
    }
    if (m_impl->look.names && !item.feature.name.empty()) addProp(internal::makeText(item.feature.name, corners[0], color));
  }
}

void SketchRep::setLook(const SketchLook& look) {
  m_impl->look = look;
  update(std::vector<SketchItem>(m_impl->items));
}

}  // namespace longarm::scene
