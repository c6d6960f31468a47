#pragma once

/// @file
/// Grab Pipe: takes hold of a sketched line, from above where that can be, by its middle where that can be.

#include "planning/macros/macro.h"

namespace longarm::planning {

struct GrabPipeOptions {
  double radius = 0.02;                  ///< Of the pipe [m].
  double allowance = 0.005;              ///< Added to it as an obstacle [m].
  double standoff = 0.10;                ///< Length of the straight last leg [m].
  double approach_padding = 0.002;       ///< Around everything else during the last leg [m].
  int enough_goals = 10;                 ///< Ways to hold it that one search is given.
  int iterations = 4000;                 ///< Samples of one search.
};

/// Two stages: "transit" to a place 0.10 m back from the grasp, with the whole pipe as an obstacle; "approach", straight
/// along tool z at the workcell's approach speed, in which only the gripper's links may touch the pipe.  Both are
/// planned with the gripper open.  At its end the tool's origin lies on the pipe's axis, tool x along it.
///
/// Grasps within the same few degrees of straight-from-above go to the planner together, as many goals; more tilted
/// ones only when those give no motion; other places along the pipe, with a note, only when its middle gives none.
class GrabPipe final : public Macro {
 public:
  explicit GrabPipe(GrabPipeOptions options = {});
  MacroInfo info() const override;
  Plan plan(const PlanContext& context, const vision::Feature* feature) const override;
  ReachAnswer reach(const PlanContext& context, const vision::Feature& feature, const ReachSeed& seed) const override;

 private:
  Result<GrabPipeOptions> optionsFor(const PlanContext& context, const vision::Feature& feature) const;
  GrabPipeOptions m_options;
};

}  // namespace longarm::planning
