#include "hardware/drivers/rosbridge/joint_history.h"

#include <algorithm>
#include <utility>

#include "core/text.h"

namespace longarm::hardware {
namespace {

constexpr double kSetBack_s = 1.0;
constexpr double kRounding_s = 1e-6;     // a stamp that went through ROS time and back
constexpr std::size_t kMaxStates = 4096;

JointState between(const JointState& a, const JointState& b, double stamp_s) {
  if (a.names != b.names || b.stamp_s <= a.stamp_s) return b;
  const double part = std::clamp((stamp_s - a.stamp_s) / (b.stamp_s - a.stamp_s), 0.0, 1.0);
  JointState out = a;
  out.positions += part * (b.positions - a.positions);
  if (a.velocities.size() == b.velocities.size()) out.velocities += part * (b.velocities - a.velocities);
  return out;
}

}  // namespace

bool JointHistory::add(JointState state) {
  if (!m_states.empty()) {
    const double newest = m_states.back()->stamp_s;
    if (state.stamp_s < newest - kSetBack_s) {
      clear();
    } else if (state.stamp_s <= newest) {
      return false;
    }
  }
  m_states.push_back(std::make_shared<const JointState>(std::move(state)));
  const double oldest = m_states.back()->stamp_s - m_span_s;
  while (m_states.size() > kMaxStates || m_states.front()->stamp_s < oldest) m_states.pop_front();
  return true;
}

Result<JointState> JointHistory::at(double stamp_s) const {
  if (m_states.empty()) return Error{ErrorCode::kStale, "no joint state has come from the robot yet"};
  const double oldest = m_states.front()->stamp_s, newest = m_states.back()->stamp_s;
  if (!(stamp_s >= oldest - kRounding_s && stamp_s <= newest + kRounding_s)) {
    return Error{ErrorCode::kStale, "no joint state for a time " + formatFixed(newest - stamp_s, 3) +
                                        " s before the newest; the last " + formatFixed(newest - oldest, 2) +
                                        " s are kept"};
  }
  const auto after = std::lower_bound(m_states.begin(), m_states.end(), stamp_s,
                                      [](const auto& state, double t) { return state->stamp_s < t; });
  JointState out = after == m_states.end()     ? *m_states.back()
                   : after == m_states.begin() ? *m_states.front()
                                               : between(**(after - 1), **after, stamp_s);
  out.stamp_s = stamp_s;
  return out;
}

}  // namespace longarm::hardware
