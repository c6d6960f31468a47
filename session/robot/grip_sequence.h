#pragma once

/// @file
/// GripSequence: which stretch of a plan may be played between what the gripper has to do.

#include <cstddef>
#include <vector>

#include "planning/motion/plan.h"

namespace longarm::session {

/// The gripper's steps of a plan in order, and how many of them are done.  A motion stays between the last that is done, for what
/// was let go of or taken there does not come back along with it, and the next.  A value.
class GripSequence {
 public:
  GripSequence() = default;
  /// @param done  So many of the plan's steps were done already (a correction keeps them).
  explicit GripSequence(const planning::Plan& plan, std::size_t done = 0);

  bool empty() const { return m_steps.empty(); }
  std::size_t size() const { return m_steps.size(); }
  std::size_t done() const { return m_done; }
  double low() const { return m_done > 0 ? m_steps[m_done - 1].at_s : 0; }              ///< [s]
  double high() const { return m_done < m_steps.size() ? m_steps[m_done].at_s : m_duration; }
  /// Null when none is left.
  const planning::GripperStep* next() const { return m_done < m_steps.size() ? &m_steps[m_done].step : nullptr; }
  /// Whether the arm, resting at tau, waits for next().
  bool due(double tau_s) const { return m_done < m_steps.size() && tau_s >= high() - kAt_s; }
  /// Whether it rests where the last one was done: there is no way back.
  bool atLow(double tau_s) const { return m_done > 0 && tau_s <= low() + kAt_s; }
  /// next() is done.  @pre there is one
  void finish() { ++m_done; }

 private:
  static constexpr double kAt_s = 1e-4;
  struct At {
    double at_s;
    planning::GripperStep step;
  };
  std::vector<At> m_steps;
  double m_duration = 0;
  std::size_t m_done = 0;
};

}  // namespace longarm::session
