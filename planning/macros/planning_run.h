#pragma once

/// @file
/// What every macro does around its own idea: look at the start, keep the clock, say why it failed.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/collision/collision_world.h"
#include "planning/motion/arm_space.h"
#include "planning/motion/plan.h"

namespace longarm::planning {

/// One run of a macro.  Lives as long as Macro::plan(); thread-compatible.
class PlanningRun {
 public:
  PlanningRun(const PlanContext& context, std::string macro);

  const PlanContext& context() const { return m_context; }
  const Workcell& workcell() const { return *m_context.workcell; }
  const RobotModel& model() const { return *m_context.workcell->model; }
  Plan& plan() { return m_plan; }
  double deadline_s() const { return m_deadline; }
  /// Steady seconds since the run began.
  double elapsed() const;
  bool timeUp() const;
  bool cancelled() const { return m_context.cancel.cancelled(); }
  void progress(double fraction, const std::string& what) const;

  /// Looks at the workcell and the start: sizes, limits, collisions.  False: the plan says why.
  /// A start up to 2e-3 outside a limit is moved onto it.
  bool begin();
  /// Arm joints at the start; valid after begin().
  const Eigen::VectorXd& start() const { return m_start; }

  /// A collision world of the workcell, the context's objects and `extra`, for motions of the arm.  Where the start is
  /// closer to something than the padding, the padding shrinks to 80 % of that, with a note.
  std::unique_ptr<CollisionWorld> makeWorld(const std::vector<WorldObject>& extra, const Eigen::VectorXd& q);

  /// The plan as it failed.
  Plan fail(PlanStatus status, const std::string& reason, int waypoint = -1, const std::optional<Pose>& pose = {});
  /// The finished plan.
  Plan finish();

 private:
  bool checkContext();
  bool checkLimits();

  const PlanContext& m_context;
  Plan m_plan;
  double m_started = 0, m_deadline = 0;
  Eigen::VectorXd m_start;
  AllowedPairs m_allowed;
};

/// "time ran out after 5.0 s ..." or "cancelled"; for kTimeout and kCancelled.
std::string interruption(PlanStatus status, double budget_s);

}  // namespace longarm::planning
