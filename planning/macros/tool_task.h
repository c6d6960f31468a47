#pragma once

/// @file
/// What a macro wants the tool to do, before anybody knows whether the arm can.

#include <optional>
#include <string>
#include <vector>

#include "core/pose.h"
#include "planning/motion/plan.h"
#include "planning/motion/tool_path.h"

namespace longarm::planning {

/// One Cartesian piece of a task ("approach", "act", "retreat"); it begins where the one before it ended, at rest.
struct ToolStage {
  std::string name;
  ToolPath path;                         ///< Of the tool frame, in the root frame.
  double speed = 0.05;                   ///< Of the tool's origin [m/s].
  bool straight = true;                  ///< As PlanStage::straight.
  bool touching = false;                 ///< The gripper's links may touch the task's touchable objects.
  /// The gripper has let go: planned with it open.  What it held at the start stands where this has taken it from there, in the
  /// root frame; with `touching` the gripper's links may touch it.
  std::optional<Pose> X_released = {};
  std::optional<GripperStep> gripper = {};   ///< At the stage's end.
};

/// One way to do it: a place to go to freely, then stages without a break.
struct ToolTask {
  Pose X_entry = Pose::Identity();       ///< X_RT where the first stage begins, or the goal when there are no stages.
  std::vector<ToolStage> stages;
  int preference = 0;                    ///< Lower ones are tried first; equal ones compete.
  bool roll_free = false;                ///< Any turn about tool z will do, and it may change on the way.
  int restarts = 5;                      ///< Of the inverse kinematics, per pose of the entry.
  std::string note;                      ///< Told to the operator when this way is taken.
};

/// What has to be done at one place; any of the tasks will do.
struct TaskPart {
  std::string name;                      ///< "face 1": for sentences; may be empty.
  bool from_here = false;                ///< The tool starts where it is: no free motion, X_entry is not used.
  bool optional = false;                 ///< Left out, with a note, when it cannot be done.
  std::vector<ToolTask> tasks;
};

}  // namespace longarm::planning
