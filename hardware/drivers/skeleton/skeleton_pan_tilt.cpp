#include "hardware/drivers/skeleton/skeleton_pan_tilt.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {

SkeletonPanTilt::SkeletonPanTilt(std::string name, Settings settings, const Clock& clock)
    : RunnerDevice<PanTilt>(std::move(name)), m_settings(std::move(settings)), m_clock(clock) {}

SkeletonPanTilt::~SkeletonPanTilt() { close(); }

// Returns at once: the thread connects and then says opened().
Status SkeletonPanTilt::onOpen() {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_quit = false;
    m_has_command = false;
  }
  m_thread = std::thread([this] { run(); });
  return {};
}

Status SkeletonPanTilt::onClose() {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_quit = true;
  }
  m_wake.notify_all();
  if (m_thread.joinable()) m_thread.join();
  return {};
}

Status SkeletonPanTilt::moveTo(double pan, double tilt) {
  return runner().command("aiming", [&]() -> Status {
    if (!(std::abs(pan) <= m_settings.reach && std::abs(tilt) <= m_settings.reach)) {
      return {ErrorCode::kOutOfLimits, name() + ": " + formatNumber(pan) + ", " + formatNumber(tilt) +
                                           " rad is not within +-" + formatNumber(m_settings.reach) + " rad"};
    }
    {
      std::lock_guard<std::mutex> lock(m_mutex);   // newest wins
      m_wanted_pan = pan;
      m_wanted_tilt = tilt;
      m_commanded_s = m_clock.now_s();
      m_has_command = true;
    }
    m_wake.notify_all();
    return {};
  });
}

Status SkeletonPanTilt::onStop() {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    m_has_command = false;               // a real unit is sent its halt command here, past every queue
  }
  m_moving = false;
  return {};
}

void SkeletonPanTilt::run() {
  runner().opened();                     // a real driver: after the unit has answered
  std::unique_lock<std::mutex> lock(m_mutex);
  while (!m_quit) {
    m_wake.wait_for(lock, std::chrono::milliseconds(50));
    if (!m_has_command) continue;
    m_has_command = false;
    if (m_clock.now_s() - m_commanded_s > m_settings.command_deadline_s) continue;   // too old to obey
    m_moving = true;
    m_pan = m_wanted_pan;                // a real driver: unlock, write, read back with a timeout
    m_tilt = m_wanted_tilt;
    m_moving = false;
  }
}

}  // namespace longarm::hardware
