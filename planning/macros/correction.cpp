#include "planning/macros/correction.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/text.h"
#include "planning/macros/planning_run.h"
#include "planning/macros/tool_shape.h"
#include "planning/motion/straight_leg.h"
#include "planning/motion/timed_motion.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

constexpr double kMostWay = 0.1;         // [m]
constexpr double kMostTurn = 0.35;       // [rad]
constexpr double kLeastWindow = 0.05;    // [m]
constexpr double kWindowPerOffset = 3;
constexpr double kWayPerTurn = 0.1;      // [m/rad]
constexpr double kStation = 0.0025;      // [m]
constexpr double kMeet = 1e-3;           // of the joints where the path is met again [rad]
constexpr double kAtEnd = 1e-6;          // [s]
constexpr double kLeastStep = 5e-4;      // [m]
constexpr double kSlowest = 0.005;       // [m/s]

// A stretch of a trajectory: joints, tool and its way from the stretch's start.
struct Stretch {
  std::vector<Eigen::VectorXd> joints;
  std::vector<Pose> tool;
  std::vector<double> way;               // increasing
  double length() const { return way.empty() ? 0 : way.back(); }

  double stepTo(const Pose& X) const {
    return (X.translation() - tool.back().translation()).norm() + kWayPerTurn * angleBetween(X.linear(), tool.back().linear());
  }
  void push(const Eigen::VectorXd& q, const Pose& X) {
    way.push_back(way.empty() ? 0 : way.back() + std::max(stepTo(X), kLeastStep / 100));
    joints.push_back(q);
    tool.push_back(X);
  }
  // Points where the tool hardly goes on are left out: it starts and stops slowly.
  void add(const ArmSpace& space, const Eigen::VectorXd& q) {
    const Pose X = space.tip(q);
    if (joints.empty() || stepTo(X) >= kLeastStep) push(q, X);
  }
  void close(const ArmSpace& space, const Eigen::VectorXd& q) {
    const Pose X = space.tip(q);
    if (joints.size() > 1 && stepTo(X) < kLeastStep) {
      joints.pop_back();
      tool.pop_back();
      way.pop_back();
    }
    push(q, X);
  }

  Pose at(double s) const {
    const auto after = std::upper_bound(way.begin(), way.end(), s);
    if (after == way.end()) return tool.back();
    const auto i = static_cast<std::size_t>(after - way.begin());
    return interpolate(tool[i - 1], tool[i], (s - way[i - 1]) / (way[i] - way[i - 1]));
  }
};

Stretch stretchOf(const ArmSpace& space, const Trajectory& trajectory, double from, double to) {
  Stretch out;
  out.add(space, trajectory.sample(from).positions);
  for (const auto& point : trajectory.points) {
    if (point.t > from && point.t < to) out.add(space, point.positions);
  }
  out.close(space, trajectory.sample(to).positions);
  return out;
}

StraightLeg legOf(const Stretch& stretch) {
  StraightLeg leg;
  leg.ok = true;
  leg.fraction = 1;
  leg.waypoints = stretch.joints;
  leg.way = stretch.way;
  return leg;
}

// Fastest the tool goes in a stage.
double speedOf(const ArmSpace& space, const Trajectory& trajectory, const PlanStage& stage) {
  double fastest = kSlowest;
  for (const auto& point : trajectory.points) {
    if (point.t >= stage.start_s && point.t <= stage.end_s) fastest = std::max(fastest, space.toolWay(point.positions, point.velocities));
  }
  return fastest;
}

class Corrector {
 public:
  Corrector(PlanningRun& run, const Plan& plan, double tau, const Nudge& nudge)
      : m_run(run), m_plan(plan), m_tau(std::clamp(tau, 0.0, plan.trajectory.duration())), m_nudge(nudge) {}

  Result<CorrectedPlan> correct() {
    m_run.keepContact();
    const auto world = m_run.makeWorld(m_plan.obstacles, m_run.configuration());
    for (const auto& name : m_plan.touchable) world->allow(name, toolLinks(m_run.workcell()));
    const ArmSpace space(m_run.workcell(), *world, m_run.configuration());
    const Eigen::VectorXd here = m_plan.trajectory.sample(m_tau).positions;
    const StraightLeg leg = followLine(space, here, nudged(space.tip(here), m_nudge));
    if (!leg.ok) return Error{ErrorCode::kNoSolution, "The arm cannot make this correction: " + leg.why + "."};
    if (const Status free = checkFree(space, leg.waypoints); !free) return free.error();
    return join(space, here, leg);
  }

