#pragma once

/// @file
/// Tasks into timed motions: everything known to be possible before the first stage is planned in detail.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/macros/planning_run.h"
#include "planning/macros/reach_advice.h"
#include "planning/macros/task_search.h"
#include "planning/macros/tool_task.h"

namespace longarm::planning {

/// What a macro asks for.
struct ToolJob {
  std::string subject;                   ///< "the point", for sentences.
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   ///< Where it is, for advice on reach [m].
  std::vector<TaskPart> parts;           ///< In order; joined by free motions.
  std::vector<WorldObject> obstacles;    ///< Of the feature itself.
  std::vector<std::string> touchable;    ///< Objects that touching stages may touch with the gripper's links.
  /// So many parts at least, where they are optional.  More than 1: why not is told of the part in the middle.
  std::size_t least_parts = 1;
  bool in_base_frame = false;            ///< The place goes with the base: driving brings it no nearer.
  bool open_gripper = false;             ///< Planned with the gripper open.
  std::optional<WorldObject> grasped;    ///< What is between the fingers in the end.
  double touch_padding = 0.002;          ///< Around everything else in touching stages [m].
};

/// The full configuration with the gripper open, and a note in the plan where it was not; unchanged without a gripper.
Eigen::VectorXd withGripperOpen(PlanningRun& run);

/// What a job is searched in.
struct TaskWorlds {
  std::unique_ptr<CollisionWorld> free;      ///< Everything is an obstacle.
  std::unique_ptr<CollisionWorld> touching;  ///< The gripper's links may touch what the job touches.
};
/// @param q  Full configuration that other joints keep.
TaskWorlds makeTaskWorlds(PlanningRun& run, const ToolJob& job, const Eigen::VectorXd& q);

/// One run of a job.  Fills the run's plan: stages, trajectory, clearance, goal, status.
class TaskPlanner {
 public:
  TaskPlanner(PlanningRun& run, const ToolJob& job) : m_run(run), m_job(job) {}
  /// @pre run.begin() was true.
  Plan plan();
  /// Where the arm's other joints stand in the plan (gripper).
  const Eigen::VectorXd& configuration() const { return m_q; }

 private:
  bool search(TaskSearch& search, const ArmSpace& free);
  bool searchPart(TaskSearch& search, const ArmSpace& free, std::size_t part, const Eigen::VectorXd& from);
  bool possible(TaskSearch& search, const TaskPart& part);
  bool move(const ArmSpace& free, TaskSearch& search, const TaskPart& part, std::vector<FollowedTask> found,
            const Eigen::VectorXd& from);
  bool time(const ArmSpace& free, TaskSearch& search, const TaskPart& part, const FollowedTask& task,
            const std::vector<Eigen::VectorXd>& way);
  static std::vector<std::vector<Pose>> waysOf(const TaskPart& part);
  void dropAvoided(std::vector<FollowedTask>& found);
  Plan explain(const TaskRefusals& refusals, const TaskPart& part, const ArmSpace& free);
  Plan explainReach(const std::string& few, const std::optional<Pose>& pose, const TaskPart& part, const ArmSpace& free);
  Plan explainStop(const TaskRefusals& refusals, const TaskPart& part, const ArmSpace& free);
  std::string target() const { return m_job.obstacles.empty() ? std::string() : m_job.obstacles.front().name; }
  bool interrupted() const { return m_run.cancelled() || m_run.timeUp(); }

  PlanningRun& m_run;
  const ToolJob& m_job;
  Eigen::VectorXd m_q;
  void leaveOut(const TaskPart& part);
  std::string fewParts() const;

  std::size_t m_failed_part = 0, m_possible = 0;
  bool m_any_goal = false;               // of the part that failed
  bool m_any_avoided = false;
};

}  // namespace longarm::planning
