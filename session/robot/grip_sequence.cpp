#include "session/robot/grip_sequence.h"

#include <algorithm>

namespace longarm::session {

GripSequence::GripSequence(const planning::Plan& plan, std::size_t done) : m_duration(plan.trajectory.duration()) {
  for (const auto& stage : plan.stages) {
    if (stage.gripper) m_steps.push_back({std::min(stage.end_s, m_duration), *stage.gripper});
  }
  m_done = std::min(done, m_steps.size());
}

}  // namespace longarm::session
