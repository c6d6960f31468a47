#include "session/robot/gripper_watch.h"

#include <cmath>

namespace longarm::session {

namespace {

constexpr double kStill_s = 1.0;         // without moving: it has arrived, or met something
constexpr double kLast_s = 15;           // no gripper takes longer

}  // namespace

GripperWatch::Outcome GripperWatch::look(double finger, bool holding, double now_s) {
  if (std::abs(finger - m_finger) > kThere / 4) {
    m_finger = finger;
    m_still_s = now_s;
  }
  const bool there = std::abs(finger - m_wanted) < kThere;
  if (m_grips ? holding : there) return Outcome::kDone;
  const bool still = now_s - m_still_s > kStill_s && now_s - m_begun_s > 2 * kStill_s;
  return still || now_s - m_begun_s >= kLast_s ? Outcome::kFailed : Outcome::kMoving;
}

const char* GripperWatch::failure() const { return m_grips ? "The gripper closed on nothing." : "The gripper does not get to where it should."; }

}  // namespace longarm::session
