#include "planning/macros/task_planner.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/text.h"
#include "planning/macros/task_advice.h"
#include "planning/macros/tool_shape.h"
#include "planning/motion/path_planner.h"
#include "planning/motion/timed_motion.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

constexpr std::size_t kEnough = 6;       // ways that one search for a free motion is given
constexpr std::size_t kEnoughOfLong = 3;
constexpr double kLong = 0.6;            // stages of that length in all are long [m]
constexpr int kIterations = 4000;
constexpr double kNoWay = 1e-6;          // [rad]
constexpr double kAdviceStep = 0.06;     // [m]
constexpr double kAdviceTurn = 0.3;      // [rad]

std::size_t enoughFor(const TaskPart& part) {
  double length = 0;
  for (const auto& stage : part.tasks.front().stages) length += stage.path.length();
  return length > kLong ? kEnoughOfLong : kEnough;
}

// End of the tasks that are as good as task `first`.
std::size_t endOfGroup(const TaskPart& part, std::size_t first) {
  std::size_t last = first;
  while (last < part.tasks.size() && part.tasks[last].preference == part.tasks[first].preference) ++last;
  return last;
}

}  // namespace

Eigen::VectorXd withGripperOpen(PlanningRun& run) {
  if (!run.workcell().gripper) return run.configuration();
  const Eigen::VectorXd q = run.withGripperAt(run.workcell().gripper->open);
  if ((q - run.configuration()).cwiseAbs().maxCoeff() > 1e-3) {
    run.plan().notes.push_back("Open the gripper before this motion: it is planned open.");
  }
  return q;
}

TaskWorlds makeTaskWorlds(PlanningRun& run, const ToolJob& job, const Eigen::VectorXd& q) {
  TaskWorlds worlds{run.makeWorld(job.obstacles, q), run.makeWorld(job.obstacles, q)};
  auto& notes = run.plan().notes;        // both look at the same start and say the same
  notes.erase(std::unique(notes.begin(), notes.end()), notes.end());
  for (const auto& name : job.touchable) worlds.touching->allow(name, toolLinks(run.workcell()));
  worlds.touching->setPadding(std::min(job.touch_padding, worlds.touching->padding()), worlds.touching->selfPadding());
  return worlds;
}

Plan TaskPlanner::plan() {
  m_q = m_job.open_gripper ? withGripperOpen(m_run) : m_run.configuration();
  const TaskWorlds worlds = makeTaskWorlds(m_run, m_job, m_q);
  m_run.plan().obstacles = m_job.obstacles;
  m_run.plan().touchable = m_job.touchable;
  m_run.plan().grasped = m_job.grasped;
  Contact contact;
  if (worlds.free->touching(m_q, &contact)) {
    return m_run.fail(PlanStatus::kStartInCollision,
                      "Where the arm stands, " + contact.sentence() + ". Move it clear of " + m_job.subject + " first.", 0);
  }
  const CancelToken& cancel = m_run.context().cancel;
  const ArmSpace free(m_run.workcell(), *worlds.free, m_q, cancel), touching(m_run.workcell(), *worlds.touching, m_q, cancel);
  TaskSearch ways(m_run, free, touching);
  if (!search(ways, free)) {
    m_run.plan().min_clearance = 0;
    if (!interrupted()) return explain(ways.refusals(), m_job.parts[m_failed_part], free);
    const PlanStatus status = m_run.cancelled() ? PlanStatus::kCancelled : PlanStatus::kTimeout;
    return m_run.fail(status, interruption(status, m_run.context().budget_s));
  }
  Plan& plan = m_run.plan();
  measureRatios(m_run.workcell(), plan, m_run.context().cancel);
  plan.goal = free.tip(plan.trajectory.points.back().positions);
  return m_run.finish();
}

// The tool poses of each way, coarsely.
std::vector<std::vector<Pose>> TaskPlanner::waysOf(const TaskPart& part) {
  std::vector<std::vector<Pose>> ways;
  for (const auto& task : part.tasks) {
    std::vector<Pose> way{task.stages.empty() ? task.X_entry : task.stages.front().path.start()};
    for (const auto& stage : task.stages) {
      for (const double s : stage.path.stations(kAdviceStep, kAdviceTurn)) {
        if (s > 0) way.push_back(stage.path.at(s));
      }
    }
    ways.push_back(std::move(way));
  }
  return ways;
}

// Whether any way of a part can be followed at all; from where does not matter yet.
bool TaskPlanner::possible(TaskSearch& search, const TaskPart& part) {
  for (std::size_t first = 0; first < part.tasks.size() && !interrupted();) {
    const std::size_t last = endOfGroup(part, first);
    if (!search.find(part, first, last, m_run.start(), 1).empty()) return true;
    first = last;
  }
  return false;
}

