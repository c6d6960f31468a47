#include "planning/macros/free_move.h"

#include "planning/motion/path_planner.h"
#include "planning/motion/timed_motion.h"

namespace longarm::planning {

bool appendFreeMove(PlanningRun& run, const ArmSpace& space, const Eigen::VectorXd& goal,
                    const std::string& where, const std::string& stage) {
  const auto failed = [&run](PlanStatus status, const std::string& reason, int waypoint = -1,
                             const std::optional<Pose>& pose = {}) {
    run.fail(status, reason, waypoint, pose);
    return false;
  };
  run.progress(0.2, "searching a path");
  PathRequest request;
  request.start = run.start();
  request.goals = {goal};
  request.seed = run.context().seed;
  request.deadline_s = run.deadline_s();
  request.cancel = run.context().cancel;
  const PathAnswer path = planPath(space, request);
  if (path.status == PlanStatus::kTimeout || path.status == PlanStatus::kCancelled) {
    return failed(path.status, interruption(path.status, run.context().budget_s));
  }
  if (path.status != PlanStatus::kOk) {
    return failed(PlanStatus::kNoPath,
                  "No collision-free way to " + where + " was found in " + std::to_string(path.iterations) +
                      " tries. Jog the arm away from obstacles and plan again.",
                  1, run.plan().goal);
  }
  run.progress(0.7, "timing the motion");
  const auto trajectory = timedPath(run.workcell(), space, path.waypoints, {run.workcell().max_tool_speed});
  if (!trajectory) return failed(PlanStatus::kNoPath, trajectory.error().message);
  if (run.cancelled()) return failed(PlanStatus::kCancelled, interruption(PlanStatus::kCancelled, 0));
  const double start = run.plan().trajectory.duration();
  appendStage(run.plan(), stage, false, *trajectory);
  measureRatios(run.workcell(), run.plan(), run.context().cancel);
  measureClearance(space, run.plan(), start, run.plan().trajectory.duration());
  return true;
}

}  // namespace longarm::planning
