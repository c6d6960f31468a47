#pragma once

/// @file
/// DrawTool: what the point and line tools share.  A copy lies in both pictures; its handles go onto the feature.

#include "session/tools/gesture_filter.h"
#include "session/tools/pick_drag.h"
#include "session/tools/sketch_tool.h"

namespace longarm::session {

/// Unplaced copies belong to the tool and are drawn dashed; the first gesture that places a vertex adds the item to
/// the document, each later one replaces it.  Either picture may come first; in the other one handles slide along
/// the epipolar curve unless Control is held; with Shift they snap to corners and edges.  While vertices are to be placed
/// in a picture a handle is taken by a press on itself only, so that strokes may begin beside it.  When every vertex is
/// placed in both pictures the tool has finished.
///
/// | state      | event                               | next       | answer                                         |
/// |------------|-------------------------------------|------------|------------------------------------------------|
/// | kNoPicture | anything but Esc                    | kNoPicture | not consumed                                   |
/// | kNoPicture | a picture comes into a pane         | kPlacing   |                                                |
/// | kPlacing   | hover over the other pane           | kPlacing   | its first unplaced vertex becomes active       |
/// | kPlacing   | press in a pane with a picture      | kGrabbed   | consumed                                       |
/// | kPlacing   | press off the picture               | kPlacing   | hint why nothing was marked; not consumed      |
/// | kGrabbed   | click on a placed handle            | kPlacing   | makes it active                                |
/// | kGrabbed   | click elsewhere                     | kPlacing   | command: the next vertex is placed there       |
/// | kGrabbed   | drag begins on a handle             | kDragging  | that handle follows                            |
/// | kGrabbed   | drag begins on the body, all placed | kDragging  | all handles of that picture follow             |
/// | kGrabbed   | drag begins elsewhere               | kDragging  | a stroke: one end there, the other follows     |
/// | kGrabbed   | drag begins elsewhere, all placed   | kPlacing   | nothing                                        |
/// | kDragging  | drag                                | kDragging  | preview                                        |
/// | kDragging  | drag ends                           | kPlacing   | one command; finished when all is placed       |
/// | kGrabbed, kDragging | Esc, or the picture leaves | kPlacing   | nothing                                        |
/// | kPlacing   | Esc                                 | kPlacing   | finished, nothing written                      |
/// | kPlacing   | arrow                               | kPlacing   | command: places and nudges the active handle   |
/// | kPlacing   | Return                              | kPlacing   | command: places the active handle where it is  |
/// | kPlacing   | Tab                                 | kPlacing   | next handle                                    |
/// | kPlacing   | a suggested match is accepted       | kPlacing   | command: the vertex is placed there            |
/// | kPlacing   | Delete                              | kPlacing   | command: removes the item, if it was added     |
class DrawTool : public SketchTool {
 public:
  enum class State { kNoPicture, kPlacing, kGrabbed, kDragging };
  State state() const { return m_state; }

  void activate(const Document& document) override;
  void deactivate() override;
  ToolReply onPointer(const vision::PointerEvent& event) override;
  ToolReply onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) override;
  ToolReply cancel() override;
  void documentChanged() override;
  std::vector<const SketchItem*> drafts() const override;
  vision::Overlay preview(PaneSide side) const override;
  Handle activeHandle() const override { return m_active; }
  void setActiveHandle(const Handle&) override {}
  bool busy() const override { return m_state == State::kDragging; }
  std::optional<LiveMeasure> liveMeasure() const override;
  std::string hint() const override;
  std::vector<MatchWish> matchWishes() const override;
  ToolReply acceptMatch(const MatchHelp& help) override;

 protected:
  explicit DrawTool(vision::FeatureKind kind, bool pipe = false) : m_kind(kind), m_pipe(pipe) {}
  /// "end 2", or "the point".
  virtual std::string vertexName(int vertex) const = 0;
  /// Where the copies lie at first, as fractions of width and height.
  virtual Eigen::Vector2d startPlace(int vertex) const = 0;

 private:
  ToolReply onHover(const Gesture& gesture);
  ToolReply onPress(const Gesture& gesture);
  ToolReply onClick(const Gesture& gesture);
  ToolReply onDrag(const Gesture& gesture);
  ToolReply onDragEnd(const Gesture& gesture);
  ToolReply onArrow(vision::SketchKey key, const vision::KeyModifiers& modifiers);
  ToolReply onReturn();
  ToolReply onTab(bool backwards);
  ToolReply onDelete();
  bool beginDrag(const Gesture& gesture);
  /// What a press takes hold of: a handle, the body (vertex < 0), or nothing, which begins the next stroke.
  std::optional<Handle> meantBy(const Gesture& press) const;
  const SketchItem* draft() const;
  ToolReply commit(SketchItem after, const std::string& label, const std::string& merge_key = {});
  void refresh();
  std::vector<Handle> handles() const;
  std::optional<Handle> nextUnplaced(PaneSide side) const;
  std::optional<Handle> nextUnplaced() const;
  bool isPlaced(const Handle& handle) const;
  bool complete(const SketchItem& item) const;
  std::string placingHint() const;

  vision::FeatureKind m_kind;
  bool m_pipe;                             // A line by the outlines of a pipe.
  const Document* m_document = nullptr;
  GestureFilter m_filter;
  State m_state = State::kNoPicture;
  FeatureId m_id;
  SketchItem m_item;                       // The document's, or the fresh one; with copies in both panes.
  std::optional<Handle> m_grab;            // vertex < 0: the body.
  PickDrag m_drag;
  Handle m_active;
  std::string m_note;                      // Replaces the hint until the next press or key.
};

}  // namespace longarm::session
