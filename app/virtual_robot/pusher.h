#pragma once

/// @file
/// Pusher: what the gripper pushes aside.

#include <vector>

#include <Eigen/Core>

#include "app/virtual_robot/true_world.h"
#include "core/pose.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {

/// The links of the gripper against the scenario's bodies that slide: one that a link enters by a side is moved out of it over
/// the plane that it stands on, as slowly as the link comes: without inertia.  Where it goes follows from friction alone, by the
/// ellipsoid that bounds what friction bears (Lynch, Maekawa, Tanie, "Manipulation and active sensing by pushing using tactile
/// feedback", IROS 1992, eq. 3 to 5, pressure taken as even).  Upright boxes and cylinders only.  Thread-compatible.
class Pusher {
 public:
  /// Borrows the workcell.  @pre it has a gripper.
  explicit Pusher(const planning::Workcell& workcell);

  /// @param q  True configuration (full), with the base at X_WB.
  void step(const Eigen::VectorXd& q, const Pose& X_WB, TrueWorld& world) const;

 private:
  struct Part {
    int link;
    std::vector<Eigen::Vector3d> points;           ///< Of its surface, in the link's frame [m].
    double radius;                                 ///< Around the link's origin [m].
  };

  const planning::Workcell& m_workcell;
  std::vector<Part> m_parts;
};

}  // namespace longarm::virtual_robot
