#include "widgets/scene/dimension_rep.h"

#include <algorithm>

#include <vtkActor.h>  // vtkRenderingCore
#include <vtkBillboardTextActor3D.h>
#include <vtkCellArray.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include "widgets/scene/scene_text.h"

namespace longarm::scene {

namespace {

const Eigen::Vector3d kColor(1.0, 0.88, 0.66);   // as in the pictures

vtkSmartPointer<vtkActor> makeWay(const std::vector<Eigen::Vector3d>& places) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines, ends;
  for (const auto& place : places) {
    const vtkIdType here = points->InsertNextPoint(place.data());
    ends->InsertNextCell({here});
    if (here > 0) lines->InsertNextCell({here - 1, here});
  }
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetLines(lines);
  data->SetVerts(ends);
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  // Nearer by a trifle, so that the line shows on the edge it measures.
  mapper->SetResolveCoincidentTopologyToPolygonOffset();
  mapper->SetRelativeCoincidentTopologyLineOffsetParameters(0, -20000);
  mapper->SetRelativeCoincidentTopologyPointOffsetParameter(-20000);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  actor->GetProperty()->SetColor(kColor[0], kColor[1], kColor[2]);
  actor->GetProperty()->LightingOff();
  actor->GetProperty()->SetLineWidth(3);
  actor->GetProperty()->SetPointSize(9);
  return actor;
}

}  // namespace

DimensionRep::DimensionRep() = default;

DimensionRep::~DimensionRep() = default;

void DimensionRep::update(const std::vector<Eigen::Vector3d>& places, const std::string& text) {
  clearProps();
  const bool finite = std::all_of(places.begin(), places.end(), [](const auto& p) { return p.allFinite(); });
  if (places.empty() || !finite) return;
  addProp(makeWay(places));
  if (text.empty() || places.size() < 2) return;
  const Eigen::Vector3d at = places.size() == 2 ? Eigen::Vector3d((places[0] + places[1]) / 2) : places[1];
  addProp(internal::makeText(text, at, kColor));
}

}  // namespace longarm::scene
