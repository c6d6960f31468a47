#pragma once

/// @file
/// SelectTool: the default.  Selects, drags a handle or a whole feature, nudges, deletes.

#include <list>
#include <optional>
#include <string>
#include <vector>

#include "session/commands/sketch_commands.h"
#include "session/tools/gesture_filter.h"
#include "session/tools/hit_test.h"
#include "session/tools/pick_drag.h"
#include "session/tools/sketch_tool.h"

namespace longarm::session {

/// | state     | event                         | next      | answer                                       |
/// |-----------|-------------------------------|-----------|----------------------------------------------|
/// | kIdle     | hover                         | kIdle     | hint of what lies under the pointer          |
/// | kIdle     | press on handle or body       | kGrabbed  | consumed                                     |
/// | kIdle     | press on nothing              | kIdle     | not consumed                                 |
/// | kIdle     | drag begins on nothing        | kBand     | a frame follows the pointer                  |
/// | kBand     | drag ends                     | kIdle     | selects what has a handle in it (Shift adds) |
/// | kBand     | Esc                           | kIdle     | nothing                                      |
/// | kIdle     | click on nothing              | kIdle     | selects nothing (Control, Shift: keeps)      |
/// | kGrabbed  | click                         | kIdle     | selects (Control toggles, Shift adds)        |
/// | kGrabbed  | drag begins, item not locked  | kDragging | selects                                      |
/// | kGrabbed  | drag begins, item locked      | kIdle     | hint why not                                 |
/// | kDragging | drag                          | kDragging | preview                                      |
/// | kDragging | drag ends                     | kIdle     | one command                                  |
/// | kDragging | Esc, or the item is gone      | kIdle     | nothing                                      |
/// | kIdle     | Esc                           | kIdle     | selects nothing; not consumed when none was  |
/// | kIdle     | arrow, active handle          | kIdle     | one command, absorbed by the one before      |
/// | kIdle     | Tab                           | kIdle     | next handle of the primary selection         |
/// | kIdle     | Delete                        | kIdle     | one command: removes what is selected        |
///
/// A group is selected and moved as one, and so is what is selected when one of it is dragged; Alt takes the single feature out
/// of it.  A point among others is dragged as a whole by its handle: it has nothing else.
class SelectTool final : public SketchTool {
 public:
  enum class State { kIdle, kGrabbed, kDragging, kBand };
  State state() const { return m_state; }

  ToolKind kind() const override { return ToolKind::kSelect; }
  void activate(const Document& document) override;
  void deactivate() override;
  ToolReply onPointer(const vision::PointerEvent& event) override;
  ToolReply onKey(vision::SketchKey key, const vision::KeyModifiers& modifiers) override;
  ToolReply cancel() override;
  void documentChanged() override;
  std::vector<const SketchItem*> drafts() const override;
  vision::Overlay preview(PaneSide side) const override;
  Handle activeHandle() const override { return m_active; }
  void setActiveHandle(const Handle& handle) override;
  bool busy() const override { return m_state == State::kDragging; }
  std::optional<LiveMeasure> liveMeasure() const override;
  std::string hint() const override;
  std::vector<MatchWish> matchWishes() const override;
  ToolReply acceptMatch(const MatchHelp& help) override;

 private:
  ToolReply onPress(const Gesture& gesture);
  ToolReply onClick(const Gesture& gesture);
  ToolReply onDrag(const Gesture& gesture);
  ToolReply onDragEnd(const Gesture& gesture);
  ToolReply onHover(const Gesture& gesture);
  ToolReply onArrow(vision::SketchKey key, const vision::KeyModifiers& modifiers);
  ToolReply onTab(bool backwards);
  ToolReply onDelete();
  ToolReply onBand(const Gesture& gesture);
  ToolReply onBandEnd(const Gesture& gesture);
  /// Takes what moves along: the rest of the group and of the selection.
  void beginCompanions(const Gesture& gesture);
  CommandPtr movedTogether(const SketchItem& moved);
  bool wholeIsGrabbed(const Gesture& gesture) const;
  void moveDrag(const Gesture& gesture);
  void endDrag();
  std::vector<FeatureId> withGroup(FeatureId id, bool alone) const;
  std::vector<FeatureId> movedWith(FeatureId id, bool alone) const;
  bool exists(const Handle& handle) const;
  std::vector<Handle> handlesOf(FeatureId id) const;

  const Document* m_document = nullptr;
  GestureFilter m_filter;
  State m_state = State::kIdle;
  std::optional<Hit> m_grab;
  PickDrag m_drag;
  struct Companion {
    PickEditor editor;
    SketchItem item;
  };
  std::list<Companion> m_companions;       // Of a whole feature that is dragged.
  std::optional<Gesture> m_band;           // From its press to where the pointer is.
  Handle m_active;
  Handle m_moved;                          // Dragged last; a match may help in the other picture.
  std::string m_note;                      // Replaces the hint until the next event.
};

}  // namespace longarm::session
