#include "hardware/drivers/rosbridge/clock_offset.h"

#include <algorithm>
#include <cmath>

namespace longarm::hardware {
namespace {

constexpr int kSlices = 20;              // of the window
constexpr double kSetBack_s = 1.0;       // Later than the best by more: the robot's clock was set back.

}  // namespace

void ClockOffset::add(double stamp_s, double received_s) {
  const double difference = received_s - stamp_s;
  const auto known = offset();
  if (known && difference > *known + kSetBack_s + m_window_s) reset();
  while (!m_slices.empty() && m_slices.front().begin_s < received_s - m_window_s) m_slices.pop_front();
  // Our own clock never runs backwards; a slice from the future belongs to a former life.
  while (!m_slices.empty() && m_slices.back().begin_s > received_s) m_slices.pop_back();
  if (m_slices.empty() || received_s - m_slices.back().begin_s > m_window_s / kSlices) {
    m_slices.push_back({received_s, difference});
  } else {
    m_slices.back().least = std::min(m_slices.back().least, difference);
  }
}

std::optional<double> ClockOffset::offset() const {
  if (m_slices.empty()) return std::nullopt;
  return std::min_element(m_slices.begin(), m_slices.end(),
                          [](const Slice& a, const Slice& b) { return a.least < b.least; })
      ->least;
}

}  // namespace longarm::hardware
