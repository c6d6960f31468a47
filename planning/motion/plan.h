#pragma once

/// @file
/// Plans: what a macro produces, and why it could not.

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/cancel.h"
#include "core/motion.h"
#include "core/pose.h"
#include "core/result.h"
#include "planning/motion/clearance.h"
#include "planning/world/shape.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

/// The whole list of reasons a plan can end with; stable words in files and JSON.
enum class PlanStatus {
  kOk, kBadFeature, kUnreachable, kStartInCollision, kGoalInCollision, kApproachBlocked, kNoPath,
  kLimits, kTimeout, kCancelled
};
const char* toString(PlanStatus status);          ///< "ok", "bad_feature", "unreachable", ...

/// What the gripper does while the arm rests between two stages.
struct GripperStep {
  double position = 0;                            ///< Of its joint [m or rad].
  bool grips = false;                             ///< It must close on something; else it must arrive.
};

/// One named piece of a plan ("transit", "approach", "act", "retreat").
struct PlanStage {
  std::string name;
  double start_s = 0, end_s = 0;                  ///< Interval of the trajectory.
  bool straight = false;                          ///< Cartesian line of the tool.
  /// At the stage's end, before anything else moves; a motion backs up no further than to where one was done.
  std::optional<GripperStep> gripper = {};
};

struct Plan {
  PlanStatus status = PlanStatus::kNoPath;
  std::string reason;                             ///< A sentence; empty when ok.
  std::string macro;
  std::string failed_stage;                       ///< Name of the stage that could not be done; empty when ok or before any.
  std::vector<std::string> advice;                ///< What would help: sentences, each tried out and not guessed.
  int failed_waypoint = -1;
  std::optional<Pose> failed_pose;                ///< X_root_tip that was refused, to mark in the scene.
  Trajectory trajectory;                          ///< Of the arm's joints; empty unless ok.
  std::vector<PlanStage> stages;
  std::vector<WorldObject> obstacles;             ///< Bodies of the feature that it was planned around.
  std::vector<std::string> touchable;             ///< Bodies that the gripper may touch in the end.
  std::optional<WorldObject> grasped;             ///< What the gripper has between its fingers in the end, in the root frame.
  Eigen::VectorXd start_configuration;            ///< Full q the plan was made for.
  Eigen::VectorXd entry;                          ///< Arm joints where the first free motion ends; empty without one.
  Pose goal = Pose::Identity();                   ///< X_root_tip at the end.
  double planning_seconds = 0;
  double min_clearance = 0;                       ///< [m]
  ClearanceProfile clearance;                     ///< Over the trajectory's time; empty unless ok.
  double max_velocity_ratio = 0, max_acceleration_ratio = 0;   ///< Of the workcell's limits, 0 ... 1.
  std::string go = "go";                          ///< "go", "ask", "no_go": feature accuracy against the macro's need.
  std::string accuracy_note;                      ///< Why it is not "go".
  std::vector<std::string> notes;                 ///< Things the operator should know.
  std::map<std::string, double> figures;          ///< What the macro measured of its plan ("coverage", "passes", ...).
  std::map<std::string, double> pan_tilt;         ///< Joints of a pan-tilt to move to beside the arm [rad]; usually empty.

  bool ok() const { return status == PlanStatus::kOk; }
};

/// Everything a plan depends on.  Values and borrowed constants; thread-compatible.
struct PlanContext {
  const Workcell* workcell = nullptr;
  std::vector<WorldObject> objects;               ///< Beyond the workcell's own, or in place of those of the same name.
  std::vector<std::string> held;                  ///< Objects that the gripper is known to hold at the start, besides those that are seen to be.
  Eigen::VectorXd start;                          ///< Full configuration q.
  /// Unit vector against gravity in the root frame, where the robot tells it; else the root's z is taken for it.
  std::optional<Eigen::Vector3d> up;
  std::map<std::string, double> arguments;        ///< Of the macro, by MacroParameter::name; others take their default.
  std::vector<Eigen::VectorXd> avoid;             ///< Entries of plans to find another way than.
  unsigned seed = 1;
  double budget_s = 5;
  CancelToken cancel;
  std::function<void(double, const std::string&)> progress;   ///< (0..1, what); may be empty; any thread.
};

}  // namespace longarm::planning
