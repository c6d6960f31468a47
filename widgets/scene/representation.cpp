#include "widgets/scene/representation.h"

#include <algorithm>
#include <vector>

#include <vtkProp.h>  // vtkRenderingCore
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkWeakPointer.h>

namespace longarm::scene {

namespace {
struct Entry {
  vtkSmartPointer<vtkProp> prop;
  bool shown = true;
};
}  // namespace

struct Representation::Props {
  std::vector<Entry> entries;
  vtkWeakPointer<vtkRenderer> renderer;
  bool visible = true;
};

Representation::Representation() : m_props(std::make_unique<Props>()) {}

Representation::~Representation() { clearProps(); }

void Representation::addTo(vtkRenderer* renderer) {
  if (m_props->renderer == renderer) return;
  removeFrom(m_props->renderer);
  m_props->renderer = renderer;
  if (renderer == nullptr) return;
  for (const Entry& entry : m_props->entries) renderer->AddViewProp(entry.prop);
}

void Representation::removeFrom(vtkRenderer* renderer) {
  if (renderer == nullptr || m_props->renderer != renderer) return;
  for (const Entry& entry : m_props->entries) renderer->RemoveViewProp(entry.prop);
  m_props->renderer = nullptr;
}

void Representation::setVisible(bool visible) {
  m_props->visible = visible;
  for (const Entry& entry : m_props->entries) entry.prop->SetVisibility(visible && entry.shown);
}

bool Representation::visible() const { return m_props->visible; }

Eigen::AlignedBox3d Representation::bounds() const {
  Eigen::AlignedBox3d box;
  if (!m_props->visible) return box;
  for (const Entry& entry : m_props->entries) {
    const bool counts = entry.prop->GetVisibility() != 0 && entry.prop->GetUseBounds();
    const double* b = counts ? entry.prop->GetBounds() : nullptr;
    if (b == nullptr || b[0] > b[1]) continue;
    box.extend(Eigen::Vector3d(b[0], b[2], b[4]));
    box.extend(Eigen::Vector3d(b[1], b[3], b[5]));
  }
  return box;
}

void Representation::addProp(vtkProp* prop) {
  prop->SetVisibility(m_props->visible);
  m_props->entries.push_back({prop, true});
  if (m_props->renderer != nullptr) m_props->renderer->AddViewProp(prop);
}

void Representation::showProp(vtkProp* prop, bool shown) {
  for (Entry& entry : m_props->entries) {
    if (entry.prop == prop) entry.shown = shown;
  }
  prop->SetVisibility(m_props->visible && shown);
}

void Representation::removeProp(vtkProp* prop) {
  if (m_props->renderer != nullptr) m_props->renderer->RemoveViewProp(prop);
  auto& entries = m_props->entries;
  entries.erase(std::remove_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.prop == prop; }),
                entries.end());
}

void Representation::clearProps() {
  if (m_props->renderer != nullptr) {
    for (const Entry& entry : m_props->entries) m_props->renderer->RemoveViewProp(entry.prop);
  }
  m_props->entries.clear();
}

}  // namespace longarm::scene
