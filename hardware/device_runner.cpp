#include "hardware/device_runner.h"

#include <exception>
#include <utility>

#include "core/log.h"

namespace longarm::hardware {
namespace {

constexpr const char* kCategory = "longarm.hardware.device";

}  // namespace

DeviceRunner::DeviceRunner(std::string name) : m_name(std::move(name)) {}

DeviceState DeviceRunner::state() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_state;
}

std::string DeviceRunner::message() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_message;
}

void DeviceRunner::set(DeviceState state) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_state = state;
}

void DeviceRunner::change(DeviceState from, DeviceState to) {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_state == from) m_state = to;
}

Status DeviceRunner::guarded(const char* what, const Action& action) noexcept {
  try {
    return action ? action() : Status();
  } catch (const std::exception& e) {
    return {ErrorCode::kInternal, m_name + ": " + what + " failed: " + e.what()};
  } catch (...) {
    return {ErrorCode::kInternal, m_name + ": " + what + " failed"};
  }
}

Status DeviceRunner::refused(const char* what, DeviceState state, const char* wanted) const {
  std::string why = m_name + ": " + what + " is refused while it is " + toString(state) + "; it must be " + wanted;
  if (state == DeviceState::kFault) {
    const std::string cause = message();
    why += ". The fault: " + (cause.empty() ? std::string("unknown") : cause) + ". Clear it first";
  }
  return {ErrorCode::kRefused, why};
}

Status DeviceRunner::open(const Action& start) {
  std::lock_guard<std::mutex> life(m_life_mutex);
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (m_state != DeviceState::kClosed) return {};
    m_state = DeviceState::kOpening;
    m_message.clear();
  }
  Status status = guarded("opening", start);
  if (!status) {
    trouble(status.error());
    set(DeviceState::kClosed);
  }
  return status;
}

bool DeviceRunner::opened() {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_state != DeviceState::kOpening) return false;
  m_state = DeviceState::kIdle;
  m_message.clear();
  return true;
}

void DeviceRunner::close(const Action& halt, const Action& finish) noexcept {
  std::lock_guard<std::mutex> life(m_life_mutex);
  if (state() == DeviceState::kClosed) return;
  if (auto status = guarded("stopping", halt); !status) trouble(status.error());
  if (auto status = guarded("closing", finish); !status) trouble(status.error());
  std::lock_guard<std::mutex> lock(m_mutex);
  m_state = DeviceState::kClosed;
  m_message.clear();
}

Status DeviceRunner::activate(const Action& start) {
  std::lock_guard<std::mutex> life(m_life_mutex);
  const DeviceState now = state();
  if (now != DeviceState::kIdle) return refused("activation", now, "idle");
  Status status = guarded("activation", start);
  if (!status) {
    trouble(status.error());
    return status;
  }
  change(DeviceState::kIdle, DeviceState::kActive);
  return {};
}

void DeviceRunner::deactivate(const Action& halt) noexcept {
  std::lock_guard<std::mutex> life(m_life_mutex);
  if (state() != DeviceState::kActive) return;
  stop(halt);
}

void DeviceRunner::stop(const Action& halt) noexcept {
  // The state first: what others command from now on is refused.
  change(DeviceState::kActive, DeviceState::kIdle);
  if (auto status = guarded("stopping", halt); !status) trouble(status.error());
}

Status DeviceRunner::clearFault(const Action& recover) {
  std::lock_guard<std::mutex> life(m_life_mutex);
  if (state() != DeviceState::kFault) return {};
  Status status = guarded("clearing the fault", recover);
  if (!status) {
    trouble(status.error());
    return status;
  }
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_state == DeviceState::kFault) m_state = DeviceState::kIdle;
  m_message.clear();
  return {};
}

void DeviceRunner::fault(const Error& error) noexcept {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (m_state == DeviceState::kClosed) return;
    const bool known = m_state == DeviceState::kFault && m_message == error.message;
    m_state = DeviceState::kFault;
    m_message = error.message;
    if (known) return;
  }
  logLine(LogLevel::kError, kCategory, m_name + ": " + error.message);
}

void DeviceRunner::trouble(const Error& error) noexcept {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (m_message == error.message || m_state == DeviceState::kFault) return;
    m_message = error.message;
  }
  logLine(LogLevel::kWarning, kCategory, m_name + ": " + error.message);
}

void DeviceRunner::recovered() noexcept {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_state != DeviceState::kFault) m_message.clear();
}

Status DeviceRunner::requireActive(const char* what) const {
  const DeviceState now = state();
  return now == DeviceState::kActive ? Status() : refused(what, now, "active");
}

Status DeviceRunner::command(const char* what, const Action& action) {
  if (auto status = requireActive(what); !status) return status;
  return guarded(what, action);
}

Status DeviceRunner::configure(const char* what, const Action& action) {
  const DeviceState now = state();
  if (now != DeviceState::kActive && now != DeviceState::kIdle) return refused(what, now, "idle or active");
  return guarded(what, action);
}

}  // namespace longarm::hardware
