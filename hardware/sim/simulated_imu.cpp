#include "hardware/sim/simulated_imu.h"

#include <utility>

namespace longarm::hardware {

SimulatedImu::SimulatedImu(std::string name, const Clock& clock) : RunnerDevice<Imu>(std::move(name)), m_clock(clock) {}

SimulatedImu::~SimulatedImu() { close(); }

std::shared_ptr<const Attitude> SimulatedImu::attitude() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_frozen) return m_frozen;
  return std::make_shared<const Attitude>(Attitude{m_clock.now_s(), m_up});
}

void SimulatedImu::tilt(const Eigen::Vector3d& up) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_up = up.normalized();
}

void SimulatedImu::freeze(bool on) {
  const auto now = on ? attitude() : nullptr;
  std::lock_guard<std::mutex> lock(m_mutex);
  m_frozen = now;
}

}  // namespace longarm::hardware
