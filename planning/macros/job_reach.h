#pragma once

/// @file
/// Whether a macro can reach what is marked, in milliseconds: for buttons while a feature is dragged.

#include <string>

#include <Eigen/Core>

#include "planning/macros/planning_run.h"
#include "planning/macros/reach_answer.h"
#include "planning/macros/tool_task.h"

namespace longarm::planning {

struct ToolJob;

/// Looks at entries and coarse stations of the job's first part only (of as many as are needed, where that is several), first in the way that `seed` did it: what was
/// reached a moment ago and moved a little takes one inverse kinematics per station.
/// kReached: the best way; kStrained: a less preferred one, or none found before the run's deadline; kNot: no way.
ReachAnswer reachOfJob(PlanningRun& run, const ToolJob& job, const ReachSeed& seed);

}  // namespace longarm::planning
