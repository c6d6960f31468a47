#include "planning/macros/job_reach.h"

#include <cmath>

#include "core/text.h"
#include "planning/macros/reach_advice.h"
#include "planning/macros/task_planner.h"
#include "planning/macros/task_search.h"

namespace longarm::planning {
namespace {

// The first way of so many parts as are needed; the middle one, which lies on the arm's side, is looked at first.
std::optional<ReachSeed> glanceAtParts(TaskSearch& search, const ToolJob& job, const Eigen::VectorXd& from, const ReachSeed& seed) {
  if (job.least_parts <= 1) return search.glance(job.parts.front(), from, seed);
  std::optional<ReachSeed> first;
  std::size_t found = 0;
  const std::size_t count = job.parts.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t step = (i + 1) / 2, part = (count / 2 + (i % 2 == 0 ? step : count - step)) % count;
    const auto way = search.glance(job.parts[part], from, first ? ReachSeed{} : seed);
    if (!way) continue;
    if (!first) first = way;
    if (++found >= job.least_parts) return first;
  }
  return {};
}

}  // namespace

ReachAnswer reachOfJob(PlanningRun& run, const ToolJob& job, const ReachSeed& seed) {
  using Level = ReachAnswer::Level;
  ReachAnswer answer;
  if (job.parts.empty()) return answer;
  run.keepContact();
  const Eigen::VectorXd q = job.open_gripper ? withGripperOpen(run) : run.configuration();
  const TaskWorlds worlds = makeTaskWorlds(run, job, q);
  const CancelToken& cancel = run.context().cancel;
  const ArmSpace free(run.workcell(), *worlds.free, q, cancel), touching(run.workcell(), *worlds.touching, q, cancel);
  TaskSearch search(run, free, touching);
  const TaskPart& part = job.parts.front();
  const auto found = glanceAtParts(search, job, run.start(), seed);
  const TaskRefusals& refusals = search.refusals();
  if (found) {
    answer.seed = *found;
    answer.roll = found->roll;
    const bool best = part.tasks[static_cast<std::size_t>(found->task)].preference == part.tasks.front().preference;
    answer.level = best ? Level::kReached : Level::kStrained;
    if (!best) answer.reason = "Only from another side or leaning than it should be.";
    return answer;
  }
  answer.level = run.timeUp() ? Level::kStrained : Level::kNot;
  if (run.timeUp()) {
    answer.reason = "No way was found at a glance: planning may find one.";
  } else if (refusals.stopped > 0) {
    answer.reason = "The stage \"" + refusals.stage + "\" stops after " +
                    std::to_string(static_cast<int>(100 * (refusals.furthest - std::floor(refusals.furthest)))) + " % of its way" +
                    (refusals.why.empty() ? "." : ": " + refusals.why + ".");
  } else if (refusals.colliding > 0) {
    answer.reason = "The arm would collide there: " + refusals.contact.sentence() + ".";
  } else {
    answer.reason = "Out of reach: " + reachAdvice(reachOf(run.workcell(), q), job.subject, job.place) + ".";
  }
  return answer;
}

}  // namespace longarm::planning
