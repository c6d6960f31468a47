#include "planning/macros/grab_pipe.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include "core/text.h"
#include "planning/macros/grasp_search.h"
#include "planning/macros/job_reach.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/reach_advice.h"
#include "planning/macros/task_advice.h"
#include "planning/macros/task_planner.h"
#include "planning/macros/tool_shape.h"
#include "planning/motion/path_planner.h"
#include "planning/motion/timed_motion.h"

namespace longarm::planning {
namespace {

constexpr double kUpright = 0.6;         // tilt up to which a grasp is as good as one from above [rad]
constexpr double kConfidence = 1.96;     // 95 % of a normal distribution, two-sided

std::string millimetres(double metres) { return formatFixed(metres * 1000, 1) + " mm"; }

class GrabRun {
 public:
  GrabRun(const PlanContext& context, const vision::Feature& feature, const GrabPipeOptions& options)
      : m_run(context, "grab_pipe"), m_feature(feature), m_options(options) {}

  Plan run() {
    if (!m_run.begin() || !readPipe() || !checkGripper() || !m_run.leaveContact()) return m_run.plan();
    m_q = withGripperOpen(m_run);
    const WorldObject obstacle = pipeObstacle();
    m_run.plan().obstacles = {obstacle};
    m_run.plan().grasped = obstacle;
    m_run.plan().grasped->shape = Cylinder{m_options.radius, m_pipe.length};
    m_run.plan().touchable = targetNames(obstacle.name);
    const auto transit_world = m_run.makeWorld({obstacle}, m_q);
    const auto approach_world = m_run.makeWorld({obstacle}, m_q);
    for (const auto& name : m_run.plan().touchable) approach_world->allow(name, m_run.workcell().gripper->links);
    approach_world->setPadding(std::min(m_options.approach_padding, approach_world->padding()),
                               approach_world->selfPadding());
    forgetRepeatedNotes();
    const CancelToken& cancel = m_run.context().cancel;
    const ArmSpace transit(m_run.workcell(), *transit_world, m_q, cancel), approach(m_run.workcell(), *approach_world, m_q, cancel);
    Contact contact;
    if (transit_world->touching(m_q, &contact)) {
      return m_run.fail(PlanStatus::kStartInCollision,
                        "With the gripper open, " + contact.sentence() + " where the arm stands. Move the arm clear of the pipe first.", 0);
    }
    return search(transit, approach);
  }

  ReachAnswer reach(const ReachSeed& seed) {
    ToolJob job;
    if (!m_run.begin() || !readPipe() || !checkGripper()) return {ReachAnswer::Level::kNot, m_run.plan().reason, 0, {}};
    TaskPart part;
    for (const auto& grasp : graspsAt(m_pipe, 0)) {
      ToolTask task;
      task.X_entry = grasp.X_RT * Eigen::Translation3d(0, 0, -m_options.standoff);
      ToolPath path(task.X_entry);
      path.lineTo(grasp.X_RT);
      task.stages.push_back({"approach", path, m_run.workcell().approach_speed, true, true});
      task.preference = std::abs(grasp.tilt) < kUpright ? 0 : 1;
      part.tasks.push_back(std::move(task));
    }
    std::stable_sort(part.tasks.begin(), part.tasks.end(), [](const ToolTask& a, const ToolTask& b) { return a.preference < b.preference; });
    job.subject = "its middle";
    job.place = m_pipe.middle;
    job.parts.push_back(std::move(part));
    job.obstacles = {pipeObstacle()};
    job.touchable = targetNames(job.obstacles.front().name);
    job.open_gripper = true;
    job.touch_padding = m_options.approach_padding;
    return reachOfJob(m_run, job, seed);
  }

 private:
  bool readPipe() {
    auto pipe = pipeFrom(m_feature, m_run.model(), m_run.context().start);
    if (!pipe) {
      m_run.fail(PlanStatus::kBadFeature, "Cannot grab: " + pipe.error().message + ".");
      return false;
    }
    m_pipe = *std::move(pipe);
    return true;
  }

