#pragma once

/// @file
/// Gripper: two fingers that close at a rate, stop on what is between them and carry it.

#include <optional>

#include "app/virtual_robot/finger_zone.h"
#include "app/virtual_robot/joint_servo.h"
#include "app/virtual_robot/true_world.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {

/// Thread-compatible.
class Gripper {
 public:
  /// Starts open.  @pre the workcell has the gripper that `zone` was made of
  Gripper(const planning::Workcell& workcell, const FingerZone& zone);

  /// Wanted position of the gripper joint; kept within its limits.
  void command(double joint) { m_servo.moveTo(joint); }
  /// One tick with the tool at X_WT: fingers that meet a graspable object push it until both touch, then hold it; a
  /// command to open lets it go.  `slipping`: what is held slides down out of the fingers.
  void step(double seconds, const Pose& X_WT, bool slipping, TrueWorld& world);

  double position() const { return m_servo.position(); }
  double velocity() const { return m_grip ? 0 : m_servo.velocity(); }
  bool holding() const { return m_grip.has_value(); }

 private:
  void close(double before, const Pose& X_WT, TrueWorld& world);
  bool meet(std::size_t index, double before, const Pose& X_WT, TrueWorld& world);
  void keep(double seconds, const Pose& X_WT, bool slipping, TrueWorld& world);

  FingerZone m_zone;
  JointServo m_servo;
  std::optional<double> m_grip;          // joint position at which it holds something
};

}  // namespace longarm::virtual_robot
