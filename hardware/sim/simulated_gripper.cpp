#include "hardware/sim/simulated_gripper.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {

SimulatedGripper::SimulatedGripper(std::string name, double closed, double open, double speed, const Clock& clock)
    : RunnerDevice<Gripper>(std::move(name)),
      m_closed(std::min(closed, open)),
      m_open(std::max(closed, open)),
      m_clock(clock),
      m_ramp(open, speed) {}

SimulatedGripper::~SimulatedGripper() { close(); }

Status SimulatedGripper::setOpening(double position) {
  return runner().command("moving the fingers", [&]() -> Status {
    if (!(position >= m_closed && position <= m_open)) {
      return {ErrorCode::kOutOfLimits, name() + ": opening " + formatNumber(position) + " is not within " +
                                           formatNumber(m_closed) + " ... " + formatNumber(m_open)};
    }
    std::lock_guard<std::mutex> lock(m_mutex);
    m_ramp.moveTo(position, m_clock.now_s());
    return {};
  });
}

double SimulatedGripper::position() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const double free = m_ramp.at(m_clock.now_s());
  return m_object && free < *m_object ? *m_object : free;
}

bool SimulatedGripper::holding() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_object && m_ramp.at(m_clock.now_s()) <= *m_object && m_ramp.target() < *m_object;
}

void SimulatedGripper::setObject(std::optional<double> stops_at) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_object = stops_at;
}

void SimulatedGripper::injectFault(const std::string& why) {
  (void)onStop();
  runner().fault({ErrorCode::kInternal, why});
}

// The grip stays: what is held is not dropped by a stop.
Status SimulatedGripper::onStop() {
  std::lock_guard<std::mutex> lock(m_mutex);
  const double now_s = m_clock.now_s();
  const bool gripping = m_object && m_ramp.at(now_s) <= *m_object && m_ramp.target() < *m_object;
  if (!gripping) m_ramp.halt(now_s);
  return {};
}

}  // namespace longarm::hardware