  bool checkGripper() {
    const auto& gripper = m_run.workcell().gripper;
    std::string wrong;
    if (!gripper || gripper->links.empty()) {
      wrong = "the workcell names no gripper, or no gripper links";
    } else if (2 * m_options.radius >= gripper->max_width) {
      wrong = "the pipe is " + millimetres(2 * m_options.radius) + " thick, the gripper takes " +
              millimetres(gripper->max_width) + " at most";
      m_run.plan().go = "no_go";
      m_run.plan().accuracy_note = wrong;
    }
    if (!wrong.empty()) m_run.fail(PlanStatus::kBadFeature, "Cannot grab: " + wrong + ".");
    return wrong.empty();
  }

  WorldObject pipeObstacle() const {
    WorldObject out;
    out.name = m_feature.name.empty() ? "pipe" : m_feature.name;
    out.shape = Cylinder{m_options.radius + m_options.allowance, m_pipe.length + 2 * m_options.allowance};
    out.X_WO.linear() = rotationWithZ(m_pipe.direction);
    out.X_WO.translation() = m_pipe.middle;
    return out;
  }

  // The measured pipe, and the known bodies that it is.
  std::vector<std::string> targetNames(const std::string& pipe) const {
    std::vector<std::string> names = objectsThrough(m_run.context(), m_pipe.middle);
    names.push_back(pipe);
    return names;
  }

  // Both worlds look at the same start and say the same.
  void forgetRepeatedNotes() {
    auto& notes = m_run.plan().notes;
    notes.erase(std::unique(notes.begin(), notes.end()), notes.end());
  }

  bool interrupted() const { return m_run.cancelled() || m_run.timeUp(); }

  Plan interruptedPlan() {
    const PlanStatus status = m_run.cancelled() ? PlanStatus::kCancelled : PlanStatus::kTimeout;
    return m_run.fail(status, interruption(status, m_run.context().budget_s));
  }

  Plan search(const ArmSpace& transit, const ArmSpace& approach) {
    GraspSearch grasps(m_run, transit, approach, m_options);
    for (const double along : placesAlong(m_pipe)) {
      m_run.progress(0.1, "looking for grasps");
      std::vector<ReachableGrasp> found;
      const std::vector<PipeGrasp> wanted = graspsAt(m_pipe, along);
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (interrupted()) return interruptedPlan();
        grasps.tryGrasp(wanted[i], found);
        const auto kept = std::remove_if(found.begin(), found.end(), [this](const ReachableGrasp& grasp) {
          return isAvoided(m_run.context(), grasp.leg.waypoints.front());
        });
        m_any_avoided = m_any_avoided || kept != found.end();
        found.erase(kept, found.end());
        const bool last = i + 1 == wanted.size();
        const bool next_tilt = last || wanted[i + 1].tilt != wanted[i].tilt;
        const bool enough = static_cast<int>(found.size()) >= m_options.enough_goals;
        if (found.empty() || !next_tilt || !(enough || last)) continue;
        m_any_goal = true;
        if (move(transit, approach, found)) return finish(along);
        if (interrupted()) return interruptedPlan();
        found.clear();
      }
    }
    return explain(grasps.refusals(), transit);
  }

  // Plans to any of the grasps; a goal whose timed motion cannot be certified is left out and the rest tried again.
  bool move(const ArmSpace& transit, const ArmSpace& approach, std::vector<ReachableGrasp> found) {
    std::stable_sort(found.begin(), found.end(), [this](const ReachableGrasp& a, const ReachableGrasp& b) {
      return wayTo(a) < wayTo(b);
    });
    for (int k = 0; k < 3 && !found.empty(); ++k) {
      m_run.progress(0.4, "searching a path");
      PathRequest request;
      request.start = m_run.start();
      for (const auto& reachable : found) request.goals.push_back(reachable.leg.waypoints.front());
      request.seed = m_run.context().seed;
      request.max_iterations = m_options.iterations;
      request.deadline_s = m_run.deadline_s();
      request.cancel = m_run.context().cancel;
      const PathAnswer path = planPath(transit, request);
      if (path.status != PlanStatus::kOk) return false;
      m_run.progress(0.8, "timing the motion");
      if (time(transit, approach, path, found[path.goal])) return true;
      found.erase(found.begin() + static_cast<long>(path.goal));
    }
    return false;
  }

