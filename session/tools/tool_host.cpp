#include "session/tools/tool_host.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "session/tools/match_help.h"

namespace longarm::session {

ToolHost::ToolHost(Document& document, EditHistory& history)
    : m_document(document), m_history(history), m_tool(makeTool(ToolKind::kSelect)) {
  m_tool->usePictures(m_pictures.get());
  m_tool->activate(m_document);
  m_observer = m_document.observe([this](const Change&) {
    m_tool->documentChanged();
    // While a reply is carried out the host announces once, at its end.
    if (!m_in_reply) announce();
  });
}

ToolHost::~ToolHost() { m_document.unobserve(m_observer); }

void ToolHost::setTool(ToolKind kind) {
  const Handle active = m_tool->activeHandle();
  m_tool->deactivate();
  m_tool = makeTool(kind);
  m_tool->usePictures(m_pictures.get());
  m_tool->activate(m_document);
  m_tool->setActiveHandle(active);
  m_history.seal();
  if (m_callbacks.tool_changed) m_callbacks.tool_changed(kind);
  announce();
}

ToolKind ToolHost::tool() const { return m_tool->kind(); }

bool ToolHost::pointer(const vision::PointerEvent& event) {
  if (event.phase == vision::PointerPhase::kPress) m_history.seal();
  return handle(m_tool->onPointer(event));
}

bool ToolHost::key(vision::SketchKey key, const vision::KeyModifiers& modifiers) {
  if (key == vision::SketchKey::kTab && !modifiers.shift && !m_tool->busy()) {
    for (const auto& help : matchHelp()) {
      if (!help.offered()) continue;
      m_history.seal();
      return handle(m_tool->acceptMatch(help));
    }
  }
  return handle(m_tool->onKey(key, modifiers));
}

void ToolHost::setMatchHelp(std::vector<MatchHelp> help) {
  m_help = std::move(help);
  announce();
}

std::vector<MatchHelp> ToolHost::matchHelp() const {
  std::vector<MatchHelp> live;
  if (m_help.empty()) return live;
  const auto wishes = m_tool->matchWishes();
  for (const auto& help : m_help) {
    if (std::find(wishes.begin(), wishes.end(), help.wish) != wishes.end()) live.push_back(help);
  }
  return live;
}

bool ToolHost::handle(ToolReply reply) {
  m_in_reply = true;
  if (reply.command) m_history.push(std::move(reply.command));
  if (reply.selection) m_document.select(std::move(*reply.selection));
  m_in_reply = false;
  if (reply.finished) {
    setTool(ToolKind::kSelect);
  } else if (reply.redraw) {
    announce();
  }
  return reply.consumed;
}

void ToolHost::announce() {
  if (m_callbacks.overlay_changed) m_callbacks.overlay_changed();
  if (m_callbacks.hint_changed) m_callbacks.hint_changed(hint());
}

vision::Overlay ToolHost::overlay(PaneSide side, const OverlayOptions& options) const {
  OverlayOptions all = options;
  const Handle active = m_tool->activeHandle();
  all.drafts = m_tool->drafts();
  all.active_item = active.item;
  all.active_vertex = active.vertex;
  all.active_snapshot = active.snapshot;
  vision::Overlay overlay;
  addOwnLinks(side, &overlay);
  vision::Overlay preview = m_tool->preview(side);
  overlay.shapes.insert(overlay.shapes.end(), std::make_move_iterator(preview.shapes.begin()),
                        std::make_move_iterator(preview.shapes.end()));
  addMatchHelp(matchHelp(), m_document.paneSnapshotId(side), &overlay);
  vision::Overlay sketch = buildOverlay(m_document, m_document.paneSnapshotId(side), all);
  overlay.shapes.insert(overlay.shapes.end(), std::make_move_iterator(sketch.shapes.begin()),
                        std::make_move_iterator(sketch.shapes.end()));
  addPicksOnRobot(side, &overlay);
  return overlay;
}

void ToolHost::setOwnLinksShown(bool shown) {
  m_own_links_shown = shown;
  announce();
}

void ToolHost::addOwnLinks(PaneSide side, vision::Overlay* overlay) const {
  const auto links = m_own_links_shown ? m_own_links->of(m_document.paneSnapshot(side), m_document.workcell()) : nullptr;
  if (links) overlay->shapes.insert(overlay->shapes.end(), links->areas.begin(), links->areas.end());
}

void ToolHost::addPicksOnRobot(PaneSide side, vision::Overlay* overlay) const {
  const SnapshotPtr picture = m_document.paneSnapshot(side);
  const auto links = m_own_links->of(picture, m_document.workcell());
  if (!links) return;
  const auto drafts = m_tool->drafts();
  const auto add = [&](const SketchItem& item) {
    for (int vertex = 0; vertex < item.vertices(); ++vertex) {
      const SketchPick* pick = item.pick(picture->id, vertex);
      const std::string link = pick != nullptr && pick->placed() ? links->linkAt(pick->pixel) : std::string();
      if (link.empty()) continue;
      overlay->shapes.push_back({vision::OverlayShape::Kind::kText, vision::OverlayRole::kWarning, {pick->pixel}, "robot: " + link});
    }
  };
  for (const auto& item : m_document.items()) {
    const bool drafted = std::any_of(drafts.begin(), drafts.end(), [&](const SketchItem* draft) { return draft->id == item.id; });
    if (!item.hidden && !drafted) add(item);
  }
  for (const SketchItem* draft : drafts) add(*draft);
}

// Of the handle that is worked on.
std::string ToolHost::onRobotHint() const {
  const Handle active = m_tool->activeHandle();
  const SketchItem* item = m_document.item(active.item);
  for (const SketchItem* draft : m_tool->drafts()) {
    if (draft->id == active.item) item = draft;
  }
  const SketchPick* pick = item == nullptr ? nullptr : item->pick(active.snapshot, active.vertex);
  if (pick == nullptr || !pick->placed()) return {};
  const auto links = m_own_links->of(m_document.snapshot(active.snapshot), m_document.workcell());
  const std::string link = links ? links->linkAt(pick->pixel) : std::string();
  if (link.empty()) return {};
  return "This is the robot's own " + link + ": it hides what lies behind it, and moves with the robot. Y shows the clearest view.";
}

std::string ToolHost::hint() const {
  const std::string on_robot = onRobotHint();
  if (!on_robot.empty()) return on_robot;
  const std::string help = matchHint(matchHelp());
  return help.empty() ? m_tool->hint() : help;
}
std::optional<LiveMeasure> ToolHost::liveMeasure() const { return m_tool->liveMeasure(); }
Handle ToolHost::activeHandle() const { return m_tool->activeHandle(); }
bool ToolHost::busy() const { return m_tool->busy(); }

}  // namespace longarm::session
