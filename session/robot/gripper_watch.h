#pragma once

/// @file
/// GripperWatch: whether a gripper that was told to open or close has done so.

#include "planning/world/workcell.h"

namespace longarm::session {

/// Sees the finger stand, the gripper say that it holds, or time run out.  Pure logic: the caller supplies time.
class GripperWatch {
 public:
  enum class Outcome { kMoving, kDone, kFailed };

  GripperWatch() = default;
  /// @param wanted  Position of the gripper's joint that was commanded [m or rad].
  /// @param grips   It must close on something; else it must arrive.
  /// @param finger  Where the joint is now.
  GripperWatch(double wanted, bool grips, double finger, double now_s)
      : m_wanted(wanted), m_grips(grips), m_finger(finger), m_begun_s(now_s), m_still_s(now_s) {}

  Outcome look(double finger, bool holding, double now_s);
  /// "The gripper closed on nothing.", for kFailed.
  const char* failure() const;

  static constexpr double kThere = 0.002;          ///< So near to where it should be, it is there [m or rad].

 private:
  double m_wanted = 0;
  bool m_grips = false;
  double m_finger = 0;                             // where it was seen last
  double m_begun_s = 0, m_still_s = 0;             // ... and since when
};

}  // namespace longarm::session
