#pragma once

/// @file
/// What to draw over one picture: sketch, handles, labels, 95 % ellipses, planned path or where planning failed.

#include <optional>
#include <vector>

#include "session/document/document.h"
#include "vision/sketch/pointer_event.h"

namespace longarm::session {

struct OverlayOptions {
  bool labels = true, ellipses = true, path = true;
  /// Drawn in place of the items of the same ids, or added where the document has none: a drag's preview.
  std::vector<const SketchItem*> drafts;
  FeatureId active_item;                   ///< Whose vertex has the keyboard; drawn as kActiveHandle.
  int active_vertex = -1;
  SnapshotId active_snapshot;
  /// Tool-tip positions of the planned path in the pictures' parent frame; empty: none.
  const std::vector<Eigen::Vector3d>* path_points = nullptr;
};

/// Shapes for one picture of the document, in drawing order.  Pure function; empty for an unknown id.
vision::Overlay buildOverlay(const Document& document, SnapshotId snapshot, const OverlayOptions& options = {});
/// The same for any view (a live picture): features are projected, picks are not drawn.
vision::Overlay buildOverlay(const Document& document, const vision::View& view, const OverlayOptions& options = {});

/// The picture of a straight edge of the world between two raw pixels, bent as the lens bends it: a polyline from
/// `a` to `b`.  Without a usable ray at an end it is the straight segment.
std::vector<Eigen::Vector2d> pictureOfEdge(const vision::CameraModel& camera, const Eigen::Vector2d& a,
                                           const Eigen::Vector2d& b);

/// Tip positions along a plan in the robot's root frame, one each `step_s` of the trajectory; empty without one.
std::vector<Eigen::Vector3d> planPath(const planning::Workcell& workcell, const planning::Plan& plan,
                                      double step_s = 0.05);

}  // namespace longarm::session
