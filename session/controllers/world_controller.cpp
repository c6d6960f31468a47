#include "session/controllers/world_controller.h"

#include <utility>

#include "planning/macros/reach_advice.h"
#include "session/commands/world_commands.h"

namespace longarm::session {

WorldController::WorldController(Document& document, EditHistory& history, QObject* parent)
    : QObject(parent), m_document(document), m_history(history) {
  m_observer = m_document.observe([this](const Change& change) {
    if (change.kind == ChangeKind::kWorldChanged || change.kind == ChangeKind::kReset) Q_EMIT changed();
  });
}

WorldController::~WorldController() { m_document.unobserve(m_observer); }

std::vector<WorldItem> WorldController::fromSelection(Status* why) const {
  std::vector<WorldItem> made;
  std::vector<vision::Feature> points;
  FeatureId first_point;
  for (const FeatureId id : m_document.selection().items) {
    if (m_document.item(id) == nullptr) continue;   // Just removed; it leaves the selection next.
    const Measurement& measured = m_document.measurement(id);
    if (!measured.feature) {
      *why = {ErrorCode::kInvalidInput, measured.reason};
      return {};
    }
    if (measured.feature->kind == vision::FeatureKind::kPoint) {
      if (!points.empty() && points.front().parent != measured.feature->parent) {
        *why = {ErrorCode::kInvalidInput, "The points are measured in different frames: add them one after the other."};
        return {};
      }
      if (points.empty()) first_point = id;
      points.push_back(*measured.feature);
      continue;
    }
    auto item = worldItemFrom(*measured.feature);
    if (!item) {
      *why = item.error();
      return {};
    }
    item->source = id;
    made.push_back(std::move(*item));
  }
  if (!points.empty()) {
    made.push_back(worldPointsFrom(points));
    if (points.size() == 1) made.back().source = first_point;
    else made.back().name = std::to_string(points.size()) + " points";
  }
  if (made.empty()) *why = {ErrorCode::kRefused, "Select a measured box, plane, pipe or points first."};
  return made;
}

QString WorldController::whyNotAdd() const {
  Status why;
  (void)fromSelection(&why);
  return why ? QString() : QString::fromStdString(why.error().message);
}

Status WorldController::addSelected(WorldRole role) {
  Status why;
  std::vector<WorldItem> made = fromSelection(&why);
  if (!why) return why;
  std::vector<CommandPtr> commands;
  std::uint64_t id = m_document.nextWorldId().value;
  const std::string label = made.size() == 1 ? "Add '" + made.front().name + "' to the world"
                                             : "Add " + std::to_string(made.size()) + " bodies to the world";
  for (auto& item : made) {
    item.id = {id++};
    item.role = role;
    const auto source = made.size() == 1 ? m_document.selection().primary : item.source;
    item.base = m_document.item(source) != nullptr ? m_document.baseOf(source) : m_document.base();
    if (const Status checked = checkWorldItem(item); !checked) return checked;
    commands.push_back(addWorldItem(std::move(item)));
  }
  m_history.seal();
  m_history.push(composite(label, std::move(commands)));
  return {};
}

Status WorldController::addWorkspace() {
  const auto& workcell = m_document.workcell();
  if (!workcell || !workcell->model) return {ErrorCode::kRefused, "No robot is loaded: open its workcell first."};
  for (const auto& item : items()) {
    if (item.role == WorldRole::kWorkspace) {
      return {ErrorCode::kRefused, "'" + item.name + "' is the workspace already: change its numbers in the list of bodies."};
    }
  }
  const auto& model = *workcell->model;
  const planning::Reach reach = planning::reachOf(*workcell, model.neutral());
  WorldItem item = workspaceAround(reach.shoulder, reach.length, model.links()[static_cast<std::size_t>(model.rootLink())].name);
  item.id = m_document.nextWorldId();
  m_history.seal();
  m_history.push(addWorldItem(std::move(item)));
  return {};
}

void WorldController::remove(const std::vector<WorldItemId>& ids) {
  auto command = removeWorldItems(m_document, ids);
  if (!command) return;
  m_history.seal();
  m_history.push(std::move(command));
}

Status WorldController::edit(const WorldItem& after) {
  if (const Status checked = checkWorldItem(after); !checked) return checked;
  auto command = replaceWorldItem(m_document, after);
  if (!command) return {};
  m_history.seal();
  m_history.push(std::move(command));
  return {};
}

}  // namespace longarm::session
