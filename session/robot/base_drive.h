#pragma once

/// @file
/// BaseDrive: drives the base as long as somebody asks for it, through the gate.

#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "core/base_motion.h"
#include "core/clock.h"
#include "core/result.h"
#include "hardware/motion_gate.h"

namespace longarm::session {

struct DriveState {
  bool driving = false;  ///< Somebody asks for it, or the base is still coming to rest.
  std::string notice;    ///< Why the last drive ended by itself; empty: nothing to say.
};

/// A wish lives for kDeadline_s; then the base brakes within its acceleration, and zero is sent kZeros times.
/// The gate is kept until odometry says that the base stands.  Thread-safe; tick() is called from one thread,
/// every 20 ms.
class BaseDrive {
 public:
  static constexpr double kDeadline_s = 0.2;
  static constexpr int kZeros = 3;
  /// Called for what happens: kind, source, text.  No lock is held.
  using Report =
      std::function<void(const std::string& kind, const std::string& source, const std::string& text)>;

  /// Gate and clock are borrowed.
  BaseDrive(std::shared_ptr<hardware::MobileBase> base, hardware::MotionGate& gate, BaseLimits limits,
            const Clock& clock, Report report);

  /// @returns kRefused: STOP is latched, the arm has the gate or still moves; as checkTwist().
  Status command(const BaseTwist& wanted);
  void release();
  DriveState state() const;
  /// One cycle.  @param alive false: the window does not answer; nothing is driven then.
  void tick(bool alive);

 private:
  void end(const std::string& notice);
  bool stands(double now_s) const;

  const std::shared_ptr<hardware::MobileBase> m_base;
  hardware::MotionGate& m_gate;
  const BaseLimits m_limits;
  const Clock& m_clock;
  const Report m_report;
  mutable std::mutex m_mutex;
  bool m_active = false;
  BaseTwist m_wanted, m_now;
  double m_wanted_s = -1e9, m_ticked_s = 0, m_zero_since_s = 0;
  int m_zeros = 0;
  std::string m_notice;
};

}  // namespace longarm::session
