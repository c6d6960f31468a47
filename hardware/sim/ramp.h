#pragma once

/// @file
/// Ramp: one axis that moves at constant speed towards a target; the heart of the small simulated devices.

#include <algorithm>
#include <cmath>

namespace longarm::hardware {

/// Pure function of time.  Thread-compatible.
class Ramp {
 public:
  Ramp(double start, double speed) : m_from(start), m_to(start), m_speed(speed) {}

  double at(double now_s) const {
    const double way = m_to - m_from;
    const double done = std::max(0.0, now_s - m_begin_s) * m_speed;
    return done >= std::abs(way) ? m_to : m_from + (way < 0 ? -done : done);
  }
  bool moving(double now_s) const { return at(now_s) != m_to; }
  double target() const { return m_to; }
  void moveTo(double target, double now_s) {
    m_from = at(now_s);
    m_to = target;
    m_begin_s = now_s;
  }
  void halt(double now_s) { moveTo(at(now_s), now_s); }

 private:
  double m_from, m_to, m_speed, m_begin_s = 0;
};

}  // namespace longarm::hardware
