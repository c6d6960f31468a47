#pragma once

/// @file
/// What every macro does around its own idea: look at the start, keep the clock, say why it failed.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planning/collision/collision_world.h"
#include "planning/macros/grip.h"
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

  /// Unit vector against gravity in the root frame, or the root's z where nothing tells it.
  Eigen::Vector3d up() const { return m_context.up.value_or(Eigen::Vector3d::UnitZ()); }

  /// Looks at the workcell and the start: sizes, limits, collisions.  False: the plan says why.
  /// A start up to 2e-3 outside a limit is moved onto it.
  bool begin();
  /// Where the gripper touches a body that it does not hold: backs straight off it, as the plan's first stage, and
  /// starts from there.  False: the plan says why not.  @pre begin() was true.
  bool leaveContact();
  /// Instead: the motion may go on touching such bodies with the gripper's links.
  void keepContact();
  /// Arm joints from which to plan on; valid after begin().
  const Eigen::VectorXd& start() const { return m_start; }
  /// The same as a full configuration.
  const Eigen::VectorXd& configuration() const { return m_configuration; }
  /// configuration() with the gripper's joint elsewhere; unchanged without a gripper.
  Eigen::VectorXd withGripperAt(double position) const;

  /// A collision world of the workcell, the context's objects and `extra`, for motions of the arm.  What the gripper
  /// holds at q moves with the tool.  Where q is closer to something than the padding, the padding shrinks to 80 % of
  /// that, with a note.
  std::unique_ptr<CollisionWorld> makeWorld(const std::vector<WorldObject>& extra, const Eigen::VectorXd& q);

  /// The plan as it failed; as cancelled where that was asked for, whatever else is wrong.
  Plan fail(PlanStatus status, const std::string& reason, int waypoint = -1, const std::optional<Pose>& pose = {});
  /// The finished plan, or as cancelled.
  Plan finish();

  /// A collision world in which the gripper has let go at q: what it held at the start stands where `X_moved` has taken it (from
  /// where it stood then, in the root frame).  `may_touch`: the gripper's links may touch it.
  std::unique_ptr<CollisionWorld> makeReleasedWorld(const Pose& X_moved, const Eigen::VectorXd& q, bool may_touch);

 private:
  bool checkContext();
  bool checkLimits();
  std::unique_ptr<CollisionWorld> bareWorld(const std::vector<WorldObject>& extra, const Eigen::VectorXd& q,
                                            const CollisionOptions& options, bool may_touch) const;
  bool backOff(const Eigen::Vector3d& way);

  const PlanContext& m_context;
  Plan m_plan;
  double m_started = 0, m_deadline = 0;
  Eigen::VectorXd m_start, m_configuration;
  AllowedPairs m_allowed;
  std::vector<WorldObject> m_objects;    // the workcell's and the context's
  Grip m_grip;                           // where the motion starts
  bool m_keeps_contact = false;
};

/// Whether a way that enters there is one of those to find another than.
bool isAvoided(const PlanContext& context, const Eigen::VectorXd& entry);

/// "time ran out after 5.0 s ..." or "cancelled"; for kTimeout and kCancelled.
std::string interruption(PlanStatus status, double budget_s);

}  // namespace longarm::planning
