#pragma once

/// @file
/// Which grasps of a pipe the arm can take: inverse kinematics, collisions, the straight last leg.

#include <optional>
#include <string>
#include <vector>

#include "planning/macros/grab_pipe.h"
#include "planning/macros/pipe_grasp.h"
#include "planning/macros/planning_run.h"
#include "planning/motion/straight_leg.h"
#include "planning/robot/ik.h"

namespace longarm::planning {

/// A grasp that the arm can take, and the leg that leads to it.
struct ReachableGrasp {
  PipeGrasp grasp;
  StraightLeg leg;                       ///< From the place 0.10 m back to the grasp.
};

/// Why grasps were refused, counted over all that were looked at.
struct GraspRefusals {
  int unreachable = 0;                   ///< No joints reach the grasp.
  int colliding = 0;                     ///< They do, but touch something there.
  int blocked = 0;                       ///< The straight leg to it is not possible or not free.
  Contact contact;                       ///< One of the collisions.
  std::string leg;                       ///< One of the reasons of a blocked leg.
  std::optional<Pose> pose;              ///< The first grasp that was refused.
};

class GraspSearch {
 public:
  /// @param transit   Space in which the pipe is an obstacle.  @param approach  In which the gripper may touch it.
  GraspSearch(PlanningRun& run, const ArmSpace& transit, const ArmSpace& approach, const GrabPipeOptions& options);

  /// Appends the ways to take one grasp (several when the arm has several postures for it).
  void tryGrasp(const PipeGrasp& grasp, std::vector<ReachableGrasp>& out);
  const GraspRefusals& refusals() const { return m_refusals; }

 private:
  bool tryPosture(const PipeGrasp& grasp, const Eigen::VectorXd& arm, std::vector<ReachableGrasp>& out);

  PlanningRun& m_run;
  const ArmSpace& m_transit;
  const ArmSpace& m_approach;
  const GrabPipeOptions& m_options;
  IkSolver m_solver;
  GraspRefusals m_refusals;
};

}  // namespace longarm::planning
