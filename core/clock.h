#pragma once

/// @file
/// Time as seconds.  Timeouts use a monotonic clock; only displays and records use wall time.

#include <atomic>

namespace longarm {

/// Source of monotonic seconds.  Implementations are thread-safe.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Monotonic time [s]; the origin is arbitrary.
  virtual double now_s() const = 0;
};

/// std::chrono::steady_clock.  Thread-safe.
class SteadyClock final : public Clock {
 public:
  double now_s() const override;
};

/// Time that a test or a lockstep simulation sets.  Thread-safe.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(double start_s = 0) : m_now(start_s) {}
  double now_s() const override { return m_now.load(); }
  void set(double now_s) { m_now.store(now_s); }
  void advance(double seconds) { m_now.store(m_now.load() + seconds); }

 private:
  std::atomic<double> m_now;
};

/// Wall-clock time as seconds since 1970, for display and records only.
double wallTime_s();

}  // namespace longarm
