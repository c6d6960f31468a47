#pragma once

/// @file
/// ToolHost: owns the active tool, applies what it answers, tells who draws.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "session/commands/edit_history.h"
#include "session/document/overlay_builder.h"
#include "session/tools/match_pictures.h"
#include "session/tools/own_links.h"
#include "session/tools/sketch_tool.h"

namespace longarm::session {

/// GUI thread only; no Qt.
class ToolHost {
 public:
  struct Callbacks {
    std::function<void()> overlay_changed;     ///< Draw both panes again.
    std::function<void(const std::string&)> hint_changed;
    std::function<void(ToolKind)> tool_changed;
  };

  ToolHost(Document& document, EditHistory& history);
  ~ToolHost();
  ToolHost(const ToolHost&) = delete;
  ToolHost& operator=(const ToolHost&) = delete;

  void setCallbacks(Callbacks callbacks) { m_callbacks = std::move(callbacks); }

  /// Ends the former tool without a trace and starts this one afresh.
  void setTool(ToolKind kind);
  ToolKind tool() const;

  /// @returns whether the tool used it; what it did not use belongs to the canvas.
  bool pointer(const vision::PointerEvent& event);
  /// Tab takes the best match that is offered, and is the tool's when there is none.
  bool key(vision::SketchKey key, const vision::KeyModifiers& modifiers = {});

  /// Everything to draw over the picture in this pane: sketch, path, preview.
  vision::Overlay overlay(PaneSide side, const OverlayOptions& options = {}) const;
  std::string hint() const;
  /// For which vertices a match would help now, and what was found for them.  What is no longer wished is not shown.
  std::vector<MatchWish> matchWishes() const { return m_tool->matchWishes(); }
  void setMatchHelp(std::vector<MatchHelp> help);
  std::vector<MatchHelp> matchHelp() const;
  /// Pictures in floats, for snapping and matching; may be shared with jobs.
  const std::shared_ptr<MatchPictures>& pictures() const { return m_pictures; }
  /// Where pictures show the robot itself; may be asked for others, too.
  OwnLinksCache& ownLinks() const { return *m_own_links; }
  /// Whether they are tinted there.  A pick that lands on a link is told in any case.
  void setOwnLinksShown(bool shown);
  bool ownLinksShown() const { return m_own_links_shown; }
  /// What the tool measured, to be shown in the scene.
  std::optional<SceneDimension> dimension() const { return m_tool->dimension(); }
  /// A vertex was picked elsewhere than in a picture.  @returns whether the tool used it.
  bool takeVertex(const VertexRef& vertex) { return handle(m_tool->onVertex(vertex)); }
  std::optional<LiveMeasure> liveMeasure() const;
  /// What is being drawn or dragged, as SketchTool::drafts().
  std::vector<const SketchItem*> drafts() const { return m_tool->drafts(); }
  Handle activeHandle() const;
  /// A drag is going on: undo and other edits wait until it ends.
  bool busy() const;

 private:
  bool handle(ToolReply reply);
  void announce();
  void addOwnLinks(PaneSide side, vision::Overlay* overlay) const;
  void addPicksOnRobot(PaneSide side, vision::Overlay* overlay) const;
  std::string onRobotHint() const;

  Document& m_document;
  EditHistory& m_history;
  std::shared_ptr<MatchPictures> m_pictures = std::make_shared<MatchPictures>();
  std::unique_ptr<OwnLinksCache> m_own_links = std::make_unique<OwnLinksCache>();
  bool m_own_links_shown = true;
  std::unique_ptr<SketchTool> m_tool;
  std::vector<MatchHelp> m_help;
  Callbacks m_callbacks;
  int m_observer = 0;
  bool m_in_reply = false;
};

}  // namespace longarm::session
