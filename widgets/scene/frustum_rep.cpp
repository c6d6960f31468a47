#include "widgets/scene/frustum_rep.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkTexture.h>

#include "widgets/scene/vtk_convert.h"

namespace longarm::scene {
namespace {

constexpr int kColumns = 24, kRows = 18;  // chords of the mesh stay within a fraction of a pixel of usual lenses

bool sameCamera(const vision::CameraModel& a, const vision::CameraModel& b) {
  return a.width == b.width && a.height == b.height && a.fx == b.fx && a.fy == b.fy && a.skew == b.skew &&
         a.cx == b.cx && a.cy == b.cy && a.distortion == b.distortion;
}

/// Viewing rays at the corners of the mesh's cells, at z = 1; NaN where the lens has none.
std::vector<Eigen::Vector2d> raysOf(const vision::CameraModel& camera) {
  std::vector<Eigen::Vector2d> rays;
  for (int row = 0; row <= kRows; ++row) {
    for (int column = 0; column <= kColumns; ++column) {
      const Eigen::Vector2d pixel(camera.width * static_cast<double>(column) / kColumns - 0.5,
                                  camera.height * static_cast<double>(row) / kRows - 0.5);
      const auto ray = camera.normalisedOfPixel(pixel);
      rays.push_back(ray ? *ray : Eigen::Vector2d::Constant(std::nan("")));
    }
  }
  return rays;
}

int indexOf(int row, int column) { return row * (kColumns + 1) + column; }

/// Mesh corners along the picture's border, closed.
std::vector<int> borderIndices() {
  std::vector<int> border;
  for (int c = 0; c < kColumns; ++c) border.push_back(indexOf(0, c));
  for (int r = 0; r < kRows; ++r) border.push_back(indexOf(r, kColumns));
  for (int c = kColumns; c > 0; --c) border.push_back(indexOf(kRows, c));
  for (int r = kRows; r >= 0; --r) border.push_back(indexOf(r, 0));
  return border;
}

}  // namespace

struct FrustumRep::Impl {
  FrustumLook look;
  vision::View view;
  bool has_picture = false;
  vtkNew<vtkImageData> picture;
  vtkNew<vtkTexture> texture;
  vtkNew<vtkPolyData> mesh, outline;
  vtkNew<vtkActor> mesh_actor, outline_actor;

  void rebuild() {
    const std::vector<Eigen::Vector2d> rays = raysOf(view.camera);
    buildMesh(rays);
    buildOutline(rays);
  }

  void buildMesh(const std::vector<Eigen::Vector2d>& rays) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetNumberOfComponents(2);
    for (int row = 0; row <= kRows; ++row) {
      for (int column = 0; column <= kColumns; ++column) {
        const Eigen::Vector2d& ray = rays[static_cast<std::size_t>(indexOf(row, column))];
        const bool seen = ray.allFinite();
        points->InsertNextPoint(seen ? ray.x() * look.depth : 0, seen ? ray.y() * look.depth : 0, look.depth);
        coordinates->InsertNextTuple2(static_cast<double>(column) / kColumns, 1 - static_cast<double>(row) / kRows);
      }
    }
    vtkNew<vtkCellArray> quads;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const int a = indexOf(row, column), b = a + 1, d = indexOf(row + 1, column), c = d + 1;
        const auto seen = [&](int i) { return rays[static_cast<std::size_t>(i)].allFinite(); };
        if (seen(a) && seen(b) && seen(c) && seen(d)) quads->InsertNextCell({a, d, c, b});
      }
    }
    mesh->SetPoints(points);
    mesh->SetPolys(quads);
    mesh->GetPointData()->SetTCoords(coordinates);
  }

  void buildOutline(const std::vector<Eigen::Vector2d>& rays) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    const vtkIdType apex = points->InsertNextPoint(0, 0, 0);
    std::vector<vtkIdType> border;
    for (const int i : borderIndices()) {
      const Eigen::Vector2d& ray = rays[static_cast<std::size_t>(i)];
      if (!ray.allFinite()) continue;
      const vtkIdType id = points->InsertNextPoint(ray.x() * look.depth, ray.y() * look.depth, look.depth);
      border.push_back(id);
      const bool corner = i == indexOf(0, 0) || i == indexOf(0, kColumns) || i == indexOf(kRows, kColumns) ||
                          i == indexOf(kRows, 0);
      if (corner) lines->InsertNextCell({apex, id});
    }
    if (!border.empty()) lines->InsertNextCell(static_cast<vtkIdType>(border.size()), border.data());
    outline->SetPoints(points);
    outline->SetLines(lines);
  }

  void paint() {
    mesh_actor->GetProperty()->SetOpacity(std::clamp(look.opacity, 0.0, 1.0));
    outline_actor->GetProperty()->SetColor(look.color[0], look.color[1], look.color[2]);
  }
};

FrustumRep::FrustumRep() : m_impl(std::make_unique<Impl>()) {
  vtkNew<vtkPolyDataMapper> mesh_mapper, outline_mapper;
  mesh_mapper->SetInputData(m_impl->mesh);
  m_impl->mesh_actor->SetMapper(mesh_mapper);
  m_impl->mesh_actor->GetProperty()->LightingOff();
  m_impl->texture->SetInputData(m_impl->picture);
  m_impl->texture->SetInterpolate(true);
  m_impl->texture->SetEdgeClamp(true);
  outline_mapper->SetInputData(m_impl->outline);
  m_impl->outline_actor->SetMapper(outline_mapper);
  m_impl->outline_actor->GetProperty()->LightingOff();
  m_impl->outline_actor->GetProperty()->SetLineWidth(1.5F);
  m_impl->paint();
  addProp(m_impl->mesh_actor);
  addProp(m_impl->outline_actor);
  showProp(m_impl->mesh_actor, false);
}

FrustumRep::~FrustumRep() = default;

void FrustumRep::update(const vision::View& view, const cv::Mat& image) {
  const bool sized = view.camera.width > 0 && view.camera.height > 0;
  const bool changed = !sameCamera(view.camera, m_impl->view.camera);
  m_impl->view = view;
  m_impl->has_picture = sized && !image.empty() && (image.type() == CV_8UC3 || image.type() == CV_8UC1);
  if (sized && (changed || m_impl->outline->GetNumberOfPoints() == 0)) m_impl->rebuild();
  if (m_impl->has_picture) {
    internal::copyPicture(image, m_impl->picture);
    m_impl->mesh_actor->SetTexture(m_impl->texture);
  }
  showProp(m_impl->mesh_actor, m_impl->has_picture && m_impl->look.opacity > 0);
  showProp(m_impl->outline_actor, sized && m_impl->look.lines);
  setPose(view.X_WC);
}

void FrustumRep::setPose(const Pose& X_WC) {
  m_impl->view.X_WC = X_WC;
  internal::setActorPose(m_impl->mesh_actor, X_WC);
  internal::setActorPose(m_impl->outline_actor, X_WC);
}

void FrustumRep::setLook(const FrustumLook& look) {
  const bool deeper = look.depth != m_impl->look.depth;
  m_impl->look = look;
  const bool sized = m_impl->view.camera.width > 0 && m_impl->view.camera.height > 0;
  if (deeper && sized) m_impl->rebuild();
  m_impl->paint();
  showProp(m_impl->mesh_actor, m_impl->has_picture && look.opacity > 0);
  showProp(m_impl->outline_actor, sized && look.lines);
}

}  // namespace longarm::scene
