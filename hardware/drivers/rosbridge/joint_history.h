#pragma once

/// @file
/// JointHistory: the joint states of the last seconds, to be asked for any moment between them.

#include <deque>
#include <memory>

#include "core/motion.h"
#include "core/result.h"

namespace longarm::hardware {

/// Stamps are the robot's throughout.  Thread-compatible.
class JointHistory {
 public:
  explicit JointHistory(double span_s = 8) : m_span_s(span_s) {}

  /// @returns whether it is newer than all before.  Older ones are dropped, unless they are so much older that the
  /// robot's clock must have been set back: then history begins anew.
  bool add(JointState state);
  /// Linear between the two states around `stamp_s`; kStale outside what is kept.
  Result<JointState> at(double stamp_s) const;
  /// Null before the first.
  std::shared_ptr<const JointState> newest() const { return m_states.empty() ? nullptr : m_states.back(); }
  void clear() { m_states.clear(); }

 private:
  const double m_span_s;
  std::deque<std::shared_ptr<const JointState>> m_states;   // oldest first
};

}  // namespace longarm::hardware
