#pragma once

/// @file
/// What of the sketch lies under the pointer.

#include <optional>
#include <vector>

#include "session/document/document.h"
#include "session/tools/sketch_tool.h"

namespace longarm::session {

/// A handle (vertex >= 0) or the body of an item (vertex < 0).
struct Hit {
  Handle handle;
  double distance_px = 0;                  ///< [raw px]
};

/// Nearest handle within the radius, else nearest body; selected items win over others, hidden ones are not seen.
/// @param radius_px In raw image pixels: PointerEvent::imageTolerance.
std::optional<Hit> hitTest(const Document& document, PaneSide side, const Eigen::Vector2d& pixel, double radius_px);
/// The same of one item value.
std::optional<Hit> hitItem(const Document& document, const SketchItem& item, PaneSide side,
                           const Eigen::Vector2d& pixel, double radius_px);

}  // namespace longarm::session
