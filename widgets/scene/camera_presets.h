#pragma once

/// @file
/// Places the virtual camera of a renderer: presets, fit, and exactly where a snapshot was taken.

#include <optional>
#include <string>

#include <Eigen/Geometry>

#include "core/pose.h"
#include "vision/snapshot/view.h"

class vtkCamera;
class vtkRenderer;

namespace longarm::scene {

enum class CameraPreset { kTop, kFront, kLeftSide, kRightSide, kBack, kIso };
const char* toString(CameraPreset preset);                        ///< "top", "front", ...
std::optional<CameraPreset> cameraPresetFrom(const std::string& word);

/// Looks at `box` (empty: everything visible; nothing visible: 2 m about the origin) from the preset's side.
/// "front" looks at the robot's face, along -x; "top" has x up on screen.
void applyPreset(vtkRenderer* renderer, CameraPreset preset, const Eigen::AlignedBox3d& box = {});
/// Keeps the direction, moves back or closer until `box` (empty: everything visible) fills the window.
void fitView(vtkRenderer* renderer, const Eigen::AlignedBox3d& box = {});
/// Sees what the view's camera saw, its pinhole part exactly (the lens is left out); the picture is centred in the window
/// and fits it.  Lasts until endLookFrom(): while it does, orbiting and zooming by VTK's styles have no use.
/// @param width,height of the render window [px].
void lookFrom(vtkRenderer* renderer, const vision::View& view, int width, int height);
/// Back to an ordinary perspective camera at the same place.  No effect when not looking from a view.
void endLookFrom(vtkRenderer* renderer);
bool isLookingFromView(vtkRenderer* renderer);

/// Puts a VTK camera at an optical frame (x right, y down, z forward).
void setCameraPose(vtkCamera* camera, const Pose& X_WC);
/// Exact pinhole projection (fx, fy, skew, cx, cy of `camera`; distortion ignored) onto a raster of width x height whose
/// pixel (0, 0) centre is the origin, as everywhere.  @pre 0 < near < far
void setPinholeProjection(vtkCamera* vtk_camera, const vision::CameraModel& camera, int width, int height,
                          double near_m, double far_m);

}  // namespace longarm::scene
