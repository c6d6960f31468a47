#pragma once

/// @file
/// TaskRun: one run of a task, stage by stage.

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "planning/motion/plan.h"
#include "planning/world/scenario.h"
#include "session/controllers/snapshot_maker.h"
#include "session/robot/robot_runtime.h"
#include "session/task/synthetic_operator.h"
#include "session/task/task_faults.h"
#include "session/robot/grip_sequence.h"
#include "session/task_runner.h"
#include "vision/sketch/feature.h"

namespace longarm::session {

/// What one stage has to say: a sentence for the table, or why it failed.
using StageResult = Result<std::string>;

/// Used once.  Thread-compatible; the runtime inside has a motion thread of its own.
class TaskRun {
 public:
  TaskRun(const planning::Workcell& workcell, planning::Scenario scenario, const TaskOptions& options, TaskFaults faults);
  ~TaskRun();

  /// Starts the robot.  @returns the errors of RobotRuntime::start().
  Status start();
  /// All stages; the report ends with the first that failed.
  TaskReport run();

  /// For judges: the plan, once there is one, and how many pairs of bodies have truly touched that must not.
  const std::optional<planning::Plan>& plan() const { return m_plan; }
  std::size_t contacts();

 private:
  StageResult connect();
  /// One thing to do: marks it, plans, plays, and takes hold if that is wanted.  False: a stage failed.
  bool step(const planning::ScenarioStep& step, TaskReport& report);
  bool stage(const char* name, StageResult (TaskRun::*work)(), TaskReport& report);
  StageResult aim();
  StageResult snapshot();
  StageResult measure();
  StageResult makePlan();
  StageResult openGripper();
  StageResult play();
  StageResult closeGripper();
  StageResult lift();
  StageResult verify();

  /// Lets time pass until the condition holds.  @returns kTimeout with `what`, kRefused after a STOP, kDisconnected when
  /// the robot is gone, kCancelled.
  Status waitFor(const std::function<bool()>& condition, double timeout_s, const std::string& what);
  Status pass();
  Status checkRobot();
  Status playLoaded(double timeout_s, bool with_faults);
  /// The gripper's next step of the plan, the arm resting where it is due.
  Status actBetweenStages();
  Result<TaskTruth> truth();
  /// Where the step under way is to be clicked, in the world.
  Result<std::vector<Eigen::Vector3d>> places(const TaskTruth& truth) const;
  std::optional<StampedFrame> freshFrame(const std::string& camera, double after_s) const;
  std::optional<TaskStop> firstStop() const;
  void settleAfterStop();
  double elapsed() const;

  const std::shared_ptr<const planning::Workcell> m_workcell;
  const planning::Scenario m_scenario;
  const TaskOptions m_options;
  std::vector<planning::ScenarioStep> m_task;
  planning::ScenarioStep m_step;         // the one under way
  std::optional<planning::WorldObject> m_grasped;
  TaskFaults m_faults;
  SyntheticHand m_hand;
  double m_started_s = 0, m_lost_since_s = -1;
  std::pair<std::string, std::string> m_cameras;
  std::vector<vision::Snapshot> m_snapshots;
  std::optional<vision::Feature> m_feature;
  std::optional<planning::Plan> m_plan;
  GripSequence m_grips;                  // of the motion under way
  mutable std::mutex m_mutex;            // guards m_stops
  std::vector<TaskStop> m_stops;
  std::unique_ptr<RobotRuntime> m_runtime;   // ends first: it reports into the above
};

}  // namespace longarm::session
