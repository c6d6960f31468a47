#include "widgets/scene/scene_text.h"

#include <vtkBillboardTextActor3D.h>
#include <vtkTextProperty.h>

namespace longarm::scene::internal {

vtkSmartPointer<vtkBillboardTextActor3D> makeText(const std::string& text, const Eigen::Vector3d& at, const Eigen::Vector3d& color) {
  auto actor = vtkSmartPointer<vtkBillboardTextActor3D>::New();
  actor->SetInput(text.c_str());
  actor->SetPosition(at.x(), at.y(), at.z());
  actor->SetDisplayOffset(8, 6);
  actor->GetTextProperty()->SetFontSize(14);
  actor->GetTextProperty()->SetColor(color[0], color[1], color[2]);
  actor->GetTextProperty()->SetShadow(1);
  return actor;
}

}  // namespace longarm::scene::internal
