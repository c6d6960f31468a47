#pragma once

/// @file
/// What all macros for features share: arguments, geometry, accuracy, planning, and no exception that escapes.

#include <functional>
#include <string>

#include "planning/macros/feature_geometry.h"
#include "planning/macros/macro.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/planning_run.h"
#include "planning/macros/reach_advice.h"
#include "planning/macros/task_planner.h"

namespace longarm::planning {

/// What a macro is given to describe its job with, and the job.
struct MacroSetup {
  PlanningRun& run;
  const MacroArguments& arguments;
  RootedFeature feature;
  Pose X_RT = Pose::Identity();          ///< Tool at the start.
  Reach reach = {};                      ///< Shoulder and length of the arm.
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();   ///< The first camera, or the shoulder: which side of a surface is seen [m].
  ToolJob job = {};                      ///< To be filled.
  bool arm_stays = false;                ///< Nothing for the arm to do (the plan's pan_tilt says the rest).
  /// Called with the finished plan, to add figures; may be empty.
  std::function<void(const ArmSpace&, Plan&)> measure = {};
};

class FeatureMacro : public Macro {
 public:
  Plan plan(const PlanContext& context, const vision::Feature* feature) const final;
  ReachAnswer reach(const PlanContext& context, const vision::Feature& feature, const ReachSeed& seed) const final;

 protected:
  /// Describes the job.  @returns an Error whose message ends the plan as a bad feature (kOutOfLimits: as limits).
  virtual Status describe(MacroSetup& setup) const = 0;

 private:
  /// Calls `use` with the described job; what fails before that is the plan that is returned.
  Plan run(const PlanContext& context, const vision::Feature& feature, const std::function<Plan(MacroSetup&)>& use) const;
  Plan planJob(MacroSetup& setup) const;
};

}  // namespace longarm::planning