  double wayTo(const ReachableGrasp& reachable) const {
    return (reachable.leg.waypoints.front() - m_run.start()).norm() + std::abs(reachable.grasp.tilt);
  }

  bool time(const ArmSpace& transit, const ArmSpace& approach, const PathAnswer& path, const ReachableGrasp& chosen) {
    const Workcell& cell = m_run.workcell();
    Trajectory way;
    if (pathLength(path.waypoints) > 1e-6) {
      auto timed = timedPath(cell, transit, path.waypoints, {cell.max_tool_speed});
      if (!timed) return false;
      way = *std::move(timed);
    }
    const auto last = timedLeg(cell, approach, chosen.leg, {std::min(cell.approach_speed, cell.max_tool_speed)});
    if (!last) return false;
    Plan& plan = m_run.plan();
    if (!way.empty()) appendStage(plan, "transit", false, way);
    appendStage(plan, "approach", true, *last);
    measureRatios(cell, plan, m_run.context().cancel);
    const double end = plan.trajectory.duration(), start = end - last->duration();
    measureClearance(transit, plan, start - way.duration(), start);
    measureClearance(approach, plan, start, end);
    plan.goal = chosen.grasp.X_RT;
    plan.entry = chosen.leg.waypoints.front();
    judgeAccuracy(chosen.grasp);
    return true;
  }

  // The gripper forgives half its opening less the pipe's radius, across the fingers and along the approach.
  void judgeAccuracy(const PipeGrasp& grasp) {
    Plan& plan = m_run.plan();
    const double margin = 0.5 * m_run.workcell().gripper->max_width - m_options.radius;
    const Eigen::Matrix3d C = m_pipe.covarianceAt(grasp.along);
    double worst = 0;
    for (const int axis : {1, 2}) {
      const Eigen::Vector3d d = grasp.X_RT.linear().col(axis);
      worst = std::max(worst, kConfidence * std::sqrt(std::max(0.0, d.dot(C * d))));
    }
    plan.go = worst <= margin ? "go" : "ask";
    if (worst == 0) plan.accuracy_note = "The feature states no uncertainty.";
    if (worst <= margin) return;
    plan.accuracy_note = "The pipe is known to " + millimetres(worst) + " (95 %) across the gripper, which forgives " +
                         millimetres(margin) + ": measure again from nearer or with a wider baseline, or go on with care.";
  }

  Plan finish(double along) {
    Plan& plan = m_run.plan();
    if (along != 0) {
      plan.notes.push_back("The middle of the pipe cannot be grasped; this grasps it " + millimetres(std::abs(along)) + " from there.");
    }
    return m_run.finish();
  }

  // The straight approaches to the middle of the pipe.
  std::vector<std::vector<Pose>> approaches() const {
    std::vector<std::vector<Pose>> ways;
    for (const auto& grasp : graspsAt(m_pipe, 0)) {
      ways.push_back({grasp.X_RT * Eigen::Translation3d(0, 0, -m_options.standoff), grasp.X_RT});
    }
    return ways;
  }

