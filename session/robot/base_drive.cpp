#include "session/robot/base_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::session {
namespace {

constexpr const char* kOwner = "drive";
constexpr double kLongestTick_s = 0.1;  // a late tick does not make a jump of the velocity
constexpr double kPatience_s = 2;       // for odometry that says the base stands

bool isLinkTrouble(ErrorCode code) { return code == ErrorCode::kStale || code == ErrorCode::kDisconnected; }

}  // namespace

BaseDrive::BaseDrive(std::shared_ptr<hardware::MobileBase> base, hardware::MotionGate& gate,
                     BaseLimits limits, const Clock& clock, Report report)
    : m_base(std::move(base)), m_gate(gate), m_limits(limits), m_clock(clock), m_report(std::move(report)) {}

Status BaseDrive::command(const BaseTwist& wanted) {
  if (auto status = checkTwist(wanted, m_limits); !status) return status;
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_gate.stopped()) return {ErrorCode::kRefused, "drive: STOP is latched; reset it first"};
  if (!m_active) {
    const auto commanded = m_gate.commandedAt(m_clock.now_s());
    if (commanded && commanded->velocities.size() > 0 && commanded->velocities.cwiseAbs().maxCoeff() > 1e-9) {
      return {ErrorCode::kRefused, "drive: the arm still moves; it must be held"};
    }
    if (auto status = m_gate.acquire(kOwner); !status) return status;
    m_active = true;
    m_now = {};
    m_ticked_s = m_clock.now_s();
    m_notice.clear();
  }
  m_wanted = wanted;
  m_wanted_s = m_clock.now_s();
  m_zeros = 0;
  return {};
}

void BaseDrive::release() {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_wanted = {};
}

DriveState BaseDrive::state() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return {m_active, m_notice};
}

bool BaseDrive::stands(double now_s) const {
  if (now_s - m_zero_since_s > kPatience_s) return true;
  const auto odometry = m_base->odometry();
  return odometry && odometry->twist.standing();
}

// `m_mutex` is held.
void BaseDrive::end(const std::string& notice) {
  m_active = false;
  m_wanted = m_now = {};
  m_notice = notice;
  m_gate.release(kOwner);
}

void BaseDrive::tick(bool alive) {
  std::unique_lock<std::mutex> lock(m_mutex);
  if (!m_active) return;
  const double now_s = m_clock.now_s();
  const double h = std::clamp(now_s - std::exchange(m_ticked_s, now_s), 0.0, kLongestTick_s);
  if (m_gate.stopped()) return end({});  // the gate has stopped the base
  if (!alive || now_s - m_wanted_s > kDeadline_s) m_wanted = {};
  m_now = rampTowards(m_now, m_wanted, m_limits, h);
  if (m_now.still() && m_wanted.still()) {
    if (m_zeros == 0) m_zero_since_s = now_s;
    if (m_zeros >= kZeros) {
      if (stands(now_s)) end({});
      return;
    }
    ++m_zeros;
  }
  const Status sent = m_gate.drive(kOwner, m_now);
  if (sent) return;
  const Error why = sent.error();
  end(why.message);
  lock.unlock();
  if (isLinkTrouble(why.code)) m_gate.stop("link", why.message);
  m_report(isLinkTrouble(why.code) ? "fault" : "refused", isLinkTrouble(why.code) ? "link" : "gate",
           why.message);
}

}  // namespace longarm::session
