#pragma once

/// @file
/// One drag of handles from press to release, for every tool that moves picks.

#include <memory>
#include <optional>
#include <vector>

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
  void move(const Eigen::Vector2d& pixel, const Eigen::Vector2d& travel, bool release);
  /// The item as dragged.  @pre active()
  SketchItem finish();
  void cancel() { m_editor.reset(); }

  bool active() const { return m_editor != nullptr; }
  /// @pre active()
  const SketchItem& item() const { return m_edit.item; }
  const PickEdit& edit() const { return m_edit; }
  const Handle& handle() const { return m_handle; }

 private:
  std::unique_ptr<PickEditor> m_editor;
  PickEdit m_edit;
  Handle m_handle;
  enum class Way { kTravel, kPointer, kStroke } m_way = Way::kTravel;
  Eigen::Vector2d m_stroke_start = Eigen::Vector2d::Zero();
};

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
