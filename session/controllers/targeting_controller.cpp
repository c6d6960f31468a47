#include "session/controllers/targeting_controller.h"

#include <iterator>
#include <utility>

#include "session/commands/world_commands.h"
#include "session/tools/hit_test.h"
#include "session/tools/pick_editor.h"
#include "session/tools/third_view.h"

namespace longarm::session {

TargetingController::TargetingController(Document& document, EditHistory& history, QObject* parent)
    : QObject(parent), m_document(document), m_history(history), m_tools(document, history) {
  ToolHost::Callbacks callbacks;
  callbacks.overlay_changed = [this] {
    Q_EMIT overlayChanged();
    Q_EMIT liveMeasureChanged();
  };
  callbacks.hint_changed = [this](const std::string& text) { Q_EMIT hintChanged(QString::fromStdString(text)); };
  callbacks.tool_changed = [this](ToolKind kind) { Q_EMIT toolChanged(kind); };
  m_tools.setCallbacks(std::move(callbacks));
  m_history.onChanged([this] { Q_EMIT historyChanged(); });
  m_observer = m_document.observe([this](const Change& change) { changed(change); });
}

TargetingController::~TargetingController() {
  m_document.unobserve(m_observer);
  m_history.onChanged({});
  m_tools.setCallbacks({});
}

void TargetingController::changed(const Change& change) {
  switch (change.kind) {
    case ChangeKind::kSnapshotAdded:
    case ChangeKind::kSnapshotRemoved:
      if (!m_document.snapshot(m_third)) setThird({});
      Q_EMIT snapshotsChanged();
      break;
    case ChangeKind::kPaneChanged: Q_EMIT panesChanged(); break;
    case ChangeKind::kPinsChanged: Q_EMIT snapshotsChanged(); break;
    case ChangeKind::kWorldChanged: Q_EMIT worldChanged(); break;
    case ChangeKind::kItemAdded:
    case ChangeKind::kItemChanged:
    case ChangeKind::kItemRemoved: Q_EMIT featuresChanged(); break;
    case ChangeKind::kSelectionChanged:
      Q_EMIT selectionChanged();
      Q_EMIT featuresChanged();
      break;
    case ChangeKind::kPlanChanged:
    case ChangeKind::kWorkcellChanged:
      m_path.clear();
      if (m_document.plan() && m_document.workcell()) m_path = planPath(*m_document.workcell(), m_document.plan()->plan);
      Q_EMIT planChanged();
      Q_EMIT overlayChanged();
      break;
    case ChangeKind::kReset:
      m_path.clear();
      setThird({});
      Q_EMIT snapshotsChanged();
      Q_EMIT panesChanged();
      Q_EMIT selectionChanged();
      Q_EMIT featuresChanged();
      Q_EMIT planChanged();
      Q_EMIT worldChanged();
      Q_EMIT overlayChanged();
      break;
  }
}

void TargetingController::setTool(ToolKind kind) { m_tools.setTool(kind); }

QString TargetingController::whyNotTool(ToolKind kind) const {
  if (kind == ToolKind::kSelect) return {};
  const bool any = m_document.paneSnapshot(PaneSide::kLeft) || m_document.paneSnapshot(PaneSide::kRight);
  return any ? QString() : tr("Take a pair of snapshots first, or open pictures from files.");
}

vision::Overlay TargetingController::overlay(PaneSide side) const {
  OverlayOptions options;
  options.path_points = &m_path;
  return m_tools.overlay(side, options);
}

vision::Overlay TargetingController::overlay(const vision::View& view) const {
  OverlayOptions options;
  options.path_points = &m_path;
  options.drafts = m_tools.drafts();
  return buildOverlay(m_document, view, options);
}

void TargetingController::setThird(SnapshotId id) {
  const SnapshotId wanted = m_document.snapshot(id) ? id : SnapshotId{};
  if (wanted == m_third) return;
  m_third = wanted;
  Q_EMIT thirdChanged();
}

vision::Overlay TargetingController::thirdOverlay() const {
  OverlayOptions options;
  options.path_points = &m_path;
  options.drafts = m_tools.drafts();
  vision::Overlay overlay;
  const auto links = m_tools.ownLinksShown() ? m_tools.ownLinks().of(m_document.snapshot(m_third), m_document.workcell()) : nullptr;
  if (links) overlay.shapes = links->areas;
  vision::Overlay sketch = buildOverlay(m_document, m_third, options);
  overlay.shapes.insert(overlay.shapes.end(), std::make_move_iterator(sketch.shapes.begin()), std::make_move_iterator(sketch.shapes.end()));
  const Handle active = m_tools.activeHandle();
  const FeatureId shown = active.valid() ? active.item : m_document.selection().primary;
  addThirdView(m_document, m_document.item(shown), active.valid() ? active.vertex : 0, m_third, &overlay);
  return overlay;
}

Status TargetingController::pickInThird(const Eigen::Vector2d& pixel) {
  const SketchItem* item = m_document.item(m_document.selection().primary);
  if (item == nullptr) return {ErrorCode::kRefused, "Select the feature that is to be marked in the third picture first."};
  if (item->locked) return {ErrorCode::kRefused, "'" + item->name + "' is locked. Unlock it in the list to move it."};
  const int vertex = nearestPredicted(m_document, *item, m_third, pixel);
  if (vertex < 0) return {ErrorCode::kRefused, "'" + item->name + "' is to be marked in both panes before a third picture can check it."};
  SketchItem after = *item;
  after.setPick(m_third, vertex, {pixel, PickState::kReleased});
  push(replaceItem(m_document, std::move(after), "Mark '" + item->name + "' in the third picture"));
  return {};
}

void TargetingController::select(FeatureId id) { select(id.valid() ? Selection::of(id) : Selection{}); }

void TargetingController::select(const Selection& selection) {
  m_history.seal();
  m_document.select(selection);
}

void TargetingController::push(std::unique_ptr<EditCommand> command) {
  if (command == nullptr || m_tools.busy()) return;
  m_history.seal();
  m_history.push(std::move(command));
}

void TargetingController::rename(FeatureId id, const QString& name) {
  push(renameItem(m_document, id, name.trimmed().left(100).toStdString()));
}

void TargetingController::setHidden(FeatureId id, bool hidden) { push(hideItem(m_document, id, hidden)); }
void TargetingController::setEdge(FeatureId id, bool edge) { push(edgeItem(m_document, id, edge)); }
void TargetingController::setLocked(FeatureId id, bool locked) { push(lockItem(m_document, id, locked)); }
void TargetingController::setColour(FeatureId id, std::optional<std::uint32_t> rgb) {
  push(colourItem(m_document, id, rgb));
}
void TargetingController::duplicate(FeatureId id) { push(duplicateItem(m_document, id)); }
Status TargetingController::copyToPictures(FeatureId id) {
  auto copy = copyItemTo(m_document, id, {m_document.paneSnapshotId(PaneSide::kLeft), m_document.paneSnapshotId(PaneSide::kRight)});
  if (!copy) return copy.error();
  const FeatureId made = m_document.nextFeatureId();
  push(std::move(*copy));
  select(made);
  return {};
}

void TargetingController::remove(FeatureId id) { push(removeItems(m_document, {id})); }

void TargetingController::removeSelected() {
  const auto& items = m_document.selection().items;
  push(removeItems(m_document, {items.begin(), items.end()}));
}

void TargetingController::showSnapshot(PaneSide side, SnapshotId id) { push(session::showSnapshot(m_document, side, id)); }
void TargetingController::removeSnapshot(SnapshotId id) { push(session::removeSnapshot(m_document, id)); }

void TargetingController::setNote(FeatureId id, const QString& note) {
  push(noteItem(m_document, id, note.trimmed().left(200).toStdString()));
}

void TargetingController::groupSelected(bool together) {
  const auto& items = m_document.selection().items;
  push(groupItems(m_document, {items.begin(), items.end()}, together));
}

Status TargetingController::moveVertex(FeatureId id, int vertex, const Eigen::Vector3d& xyz) {
  const SketchItem* item = m_document.item(id);
  if (item == nullptr) return {ErrorCode::kNotFound, "That feature is gone."};
  if (item->locked) return {ErrorCode::kRefused, "'" + item->name + "' is locked. Unlock it in the list to move it."};
  auto after = withVertexAt(m_document, *item, vertex, xyz);
  if (!after) return after.error();
  if (*after != *item) push(replaceItem(m_document, std::move(*after), "Move '" + item->name + "' by numbers"));
  return {};
}

Status TargetingController::movePick(FeatureId id, SnapshotId snapshot, int vertex, const Eigen::Vector2d& pixel) {
  const SketchItem* item = m_document.item(id);
  if (item == nullptr) return {ErrorCode::kNotFound, "That feature is gone."};
  if (item->locked) return {ErrorCode::kRefused, "'" + item->name + "' is locked. Unlock it in the list to move it."};
  auto after = withPickAt(m_document, *item, snapshot, vertex, pixel);
  if (!after) return after.error();
  if (*after != *item) push(replaceItem(m_document, std::move(*after), "Move '" + item->name + "' by numbers"));
  return {};
}

FeatureId TargetingController::itemAt(PaneSide side, const Eigen::Vector2d& pixel, double radius_px) const {
  const auto hit = hitTest(m_document, side, pixel, radius_px);
  return hit ? hit->handle.item : FeatureId{};
}

void TargetingController::setPinned(SnapshotId id, bool pinned) { push(pinSnapshot(m_document, id, pinned)); }

void TargetingController::undo() {
  if (canUndo()) m_history.undo();
}

void TargetingController::redo() {
  if (canRedo()) m_history.redo();
}

}  // namespace longarm::session