  Plan explain(const GraspRefusals& refusals, const ArmSpace& transit) {
    if (m_any_avoided) return m_run.fail(PlanStatus::kNoPath, "There is no other way to hold the pipe than those shown.");
    m_run.plan().failed_stage = m_any_goal ? "transit" : "approach";
    if (!m_any_goal && refusals.colliding > 0) adviseObstacle(m_run, refusals.contact, pipeObstacle().name);
    const bool advised = !m_any_goal && adviseDriving(m_run, transit, approaches());
    const Pose straight = graspsAt(m_pipe, 0).front().X_RT;
    const Pose pose = refusals.pose.value_or(straight);
    if (m_any_goal) {
      return m_run.fail(PlanStatus::kNoPath,
                        "The pipe can be held, but no collision-free way there was found in " +
                            formatFixed(m_run.elapsed(), 1) + " s. Start from another pose (ready), or clear the space around it.",
                        1, pose);
    }
    if (refusals.colliding == 0 && refusals.blocked == 0) {
      const Reach reach = reachOf(m_run.workcell(), m_q);
      return m_run.fail(PlanStatus::kUnreachable,
                        "The pipe is out of reach: " + (advised ? reachFacts(reach, "its middle", m_pipe.middle) + ", or the hand cannot be turned so there; drive nearer"
                                                                : reachAdvice(reach, "its middle", m_pipe.middle)) + ".", 2, straight);
    }
    if (refusals.blocked == 0) {
      return m_run.fail(PlanStatus::kGoalInCollision,
                        "Wherever the arm could hold the pipe, it would collide: " + refusals.contact.sentence() +
                            ". Clear the space around the pipe or drive to its other side.", 2, pose);
    }
    return m_run.fail(PlanStatus::kApproachBlocked,
                      "The pipe can be reached, but not by a straight approach of " + millimetres(m_options.standoff) +
                          ": " + refusals.leg + ". Drive a little nearer or to the other side.", 1, pose);
  }

  PlanningRun m_run;
  const vision::Feature& m_feature;
  const GrabPipeOptions& m_options;
  Pipe m_pipe;
  Eigen::VectorXd m_q;                   // the start with the gripper open
  bool m_any_goal = false;
  bool m_any_avoided = false;
};

}  // namespace

GrabPipe::GrabPipe(GrabPipeOptions options) : m_options(options) {}

MacroInfo GrabPipe::info() const {
  return {"grab_pipe", "Grab Pipe", "Reaches for the marked pipe from above and closes on its middle.",
          vision::FeatureKind::kLine,
          {{"radius", "m", m_options.radius, 0.001, 0.2, "Of the pipe, where its outlines were not marked."},
           {"stand_off", "m", m_options.standoff, 0.02, 0.3, "Length of the straight last leg."}},
          0.03};
}

Result<GrabPipeOptions> GrabPipe::optionsFor(const PlanContext& context, const vision::Feature& feature) const {
  const auto arguments = MacroArguments::from(info(), context.arguments);
  if (!arguments) return arguments.error();
  GrabPipeOptions options = m_options;
  // What the outlines measured is better than what was assumed of any pipe.
  options.radius = feature.pipe ? feature.pipe->radius : (*arguments)["radius"];
  options.standoff = (*arguments)["stand_off"];
  return options;
}

Plan GrabPipe::plan(const PlanContext& context, const vision::Feature* feature) const {
  try {
    if (feature == nullptr) {
      return PlanningRun(context, "grab_pipe").fail(PlanStatus::kBadFeature, "Grab Pipe needs a line: mark the pipe first.");
    }
    const auto options = optionsFor(context, *feature);
    if (!options) {
      return PlanningRun(context, "grab_pipe").fail(PlanStatus::kLimits, "Cannot plan: " + options.error().message + ".");
    }
    return GrabRun(context, *feature, *options).run();
  } catch (const std::exception& e) {
    return PlanningRun(context, "grab_pipe").fail(PlanStatus::kNoPath, std::string("Planning failed inside: ") + e.what());
  }
}

ReachAnswer GrabPipe::reach(const PlanContext& context, const vision::Feature& feature, const ReachSeed& seed) const {
  const auto options = optionsFor(context, feature);
  if (!options) return {ReachAnswer::Level::kNot, options.error().message, 0, {}};
  try {
    return GrabRun(context, feature, *options).reach(seed);
  } catch (const std::exception& e) {
    return {ReachAnswer::Level::kUnknown, std::string("Looking failed inside: ") + e.what(), 0, {}};
  }
}

}  // namespace longarm::planning
