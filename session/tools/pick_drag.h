#pragma once

/// @file
/// One drag of handles from press to release, for every tool that moves picks.

#include <memory>
#include <optional>
#include <vector>

#include "session/tools/gesture_filter.h"
#include "session/tools/match_pictures.h"
#include "session/tools/pick_editor.h"

namespace longarm::session {

/// Ended by finish() or cancel(), never both; the document is not written in between.
class PickDrag {
 public:
  /// @param handle The vertex under the pointer; vertex < 0 takes the whole item.
  void begin(const Document& document, const SketchItem& item, const Handle& handle);
  /// Takes one vertex and brings it to the pointer itself, wherever it was.
  void beginAtPointer(const Document& document, const SketchItem& item, const Handle& handle);
  /// Draws two vertices with one stroke: the first stays at the press, the second follows the pointer.
  void beginStroke(const Document& document, const SketchItem& item, const Handle& first, int second,
                   const Eigen::Vector2d& press_pixel);
  /// Control lets go of the epipolar curve; Shift brings a single handle, or the ends of a stroke, to the corner or edge
  /// next to it.  @param pictures Null: nothing snaps.
  void move(const Gesture& gesture, MatchPictures* pictures);
  /// The item as dragged.  @pre active()
  SketchItem finish();
  void cancel() { m_editor.reset(); }

  bool active() const { return m_editor != nullptr; }
  /// @pre active()
  const SketchItem& item() const { return m_edit.item; }
  const PickEdit& edit() const { return m_edit; }
  const Handle& handle() const { return m_handle; }

 private:
  Eigen::Vector2d snapped(int vertex, const Eigen::Vector2d& wanted, const Gesture& gesture, MatchPictures* pictures,
                          std::optional<vision::SnapKind>* kind) const;

  std::unique_ptr<PickEditor> m_editor;
  PickEdit m_edit;
  Handle m_handle;
  enum class Way { kTravel, kPointer, kStroke } m_way = Way::kTravel;
  Eigen::Vector2d m_stroke_start = Eigen::Vector2d::Zero();
};

/// How far a handle may be drawn to a corner or edge [raw px]: a little less than the pick radius, and some pixels at any zoom.
double snapRadius(double tolerance_px);
/// A press that places a vertex: where it was, or with Shift at the corner or edge next to it.
PickEdit placedAt(const Document& document, const SketchItem& item, const Handle& handle, const Gesture& gesture,
                  MatchPictures* pictures);
/// Curve and band of the handle, and what it snapped to.
vision::Overlay dragPreview(const Document& document, const PickDrag& drag, PaneSide side);

/// Every vertex of the item that has a pick in this picture.
std::vector<int> verticesIn(const SketchItem& item, SnapshotId snapshot);

/// Unit step of an arrow key, in the picture (v down); zero for other keys.
Eigen::Vector2d arrowDirection(vision::SketchKey key);
/// One arrow key on a handle: 0.1 px, with Shift 1 px; with Control off the curve.
PickEdit nudged(const Document& document, const SketchItem& item, const Handle& handle, vision::SketchKey key,
                const vision::KeyModifiers& modifiers);
/// Steps in a row with this key become one.
std::string nudgeKey(const Handle& handle);

}  // namespace longarm::session
