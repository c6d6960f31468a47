#pragma once

/// @file
/// ClockOffset: how far a robot's clock is from ours, by the message that travelled fastest.

#include <deque>
#include <optional>

namespace longarm::hardware {

/// Every message says when it was stamped (robot's clock) and when it came (ours); the difference is the offset plus
/// the time it travelled, so the smallest one of the last seconds is the best.  It also follows slow drift.
/// Stamps thus converted never lie after the arrival of their own message.  Thread-compatible.
class ClockOffset {
 public:
  /// @param window_s  How long one message counts [s].
  explicit ClockOffset(double window_s = 10) : m_window_s(window_s) {}

  /// @pre both are finite [s]
  void add(double stamp_s, double received_s);
  /// Our time = robot's time + offset [s]; empty before the first message.
  std::optional<double> offset() const;
  /// Another robot, or the same after a restart.
  void reset() { m_slices.clear(); }

 private:
  struct Slice {
    double begin_s, least;
  };
  const double m_window_s;
  std::deque<Slice> m_slices;            // oldest first; the least difference of each part of the window
};

}  // namespace longarm::hardware
