#pragma once

/// @file
/// Which ways of doing one part of a task the arm can follow from beginning to end.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/macros/planning_run.h"
#include "planning/macros/reach_advice.h"
#include "planning/macros/reach_answer.h"
#include "planning/macros/tool_task.h"
#include "planning/motion/ladder.h"
#include "planning/motion/straight_leg.h"
#include "planning/robot/ik.h"

namespace longarm::planning {

/// A way that the arm can follow: every waypoint of every stage, checked for collisions.
struct FollowedTask {
  const ToolTask* task = nullptr;
  Eigen::VectorXd entry;                 ///< Arm joints where the stages begin.
  std::vector<StraightLeg> legs;         ///< One per stage.
  const Eigen::VectorXd& exit() const { return legs.empty() ? entry : legs.back().waypoints.back(); }
};

/// Why ways were refused, counted over all that were looked at; the details are of the one that came furthest.
struct TaskRefusals {
  int unreachable = 0;                   ///< No joints reach the entry.
  int colliding = 0;                     ///< They do, but touch something there.
  int stopped = 0;                       ///< A stage cannot be followed to its end.
  std::optional<Contact> stop_contact;   ///< ... because something is in the way.
  double furthest = -1;                  ///< Stage number plus the share of it that was reached.
  std::string stage, why;                ///< Of the furthest; `why` is a clause.
  int waypoint = -1;                     ///< Rung at which it stopped.
  std::optional<Pose> pose;              ///< The pose that was refused.
  Contact contact;                       ///< One of the collisions at an entry.
};

/// Borrows everything; lives within one Macro::plan().
class TaskSearch {
 public:
  /// @param free      Space in which everything is an obstacle.
  /// @param touching  In which the gripper's links may touch what the task touches.
  TaskSearch(PlanningRun& run, const ArmSpace& free, const ArmSpace& touching);

  /// Ways to do tasks [first, last) of the part, at most `enough`, those nearest to `from` first.  All entries and
  /// coarse stations come before any fine waypoint.  Empty: see refusals(), or the run was interrupted.
  std::vector<FollowedTask> find(const TaskPart& part, std::size_t first, std::size_t last, const Eigen::VectorXd& from,
                                 std::size_t enough);
  /// A look at entries and coarse stations only: the first way of the part that is free, tried first as `seed` did it.
  std::optional<ReachSeed> glance(const TaskPart& part, const Eigen::VectorXd& from, const ReachSeed& seed);
  const TaskRefusals& refusals() const { return m_refusals; }
  /// What a stage is looked at in.
  const ArmSpace& spaceOf(const ToolStage& stage) const;

 private:
  struct Rungs;
  struct Rough;
  void watch(const ToolTask& task, Rungs& rungs);
  std::optional<ReachSeed> glanceAt(const TaskPart& part, int task, const Eigen::VectorXd& start, double roll, int restarts);
  std::vector<Rough> entries(const TaskPart& part, const ToolTask& task, const Rungs& rungs, const Eigen::VectorXd& from);
  void addPostures(const Pose& X_RT, double roll, const Rungs& rungs, const Eigen::VectorXd& from, std::vector<Rough>& out);
  std::vector<Rough> roughWays(const TaskPart& part, const ToolTask& task, const Rungs& rungs, const Eigen::VectorXd& from,
                               std::size_t enough);
  std::optional<StraightLeg> followStage(const ToolTask& task, std::size_t k, const Rungs& rungs,
                                         const std::vector<double>& rolls, const Eigen::VectorXd& arm);
  std::optional<FollowedTask> refine(const ToolTask& task, const Rungs& rungs, const Rough& rough);
  void noteStop(const ToolTask& task, const Rungs& rungs, std::size_t reached, const std::optional<Contact>& contact,
                const std::string& why = {});
  bool stop() const { return m_run.cancelled() || m_run.timeUp(); }

  /// For stages after the gripper has let go; made when one is looked at.
  struct Released {
    Pose X_moved;
    bool touching;
    std::unique_ptr<CollisionWorld> world;
    std::unique_ptr<ArmSpace> space;
  };

  PlanningRun& m_run;
  const ArmSpace& m_free;
  const ArmSpace& m_touching;
  IkSolver m_solver;
  Reach m_reach;
  TaskRefusals m_refusals;
  mutable std::vector<Released> m_released;
  std::optional<Contact> m_rung_contact;         // why the last rung that was refused was
};

}  // namespace longarm::planning
