#pragma once

/// @file
/// Input to sketch tools in image pixels, and what they want drawn; no Qt.

#include <string>
#include <vector>

#include <Eigen/Core>

namespace longarm::vision {

enum class PaneSide { kLeft = 0, kRight = 1 };

enum class PointerPhase { kHover, kPress, kDrag, kRelease, kDoubleClick };

struct KeyModifiers {
  bool shift = false, control = false, alt = false;
};

/// A pointer action on one pane, already in raw image pixels (centre of top-left pixel is (0,0)).
struct PointerEvent {
  PaneSide side = PaneSide::kLeft;
  PointerPhase phase = PointerPhase::kHover;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double pixels_per_image_px = 1;      ///< Screen pixels per image pixel (zoom).
  bool left = false, middle = false, right = false;
  KeyModifiers modifiers;

  /// A distance on screen as image pixels: pick radii do not depend on zoom.
  double imageTolerance(double screen_px) const { return screen_px / pixels_per_image_px; }
};

enum class SketchKey { kEscape, kDelete, kLeft, kRight, kUp, kDown, kTab, kReturn };

/// What a shape means; the canvas maps it to colour, width and dash of the theme.
enum class OverlayRole { kSketch, kSelected, kHandle, kActiveHandle, kUnplaced, kEpipolar, kDepthTick, kMiss,
                         kEllipse, kPath, kPathOccluded, kWarning, kLabel,
                         kPathNear,     ///< A part of the path that comes near to something.
                         kPathTight,    ///< A part that comes very near.
                         kBand,         ///< Where the calibration may put the true curve, +- 2 sigma.
                         kMatch,        ///< A match that is offered.
                         kRival,        ///< One of several places that look alike.
                         kSolid,        ///< What a box or pipe looks like where it was measured.
                         kWorld,        ///< A body of the sketched world.
                         kKeepOut,      ///< A zone that the arm does not enter.
                         kWorkspace,    ///< A zone that it does not leave.
                         kDimension,    ///< A measured distance or angle.
                         kOwnLink };    ///< Where the picture shows the robot itself.

struct OverlayShape {
  enum class Kind { kPolyline, kMarker, kText, kArea } kind = Kind::kPolyline;   ///< kArea: filled, seen through.
  OverlayRole role = OverlayRole::kSketch;
  std::vector<Eigen::Vector2d> points;     ///< Raw image pixels.
  std::string text;                        ///< kText: label; anchored at points[0].
  int colour_rgb = -1;                     ///< 0xRRGGBB the operator gave the feature; -1: the role's colour.
};

/// Shapes for one picture, in drawing order.
struct Overlay {
  std::vector<OverlayShape> shapes;
};

}  // namespace longarm::vision
