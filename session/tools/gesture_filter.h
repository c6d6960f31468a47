#pragma once

/// @file
/// Tells clicks from drags, in one place for all tools.

#include <optional>

#include "vision/sketch/pointer_event.h"

namespace longarm::session {

enum class GestureKind { kHover, kPress, kClick, kDoubleClick, kDragBegin, kDragMove, kDragEnd };

struct Gesture {
  GestureKind kind = GestureKind::kHover;
  vision::PaneSide side = vision::PaneSide::kLeft;        ///< Pane of the press.
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();        ///< Raw pixel now.
  Eigen::Vector2d press_pixel = Eigen::Vector2d::Zero();  ///< Raw pixel of the press.
  double tolerance_px = 0;                                ///< Pick radius of 8 screen pixels, in image pixels.
  vision::KeyModifiers modifiers;

  Eigen::Vector2d travel() const { return pixel - press_pixel; }
};

/// Left button only; other buttons belong to the canvas.
///
/// | state    | event                        | gives            | next     |
/// |----------|------------------------------|------------------|----------|
/// | kUp      | hover                        | kHover           | kUp      |
/// | kUp      | press                        | kPress           | kPressed |
/// | kUp      | double click                 | kDoubleClick     | kIgnored |
/// | kPressed | drag, <= start distance      | nothing          | kPressed |
/// | kPressed | drag, > start distance       | kDragBegin       | kDragged |
/// | kPressed | release                      | kClick           | kUp      |
/// | kDragged | drag                         | kDragMove        | kDragged |
/// | kDragged | release                      | kDragEnd         | kUp      |
/// | kIgnored | release                      | nothing          | kUp      |
/// | any      | cancel()                     | nothing          | kIgnored |
class GestureFilter {
 public:
  enum class State { kUp, kPressed, kDragged, kIgnored };

  /// @param start_distance_px Travel that makes a drag, in screen pixels.
  explicit GestureFilter(double start_distance_px = 4, double pick_radius_px = 8)
      : m_start_distance_px(start_distance_px), m_pick_radius_px(pick_radius_px) {}

  std::optional<Gesture> feed(const vision::PointerEvent& event);
  /// Forgets the press: the rest of this gesture gives nothing.
  void cancel();
  State state() const { return m_state; }

 private:
  Gesture make(GestureKind kind, const vision::PointerEvent& event) const;

  double m_start_distance_px, m_pick_radius_px;
  State m_state = State::kUp;
  vision::PaneSide m_side = vision::PaneSide::kLeft;
  Eigen::Vector2d m_press = Eigen::Vector2d::Zero();
};

}  // namespace longarm::session
