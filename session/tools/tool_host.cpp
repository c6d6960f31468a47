#include "session/tools/tool_host.h"

#include <algorithm>
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
  all.draft = m_tool->draft();
  all.active_item = active.item;
  all.active_vertex = active.vertex;
  all.active_snapshot = active.snapshot;
  vision::Overlay overlay = m_tool->preview(side);
  addMatchHelp(matchHelp(), m_document.paneSnapshotId(side), &overlay);
  vision::Overlay sketch = buildOverlay(m_document, m_document.paneSnapshotId(side), all);
  overlay.shapes.insert(overlay.shapes.end(), std::make_move_iterator(sketch.shapes.begin()),
                        std::make_move_iterator(sketch.shapes.end()));
  return overlay;
}

std::string ToolHost::hint() const {
  const std::string help = matchHint(matchHelp());
  return help.empty() ? m_tool->hint() : help;
}
std::optional<LiveMeasure> ToolHost::liveMeasure() const { return m_tool->liveMeasure(); }
Handle ToolHost::activeHandle() const { return m_tool->activeHandle(); }
bool ToolHost::busy() const { return m_tool->busy(); }

}  // namespace longarm::session
