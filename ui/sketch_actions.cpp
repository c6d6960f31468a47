#include "ui/sketch_actions.h"

#include <algorithm>
#include <utility>

#include <QActionGroup>

namespace longarm::ui {

using session::TargetingController;
using session::ToolKind;

namespace {

constexpr std::pair<ActionId, ToolKind> kTools[] = {{ActionId::kToolSelect, ToolKind::kSelect},
                                                    {ActionId::kToolPoint, ToolKind::kPoint},
                                                    {ActionId::kToolLine, ToolKind::kLine},
                                                    {ActionId::kToolPipe, ToolKind::kPipe},
                                                    {ActionId::kToolPlane, ToolKind::kPlane},
                                                    {ActionId::kToolTriad, ToolKind::kTriad},
                                                    {ActionId::kToolMeasure, ToolKind::kMeasure}};

}  // namespace

SketchActions::SketchActions(TargetingController& targeting, Actions& actions, QObject* parent)
    : QObject(parent), m_targeting(targeting), m_actions(actions) {
  bind();
  connect(&m_targeting, &TargetingController::historyChanged, this, &SketchActions::refreshHistory);
  connect(&m_targeting, &TargetingController::overlayChanged, this, &SketchActions::refreshHistory);
  connect(&m_targeting, &TargetingController::featuresChanged, this, &SketchActions::refreshSelection);
  connect(&m_targeting, &TargetingController::panesChanged, this, &SketchActions::refreshTools);
  connect(&m_targeting, &TargetingController::toolChanged, this, &SketchActions::refreshTools);
  refreshHistory();
  refreshSelection();
  refreshTools();
}

void SketchActions::bind() {
  const auto on = [this](ActionId id, const std::function<void()>& act) {
    connect(m_actions.at(id), &QAction::triggered, this, [act] { act(); });
  };
  on(ActionId::kUndo, [this] { m_targeting.undo(); });
  on(ActionId::kRedo, [this] { m_targeting.redo(); });
  // Both go to the tool first: it may be drawing.
  on(ActionId::kDelete, [this] { if (!m_targeting.key(vision::SketchKey::kDelete)) m_targeting.removeSelected(); });
  on(ActionId::kCancel, [this] { if (!m_targeting.key(vision::SketchKey::kEscape)) m_targeting.select(FeatureId{}); });
  on(ActionId::kSelectAll, [this] { selectAll(); });
  on(ActionId::kDuplicate, [this] { m_targeting.duplicate(m_targeting.document().selection().primary); });
  on(ActionId::kHide, [this] {
    const auto* item = m_targeting.document().item(m_targeting.document().selection().primary);
    if (item != nullptr) toggle(&TargetingController::setHidden, item->hidden);
  });
  on(ActionId::kLock, [this] {
    const auto* item = m_targeting.document().item(m_targeting.document().selection().primary);
    if (item != nullptr) toggle(&TargetingController::setLocked, item->locked);
  });
  on(ActionId::kEndsDiffer, [this] {
    const auto* item = m_targeting.document().item(m_targeting.document().selection().primary);
    if (item != nullptr) m_targeting.setEdge(item->id, !item->edge);
    refreshSelection();
  });
  on(ActionId::kGroup, [this] { m_targeting.groupSelected(true); });
  on(ActionId::kUngroup, [this] { m_targeting.groupSelected(false); });
  auto* group = new QActionGroup(this);
  for (const auto& [id, kind] : kTools) {
    group->addAction(m_actions.at(id));
    on(id, [this, tool = kind] { m_targeting.setTool(tool); });
  }
}

void SketchActions::toggle(void (TargetingController::*set)(FeatureId, bool), bool now) {
  const auto items = m_targeting.document().selection().items;
  for (const auto id : items) (m_targeting.*set)(id, !now);
}

void SketchActions::selectAll() {
  session::Selection all;
  for (const auto& item : m_targeting.document().items()) all.items.insert(item.id);
  if (!m_targeting.document().items().empty()) all.primary = m_targeting.document().items().back().id;
  m_targeting.select(all);
}

void SketchActions::refreshHistory() {
  const bool undo = m_targeting.canUndo(), redo = m_targeting.canRedo();
  m_actions.setWhyNot(ActionId::kUndo, undo ? QString() : tr("Nothing has been edited."));
  m_actions.setWhyNot(ActionId::kRedo, redo ? QString() : tr("Nothing was taken back."));
  m_actions.setText(ActionId::kUndo, undo ? tr("Undo %1").arg(m_targeting.undoLabel()) : tr("Undo"));
  m_actions.setText(ActionId::kRedo, redo ? tr("Redo %1").arg(m_targeting.redoLabel()) : tr("Redo"));
}

void SketchActions::refreshSelection() {
  const bool any = m_targeting.document().selection().primary.valid();
  const QString why = any ? QString() : tr("Select a feature first.");
  for (const auto id : {ActionId::kRename, ActionId::kDuplicate, ActionId::kCopyToPictures, ActionId::kNote, ActionId::kNumbers, ActionId::kColour, ActionId::kHide,
                        ActionId::kLock}) {
    m_actions.setWhyNot(id, why);
  }
  const auto* line = m_targeting.document().item(m_targeting.document().selection().primary);
  const bool has_ends = line != nullptr && line->kind == vision::FeatureKind::kLine && !line->pipe;
  m_actions.setWhyNot(ActionId::kEndsDiffer, has_ends ? QString() : tr("Select a line first."));
  m_actions.at(ActionId::kEndsDiffer)->setChecked(has_ends && line->edge);
  const auto& selected = m_targeting.document().selection().items;
  m_actions.setWhyNot(ActionId::kGroup, selected.size() > 1 ? QString() : tr("Select two features or more first."));
  // An item that has just been removed may still be selected.
  const bool grouped = std::any_of(selected.begin(), selected.end(), [this](FeatureId id) {
    const auto* item = m_targeting.document().item(id);
    return item != nullptr && item->group != 0;
  });
  m_actions.setWhyNot(ActionId::kUngroup, grouped ? QString() : tr("What is selected is in no group."));
  const bool items = !m_targeting.document().items().empty();
  m_actions.setWhyNot(ActionId::kSelectAll, items ? QString() : tr("There is no feature."));
  m_actions.setWhyNot(ActionId::kDelete, any || m_targeting.tool() != ToolKind::kSelect ? QString() : why);
}

void SketchActions::refreshTools() {
  for (const auto& [id, kind] : kTools) {
    m_actions.setWhyNot(id, m_targeting.whyNotTool(kind));
    m_actions.at(id)->setChecked(m_targeting.tool() == kind);
  }
  refreshSelection();
}

}  // namespace longarm::ui
