#pragma once

/// @file
/// The arm's joints as the space that motions are planned in; everything else of the robot stays where it is.

#include <Eigen/Core>

#include "core/cancel.h"
#include "core/pose.h"
#include "planning/collision/collision_world.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// Borrows the workcell and the collision world.  Thread-compatible, as the world is.
class ArmSpace {
 public:
  /// @param q  Full configuration that the other joints keep.
  /// @param cancel  Whoever works in the space stops soon after: from then on nothing is free.
  ArmSpace(const Workcell& workcell, CollisionWorld& world, Eigen::VectorXd q, CancelToken cancel = {});

  const RobotModel& model() const { return *m_workcell->model; }
  const JointGroup& group() const { return m_workcell->arm; }
  CollisionWorld& world() const { return *m_world; }
  int size() const { return static_cast<int>(m_workcell->arm.joints.size()); }
  const Eigen::VectorXd& lower() const { return m_lower; }     ///< Finite: +-2 pi where the joint has no limit.
  const Eigen::VectorXd& upper() const { return m_upper; }

  bool cancelled() const { return m_cancel.cancelled(); }
  Eigen::VectorXd full(const Eigen::VectorXd& arm) const;
  Pose tip(const Eigen::VectorXd& arm) const;
  bool withinLimits(const Eigen::VectorXd& arm, double tolerance = 1e-9) const;
  bool valid(const Eigen::VectorXd& arm, Contact* contact = nullptr) const;
  bool segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact = nullptr) const;
  /// Way of the tool per unit of a path's parameter, |J_linear dq| [m].
  double toolWay(const Eigen::VectorXd& arm, const Eigen::VectorXd& dq) const;

 private:
  const Workcell* m_workcell;
  CollisionWorld* m_world;
  Eigen::VectorXd m_q;
  mutable Eigen::VectorXd m_scratch;       // a full configuration, to save allocating one for every check
  Eigen::VectorXd m_lower, m_upper;
  int m_tip = 0;
  CancelToken m_cancel;
};

}  // namespace longarm::planning
