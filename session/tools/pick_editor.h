#pragma once

/// @file
/// What becomes of an item when picks of one picture are asked for elsewhere: the epipolar constraint lives here.

#include <map>
#include <optional>
#include <vector>

#include "session/document/document.h"
#include "session/tools/sketch_tool.h"
#include "vision/match/snap.h"
#include "vision/stereo/epipolar.h"

namespace longarm::session {

/// The item as it would be, and what held the first of the moved vertices.
struct PickEdit {
  SketchItem item;
  Eigen::Vector2d raw = Eigen::Vector2d::Zero();          ///< Asked for, kept on the picture [raw px].
  Eigen::Vector2d constrained = Eigen::Vector2d::Zero();  ///< Granted [raw px].
  bool on_curve = false;
  bool released = false;
  bool off_picture = false;                               ///< Asked for beyond the border.
  std::optional<double> depth;                            ///< z in the camera of the constraining pick [m].
  std::optional<vision::SnapKind> snapped;                ///< What of the picture drew it there.
};

/// The picture whose pick of this vertex constrains the one in `snapshot`, or an invalid id.  The first picture of
/// a vertex is free and constrains the others; of several, the one in a pane wins.
SnapshotId constrainingSnapshot(const Document& document, const SketchItem& item, SnapshotId snapshot, int vertex);

/// Curve that the pick of this vertex in `snapshot` belongs to; empty when nothing constrains it or no part is seen.
std::optional<vision::EpipolarCurve> constrainingCurve(const Document& document, const SketchItem& item,
                                                       SnapshotId snapshot, int vertex);

/// The item with one vertex at a place of the world: its picks go where the pictures see it, and stay there.
/// @returns kInvalidInput: no pick of this vertex, or a picture that does not see the place.
Result<SketchItem> withVertexAt(const Document& document, const SketchItem& item, int vertex, const Eigen::Vector3d& xyz);
/// The item with one pick elsewhere, off its curve where it was held to one.
/// @returns kInvalidInput: no such pick, or off the picture.
Result<SketchItem> withPickAt(const Document& document, const SketchItem& item, SnapshotId snapshot, int vertex,
                              const Eigen::Vector2d& pixel);

/// Moves picks of some vertices in one picture.  Borrows the document, copies the item; a drag keeps one editor, so
/// that the curves that hold its handles are computed once.
///
/// A pick that nothing constrains goes where it is asked (kFree), and picks of the same vertex that were slid along
/// its curve, matched, or not placed yet, follow to the nearest point of the new curve.  A pick that is constrained goes to
/// the nearest point of its curve, or, released, where it is asked (kReleased).  All picks stay on their picture.
class PickEditor {
 public:
  /// @pre the snapshot is in the document and the item has a pick there of every vertex given
  PickEditor(const Document& document, SketchItem item, SnapshotId snapshot, std::vector<int> vertices);

  const Document& document() const { return m_document; }
  const SketchItem& before() const { return m_before; }
  SnapshotId snapshot() const { return m_snapshot; }
  const std::vector<int>& vertices() const { return m_vertices; }

  /// @param wanted One raw pixel per vertex given to the constructor.
  PickEdit moveTo(const std::vector<Eigen::Vector2d>& wanted, bool release) const;
  /// All of them by the same way from where they were.
  PickEdit moveBy(const Eigen::Vector2d& travel, bool release) const;
  /// One key step of `step_px` pixels: along the curve when the first vertex is constrained and not released, else
  /// in the direction given (a unit vector along u or v).
  PickEdit nudge(const Eigen::Vector2d& direction, double step_px, bool release) const;
  /// The corner or edge of the picture near the pixel, brought onto the curve where the vertex is held to one: a corner to
  /// the nearest point of it, an edge to where the two cross.  Nothing when none lies within the radius.
  std::optional<vision::SnapPoint> snapped(int vertex, const Eigen::Vector2d& wanted, bool release,
                                           const vision::MatchPicture& picture, double radius_px) const;

 private:
  void follow(SketchItem& item, int vertex) const;

  const Document& m_document;
  SketchItem m_before;
  SnapshotId m_snapshot;
  std::vector<int> m_vertices;
  std::map<int, vision::EpipolarCurve> m_curves;   // Of constrained vertices.
};

/// Numbers of a vertex of an item value; `edit` adds where it was asked for.
LiveMeasure liveMeasureOf(const Document& document, const SketchItem& item, const Handle& handle,
                          const PickEdit* edit = nullptr);

/// Whether a pixel lies on the picture, or within a pixel of it.
bool isOnPicture(const vision::Snapshot& snapshot, const Eigen::Vector2d& pixel);
/// What a drag does now, and how to leave it.
std::string dragHint(const PickEdit& edit);

/// Epipolar curve, depth ticks and miss line of the handle's vertex in the picture of this pane.
vision::Overlay handlePreview(const Document& document, const SketchItem& item, const Handle& handle, PaneSide side);

}  // namespace longarm::session