 private:
  Status checkFree(const ArmSpace& space, const std::vector<Eigen::VectorXd>& waypoints) const {
    Contact contact;
    for (std::size_t i = 1; i < waypoints.size(); ++i) {
      if (!space.segmentFree(waypoints[i - 1], waypoints[i], &contact)) {
        return {ErrorCode::kCollision, "The correction would collide: " + contact.sentence() + "."};
      }
    }
    return {};
  }

  Result<CorrectedPlan> join(const ArmSpace& space, const Eigen::VectorXd& here, const StraightLeg& leg) {
    CorrectedPlan out;
    out.plan = m_plan;
    out.plan.trajectory = {};
    out.plan.stages.clear();
    out.plan.clearance.clear();
    std::size_t k = stageAtTau();
    for (std::size_t i = 0; i < k; ++i) copyStage(out.plan, m_plan.stages[i]);
    const bool has_stage = k < m_plan.stages.size();
    if (has_stage && m_tau > m_plan.stages[k].start_s + kAtEnd) {
      const PlanStage& stage = m_plan.stages[k];
      if (const Status kept = addLeg(out.plan, space, stage.name, stage.straight, legOf(stretchOf(space, m_plan.trajectory, stage.start_s, m_tau)),
                                     speedOf(space, m_plan.trajectory, stage)); !kept) return kept.error();
    }
    out.leave_s = out.plan.trajectory.duration();
    if (const Status moved = addLeg(out.plan, space, "correction", true, leg, m_run.workcell().approach_speed); !moved) return moved.error();
    out.reached_s = out.plan.trajectory.duration();
    if (has_stage) {
      if (const Status back = goBack(out.plan, space, m_plan.stages[k], here, leg.waypoints.back()); !back) return back.error();
      while (++k < m_plan.stages.size()) copyStage(out.plan, m_plan.stages[k]);
    }
    measureRatios(m_run.workcell(), out.plan, {});
    out.plan.goal = space.tip(out.plan.trajectory.points.back().positions);
    out.plan.min_clearance = std::min(m_plan.min_clearance, out.plan.min_clearance);
    return out;
  }

  // The stage that is under way or about to begin; all of them when the plan is at its end.
  std::size_t stageAtTau() const {
    std::size_t k = 0;
    while (k < m_plan.stages.size() && m_plan.stages[k].end_s <= m_tau + kAtEnd) ++k;
    return k;
  }

  void copyStage(Plan& to, const PlanStage& stage) const {
    Trajectory piece;
    piece.joint_names = m_plan.trajectory.joint_names;
    for (const auto& point : m_plan.trajectory.points) {
      if (point.t < stage.start_s - kAtEnd || point.t > stage.end_s + kAtEnd) continue;
      piece.points.push_back(point);
      piece.points.back().t = point.t - stage.start_s;
    }
    piece.points.front().t = 0;
    const double later = to.trajectory.duration() - stage.start_s;
    appendStage(to, stage.name, stage.straight, piece);
    to.stages.back().gripper = stage.gripper;
    for (const auto& sample : m_plan.clearance) {
      if (sample.t_s >= stage.start_s - kAtEnd && sample.t_s <= stage.end_s + kAtEnd) to.clearance.push_back({sample.t_s + later, sample.distance});
    }
  }

  Status addLeg(Plan& to, const ArmSpace& space, const std::string& name, bool straight, const StraightLeg& leg, double speed) const {
    const auto timed = timedLeg(m_run.workcell(), space, leg, {std::min(speed, m_run.workcell().max_tool_speed)});
    if (!timed) return timed.error();
    const double start = to.trajectory.duration();
    appendStage(to, name, straight, *timed);
    measureClearance(space, to, start, to.trajectory.duration());
    return {};
  }

