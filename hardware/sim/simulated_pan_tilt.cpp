#include "hardware/sim/simulated_pan_tilt.h"

#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {

SimulatedPanTilt::SimulatedPanTilt(std::string name, double reach, double speed, const Clock& clock)
    : RunnerDevice<PanTilt>(std::move(name)), m_reach(reach), m_clock(clock), m_pan(0, speed), m_tilt(0, speed) {}

SimulatedPanTilt::~SimulatedPanTilt() { close(); }

Status SimulatedPanTilt::moveTo(double pan, double tilt) {
  return runner().command("aiming", [&]() -> Status {
    for (const double angle : {pan, tilt}) {
      if (std::abs(angle) <= m_reach) continue;
      return {ErrorCode::kOutOfLimits, name() + ": angle " + formatNumber(angle) + " rad is not within +-" +
                                           formatNumber(m_reach) + " rad"};
    }
    std::lock_guard<std::mutex> lock(m_mutex);
    const double now_s = m_clock.now_s();
    m_pan.moveTo(pan, now_s);
    m_tilt.moveTo(tilt, now_s);
    return {};
  });
}

double SimulatedPanTilt::pan() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_pan.at(m_clock.now_s());
}

double SimulatedPanTilt::tilt() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_tilt.at(m_clock.now_s());
}

bool SimulatedPanTilt::moving() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  const double now_s = m_clock.now_s();
  return m_pan.moving(now_s) || m_tilt.moving(now_s);
}

void SimulatedPanTilt::injectFault(const std::string& why) {
  (void)onStop();
  runner().fault({ErrorCode::kInternal, why});
}

Status SimulatedPanTilt::onStop() {
  std::lock_guard<std::mutex> lock(m_mutex);
  const double now_s = m_clock.now_s();
  m_pan.halt(now_s);
  m_tilt.halt(now_s);
  return {};
}

}  // namespace longarm::hardware