bool TaskPlanner::search(TaskSearch& search, const ArmSpace& free) {
  std::vector<std::size_t> doable;
  for (std::size_t k = 0; k < m_job.parts.size(); ++k) {
    const TaskPart& part = m_job.parts[k];
    m_failed_part = k;
    // A part alone is looked at once, when it is planned.
    if (m_job.parts.size() == 1 || possible(search, part)) {
      doable.push_back(k);
    } else if (!part.optional) {
      return false;
    } else {
      leaveOut(part);
    }
    if (interrupted()) return false;
  }
  m_possible = doable.size();
  if (doable.size() < m_job.least_parts) {
    if (m_job.least_parts > 1) m_failed_part = m_job.parts.size() / 2;
    return false;
  }
  Eigen::VectorXd from = m_run.start();
  std::size_t done = 0;
  for (const std::size_t k : doable) {
    m_failed_part = k;
    m_any_goal = false;
    if (searchPart(search, free, k, from)) {
      from = m_run.plan().trajectory.points.back().positions;
      ++done;
    } else if (interrupted() || !m_job.parts[k].optional || m_any_avoided) {
      return false;
    } else {
      leaveOut(m_job.parts[k]);
    }
  }
  return done >= m_job.least_parts;
}

void TaskPlanner::leaveOut(const TaskPart& part) { m_run.plan().notes.push_back(part.name + " cannot be done from here and is left out."); }

bool TaskPlanner::searchPart(TaskSearch& search, const ArmSpace& free, std::size_t k, const Eigen::VectorXd& from) {
  const TaskPart& part = m_job.parts[k];
  const double done = static_cast<double>(k) / static_cast<double>(m_job.parts.size());
  for (std::size_t first = 0; first < part.tasks.size() && !interrupted();) {
    m_run.progress(done + 0.1 / static_cast<double>(m_job.parts.size()), "looking for ways to hold the tool");
    const std::size_t last = endOfGroup(part, first);
    std::vector<FollowedTask> found = search.find(part, first, last, from, enoughFor(part) + m_run.context().avoid.size());
    if (m_run.plan().entry.size() == 0) dropAvoided(found);
    first = last;
    if (found.empty() || interrupted()) continue;
    m_any_goal = true;
    m_run.progress(done + 0.4 / static_cast<double>(m_job.parts.size()), "searching a path");
    if (move(free, search, part, std::move(found), from)) return true;
  }
  return false;
}

void TaskPlanner::dropAvoided(std::vector<FollowedTask>& found) {
  const auto known = [this](const FollowedTask& task) { return isAvoided(m_run.context(), task.entry); };
  const auto kept = std::remove_if(found.begin(), found.end(), known);
  m_any_avoided = m_any_avoided || kept != found.end();
  found.erase(kept, found.end());
}

// Plans to any of the entries; one whose timed motion cannot be certified is left out and the rest tried again.
bool TaskPlanner::move(const ArmSpace& free, TaskSearch& search, const TaskPart& part, std::vector<FollowedTask> found,
                       const Eigen::VectorXd& from) {
  for (int k = 0; k < 3 && !found.empty(); ++k) {
    std::size_t chosen = 0;
    std::vector<Eigen::VectorXd> way;
    if (!part.from_here) {
      PathRequest request;
      request.start = from;
      for (const auto& task : found) request.goals.push_back(task.entry);
      request.seed = m_run.context().seed;
      request.max_iterations = kIterations;
      request.deadline_s = m_run.deadline_s();
      request.cancel = m_run.context().cancel;
      PathAnswer path = planPath(free, request);
      if (path.status != PlanStatus::kOk) return false;
      chosen = path.goal;
      way = std::move(path.waypoints);
    }
    if (time(free, search, part, found[chosen], way)) return true;
    found.erase(found.begin() + static_cast<long>(chosen));
  }
  return false;
}

bool TaskPlanner::time(const ArmSpace& free, TaskSearch& search, const TaskPart& part, const FollowedTask& task,
                       const std::vector<Eigen::VectorXd>& way) {
  const Workcell& cell = m_run.workcell();
  Plan next = m_run.plan();
  const std::string prefix = m_job.parts.size() > 1 ? part.name + ": " : "";
  const auto add = [&](const std::string& name, bool straight, const ArmSpace& space, const Trajectory& piece) {
    const double start = next.trajectory.duration();
    appendStage(next, prefix + name, straight, piece);
    measureClearance(space, next, start, next.trajectory.duration());
  };
  if (way.size() > 1 && pathLength(way) > kNoWay) {
    const auto timed = timedPath(cell, free, way, {cell.max_tool_speed});
    if (!timed) return false;
    add("transit", false, free, *timed);
  }
  for (std::size_t k = 0; k < task.legs.size(); ++k) {
    if (interrupted()) return false;
    const ToolStage& stage = task.task->stages[k];
    const auto timed = timedLeg(cell, search.spaceOf(stage), task.legs[k], {std::min(stage.speed, cell.max_tool_speed)});
    if (!timed) return false;
    add(stage.name, stage.straight, search.spaceOf(stage), *timed);
    next.stages.back().gripper = stage.gripper;
  }
  if (next.trajectory.empty()) {
    next.notes.push_back("The tool is already there.");
    add("transit", false, free, standStill(cell.armJointNames(), task.entry, 0.1));
  }
  if (!task.task->note.empty()) next.notes.push_back(task.task->note);
  if (next.entry.size() == 0 && !part.from_here) next.entry = task.entry;
  m_run.plan() = std::move(next);
  return true;
}

