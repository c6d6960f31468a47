#include "widgets/scene/ground_grid_rep.h"

#include <algorithm>
#include <cmath>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include "widgets/scene/vtk_convert.h"

namespace longarm::scene {
namespace {

/// Coloured line segments of one actor.
struct LineSet {
  vtkNew<vtkPolyData> data;
  vtkNew<vtkActor> actor;
  vtkSmartPointer<vtkPoints> points;
  vtkSmartPointer<vtkCellArray> lines;
  vtkSmartPointer<vtkUnsignedCharArray> colors;

  LineSet() {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->SetScalarModeToUseCellData();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
  }
  void begin() {
    points = vtkSmartPointer<vtkPoints>::New();
    lines = vtkSmartPointer<vtkCellArray>::New();
    colors = vtkSmartPointer<vtkUnsignedCharArray>::New();
    colors->SetNumberOfComponents(3);
  }
  void line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& color) {
    const vtkIdType first = points->InsertNextPoint(a.data());
    points->InsertNextPoint(b.data());
    lines->InsertNextCell({first, first + 1});
    colors->InsertNextTuple3(255 * color[0], 255 * color[1], 255 * color[2]);
  }
  void finish() {
    data->SetPoints(points);
    data->SetLines(lines);
    data->GetCellData()->SetScalars(colors);
  }
};

}  // namespace

struct GroundGridRep::Impl {
  LineSet set;
};

GroundGridRep::GroundGridRep() : m_impl(std::make_unique<Impl>()) {
  m_impl->set.actor->UseBoundsOff();  // "fit" is about the things, not the ground
  m_impl->set.actor->PickableOff();
  addProp(m_impl->set.actor);
}

GroundGridRep::~GroundGridRep() = default;

void GroundGridRep::update(double half_size, double spacing, double height, const Eigen::Vector3d& color) {
  half_size = std::clamp(half_size, 0.01, 100.0);
  spacing = std::max(spacing, half_size / 500);
  const int count = static_cast<int>(std::floor(half_size / spacing + 1e-9));
  m_impl->set.begin();
  for (int i = -count; i <= count; ++i) {
    const double at = i * spacing;
    const bool metre = std::abs(at - std::round(at)) < 1e-6;
    const Eigen::Vector3d shade = metre ? color : Eigen::Vector3d(0.72 * color);
    m_impl->set.line({at, -half_size, height}, {at, half_size, height}, shade);
    m_impl->set.line({-half_size, at, height}, {half_size, at, height}, shade);
  }
  m_impl->set.finish();
}

struct AxesRep::Impl {
  LineSet set;
};

AxesRep::AxesRep() : m_impl(std::make_unique<Impl>()) { addProp(m_impl->set.actor); }

AxesRep::~AxesRep() = default;

void AxesRep::update(const Pose& X_WA, double length, double line_width) {
  m_impl->set.begin();
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
    m_impl->set.line(Eigen::Vector3d::Zero(), length * direction, 0.15 * Eigen::Vector3d::Ones() + 0.85 * direction);
  }
  m_impl->set.finish();
  m_impl->set.actor->GetProperty()->SetLineWidth(static_cast<float>(line_width));
  internal::setActorPose(m_impl->set.actor, X_WA);
}

}  // namespace longarm::scene