  // Along the rest of the stage, the offset eased out: of the tool where its way means something, else of the joints
  // when the tool cannot be led.
  Status goBack(Plan& to, const ArmSpace& space, const PlanStage& stage, const Eigen::VectorXd& here, const Eigen::VectorXd& corrected) const {
    const Stretch rest = stretchOf(space, m_plan.trajectory, m_tau, stage.end_s);
    const Pose X_here = space.tip(here), X_corrected = space.tip(corrected);
    const Eigen::Vector3d off = X_corrected.translation() - X_here.translation();
    const Eigen::Vector3d turned = logSO3(X_corrected.linear() * X_here.linear().transpose());
    const double size = off.norm() + kWayPerTurn * turned.norm();
    const double window = std::max(1e-9, std::min(rest.length(), std::max(kLeastWindow, kWindowPerOffset * size)));
    const auto left = [window](double s) {
      const double w = std::clamp(s / window, 0.0, 1.0);
      return 1 - w * w * (3 - 2 * w);
    };
    const auto X_RT = [&](double s) {
      Pose X = rest.at(s);
      X.translation() += left(s) * off;
      X.linear() = expSO3(left(s) * turned) * X.linear();
      return X;
    };
    // To a place where the path has joints of its own, so that they can be met.
    std::size_t meet = 1;
    while (meet + 1 < rest.way.size() && rest.way[meet] < window) ++meet;
    std::vector<double> stations{0};
    const double end = rest.way[meet];
    const int cells = std::max(4, static_cast<int>(std::ceil(end / kStation)));
    for (int i = 1; i <= cells; ++i) stations.push_back(end * i / cells);
    LegOptions options;
    options.even_step = 0.1;
    StraightLeg leg = followPath(space, corrected, X_RT, stations, options);
    const bool meets = leg.ok && (leg.waypoints.back() - rest.joints[meet]).cwiseAbs().maxCoeff() <= kMeet;
    if (!meets && stage.straight) {
      return {ErrorCode::kNoSolution, "The arm cannot get back onto its path from there" + (leg.ok ? std::string(" with the same joints") : ": " + leg.why) + "."};
    }
    if (!meets) {
      leg = {};
      for (std::size_t i = 0; i <= meet; ++i) {
        leg.waypoints.push_back(rest.joints[i] + left(rest.way[i]) * (corrected - here));
        leg.way.push_back(rest.way[i]);
        if (!space.withinLimits(leg.waypoints.back())) return {ErrorCode::kNoSolution, "The arm cannot get back onto its path from there: a joint is at its limit."};
      }
    }
    leg.waypoints.back() = rest.joints[meet];
    if (const Status free = checkFree(space, leg.waypoints); !free) return free;
    for (std::size_t i = meet + 1; i < rest.joints.size(); ++i) {
      leg.waypoints.push_back(rest.joints[i]);
      leg.way.push_back(rest.way[i]);
    }
    if (const Status added = addLeg(to, space, stage.name, stage.straight, leg, speedOf(space, m_plan.trajectory, stage)); !added) return added;
    to.stages.back().gripper = stage.gripper;
    return {};
  }

  PlanningRun& m_run;
  const Plan& m_plan;
  double m_tau;
  const Nudge& m_nudge;
};

}  // namespace

Pose nudged(const Pose& X_RT, const Nudge& nudge) {
  Pose X = X_RT;
  X.translation() += nudge.R_RF * nudge.way;
  X.linear() = expSO3(nudge.R_RF * nudge.turn) * X.linear();
  return X;
}

Result<CorrectedPlan> correctPlan(const PlanContext& context, const Plan& plan, double tau, const Nudge& nudge) {
  if (!nudge.way.allFinite() || !nudge.turn.allFinite() || nudge.way.norm() > kMostWay || nudge.turn.norm() > kMostTurn) {
    return Error{ErrorCode::kOutOfLimits, "A correction goes at most " + formatFixed(kMostWay * 1000, 0) + " mm and turns at most 20 deg at once."};
  }
  if (!plan.ok() || plan.trajectory.empty()) return Error{ErrorCode::kRefused, "There is no motion to correct."};
  PlanContext here = context;
  setGroupPositions(*context.workcell->model, context.workcell->arm, plan.trajectory.sample(tau).positions, here.start);
  PlanningRun run(here, plan.macro);
  if (!run.begin()) return Error{ErrorCode::kCollision, run.plan().reason};
  return Corrector(run, plan, tau, nudge).correct();
}

}  // namespace longarm::planning