Plan TaskPlanner::explain(const TaskRefusals& refusals, const TaskPart& part, const ArmSpace& free) {
  const std::optional<Pose> pose = refusals.pose;
  if (m_any_avoided) return m_run.fail(PlanStatus::kNoPath, "There is no other way to do it than those shown.");
  if (m_any_goal) {
    m_run.plan().failed_stage = "transit";
    return m_run.fail(PlanStatus::kNoPath,
                      "The task can be done, but no collision-free way to its beginning was found in " +
                          formatFixed(m_run.elapsed(), 1) + " s. Start from another pose (ready), or clear the space around " +
                          m_job.subject + ".",
                      0, pose);
  }
  if (refusals.stopped > 0) return explainStop(refusals, part, free);
  m_run.plan().failed_stage = part.tasks.front().stages.empty() ? "transit" : part.tasks.front().stages.front().name;
  if (refusals.colliding > 0) {
    adviseObstacle(m_run, refusals.contact, target());
    if (!m_job.in_base_frame) adviseDriving(m_run, free, waysOf(part));
    return m_run.fail(PlanStatus::kGoalInCollision,
                      fewParts() + "However the tool is held at " + m_job.subject + ", the arm would collide: " + refusals.contact.sentence() +
                          ". Clear the space there, " + (m_job.in_base_frame ? "or take another pose." : "give more stand-off, or drive to another side."),
                      0, pose);
  }
  return explainReach(fewParts(), pose, part, free);
}

// "Only 1 of 8 (view 1 ... view 8) can be done, 2 are needed. "; empty where that is not why.
std::string TaskPlanner::fewParts() const {
  if (m_possible == 0 || m_possible >= m_job.least_parts) return {};
  return "Only " + std::to_string(m_possible) + " of " + std::to_string(m_job.parts.size()) + " (" + m_job.parts.front().name + " ... " +
         m_job.parts.back().name + ") can be done, " + std::to_string(m_job.least_parts) + " are needed. ";
}

Plan TaskPlanner::explainReach(const std::string& few, const std::optional<Pose>& pose, const TaskPart& part, const ArmSpace& free) {
  const Pose wanted = pose.value_or(part.tasks.front().X_entry);
  const Reach reach = reachOf(m_run.workcell(), m_q);
  std::string why;
  if (m_job.in_base_frame) {
    why = reachFacts(reach, m_job.subject, m_job.place) + ", or the hand cannot be turned so there: take a pose nearer to the arm, or turn the tool otherwise";
  } else if (adviseDriving(m_run, free, waysOf(part))) {
    why = reachFacts(reach, m_job.subject, m_job.place) + ", or the hand cannot be turned so there; drive nearer";
  } else {
    why = reachAdvice(reach, m_job.subject, m_job.place);
  }
  return m_run.fail(PlanStatus::kUnreachable, few + "It is out of reach: " + why + ".", 0, wanted);
}

Plan TaskPlanner::explainStop(const TaskRefusals& refusals, const TaskPart& part, const ArmSpace& free) {
  m_run.plan().failed_stage = refusals.stage;
  const int share = static_cast<int>(100 * (refusals.furthest - std::floor(refusals.furthest)));
  const std::string where = "The stage \"" + refusals.stage + "\" stops after " + std::to_string(share) + " % of its way: ";
  if (refusals.stop_contact) adviseObstacle(m_run, *refusals.stop_contact, target());
  if (part.from_here) adviseRoll(m_run, free, waysOf(part).front());
  else adviseDriving(m_run, free, waysOf(part));
  if (refusals.stop_contact) {
    return m_run.fail(PlanStatus::kApproachBlocked,
                      where + refusals.why + ". Clear it out of the way, or ask for a shorter way.", refusals.waypoint, refusals.pose);
  }
  const Reach reach = reachOf(m_run.workcell(), m_q);
  const Eigen::Vector3d p = refusals.pose ? refusals.pose->translation() : m_job.place;
  const std::string why = refusals.why.empty() ? std::string() : " (" + refusals.why + ")";
  const bool advised = !m_run.plan().advice.empty();
  return m_run.fail(refusals.stage == "approach" ? PlanStatus::kApproachBlocked : PlanStatus::kUnreachable,
                    where + "the arm cannot follow it further" + why + ". " +
                        (advised ? reachFacts(reach, "The next point", p) : reachAdvice(reach, "The next point", p)) +
                        ". Or ask for a shorter way.",
                    refusals.waypoint, refusals.pose);
}

}  // namespace longarm::planning
