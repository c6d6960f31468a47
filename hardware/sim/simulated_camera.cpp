#include "hardware/sim/simulated_camera.h"

#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {

SimulatedCamera::SimulatedCamera(std::string name, double rate_hz, std::string format, Source source,
                                 const Clock& clock)
    : RunnerDevice<Camera>(std::move(name)),
      m_rate_hz(rate_hz),
      m_format(std::move(format)),
      m_source(std::move(source)),
      m_clock(clock) {}

SimulatedCamera::~SimulatedCamera() { close(); }

void SimulatedCamera::refresh(double now_s) const {
  const auto k = static_cast<std::uint64_t>(std::max(0.0, std::floor(now_s * m_rate_hz)));
  if (m_frozen || (m_frame != nullptr && m_frame->sequence == k)) return;
  Frame frame;
  frame.camera = name();
  frame.stamp_s = static_cast<double>(k) / m_rate_hz;
  frame.received_s = now_s;
  frame.sequence = k;
  frame.format = m_format;
  frame.data = m_source ? m_source(k) : std::string();
  m_frame = std::make_shared<const Frame>(std::move(frame));
}

std::shared_ptr<const Frame> SimulatedCamera::latestFrame() const {
  const bool active = state() == DeviceState::kActive;
  std::lock_guard<std::mutex> lock(m_mutex);
  if (active) refresh(m_clock.now_s());
  return m_frame;
}

Status SimulatedCamera::setZoom(double zoom01) {
  return runner().configure("zooming", [&]() -> Status {
    if (!(zoom01 >= 0 && zoom01 <= 1)) {
      return {ErrorCode::kOutOfLimits, name() + ": zoom " + formatNumber(zoom01) + " is not within 0 ... 1"};
    }
    std::lock_guard<std::mutex> lock(m_mutex);
    m_zoom = zoom01;
    return {};
  });
}

Result<double> SimulatedCamera::zoom() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_zoom;
}

void SimulatedCamera::injectFault(const std::string& why) { runner().fault({ErrorCode::kInternal, why}); }

void SimulatedCamera::freeze(bool frozen) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_frozen = frozen;
}

Status SimulatedCamera::onStop() { return {}; }

}  // namespace longarm::hardware
