#include "session/tools/gesture_filter.h"

namespace longarm::session {

using vision::PointerPhase;

Gesture GestureFilter::make(GestureKind kind, const vision::PointerEvent& event) const {
  Gesture gesture;
  gesture.kind = kind;
  gesture.side = m_state == State::kUp ? event.side : m_side;
  gesture.pixel = event.pixel;
  gesture.press_pixel = m_state == State::kUp ? event.pixel : m_press;
  gesture.tolerance_px = event.imageTolerance(m_pick_radius_px);
  gesture.modifiers = event.modifiers;
  return gesture;
}

std::optional<Gesture> GestureFilter::feed(const vision::PointerEvent& event) {
  switch (event.phase) {
    case PointerPhase::kHover:
      return m_state == State::kUp ? std::optional(make(GestureKind::kHover, event)) : std::nullopt;
    case PointerPhase::kPress:
      if (!event.left) return std::nullopt;
      m_side = event.side;
      m_press = event.pixel;
      m_state = State::kPressed;
      return make(GestureKind::kPress, event);
    case PointerPhase::kDoubleClick:
      if (!event.left) return std::nullopt;
      m_side = event.side;
      m_press = event.pixel;
      m_state = State::kIgnored;
      return make(GestureKind::kDoubleClick, event);
    case PointerPhase::kDrag:
      if (m_state == State::kDragged) return make(GestureKind::kDragMove, event);
      if (m_state != State::kPressed) return std::nullopt;
      if ((event.pixel - m_press).norm() <= event.imageTolerance(m_start_distance_px)) return std::nullopt;
      m_state = State::kDragged;
      return make(GestureKind::kDragBegin, event);
    case PointerPhase::kRelease: {
      std::optional<Gesture> gesture;
      if (m_state == State::kPressed) gesture = make(GestureKind::kClick, event);
      if (m_state == State::kDragged) gesture = make(GestureKind::kDragEnd, event);
      m_state = State::kUp;
      return gesture;
    }
  }
  return std::nullopt;
}

void GestureFilter::cancel() {
  if (m_state != State::kUp) m_state = State::kIgnored;
}

}  // namespace longarm::session
