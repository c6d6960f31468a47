#pragma once

/// @file
/// Solids drawn into a picture: their edges and outline as its lens bends them, and what they cover.

#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "vision/sketch/pointer_event.h"
#include "vision/snapshot/view.h"

namespace longarm::vision {

/// How a solid is drawn.
struct SolidLook {
  OverlayRole role = OverlayRole::kSolid;
  bool filled = false;                     ///< Also the area it covers, seen through.
  int colour_rgb = -1;                     ///< 0xRRGGBB; -1: the role's.
};

/// Twelve edges.  @param X_WB Its middle; @param size Full edge lengths [m].  All of these are pure functions; what lies
/// behind the camera or off the picture is left out.
void addBox(const Pose& X_WB, const Eigen::Vector3d& size, const View& view, const SolidLook& look, Overlay* overlay);
/// Both end circles and the two lines where the surface turns away from the camera.  Axis z, centred [m].
void addCylinder(const Pose& X_WC, double radius, double length, const View& view, const SolidLook& look, Overlay* overlay);
/// The circle where the surface turns away from the camera.
void addSphere(const Eigen::Vector3d& centre_W, double radius, const View& view, const SolidLook& look, Overlay* overlay);

/// Convex hull, counter-clockwise in a frame with v up; fewer than three points come back as they are.
std::vector<Eigen::Vector2d> convexHull(std::vector<Eigen::Vector2d> points);

}  // namespace longarm::vision
