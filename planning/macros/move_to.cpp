#include "planning/macros/move_to.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include "core/text.h"
#include "planning/macros/feature_geometry.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/planning_run.h"
#include "planning/macros/task_planner.h"
#include "planning/macros/tool_directions.h"
#include "planning/motion/path_planner.h"
#include "planning/robot/ik.h"

namespace longarm::planning {
namespace {

constexpr double kFar = 5;               // [m]
constexpr double kHere = 1e-6;           // nearer is where the tool is [m, rad]
constexpr int kTries = 60;               // of the inverse kinematics: one pose, so that many are cheap
constexpr double kAdviceTime = 0.5;      // for each advice [s]
constexpr double kRollStep = M_PI / 6;
constexpr int kSteps = 20;               // of the way from here that are tried

const char* const kNames[] = {"x", "y", "z", "roll", "pitch", "yaw"};

// Inverse of poseFromRpy(); roll is 0 where the pitch of 90 degrees leaves only its sum with yaw.
Eigen::Vector3d rpyOf(const Eigen::Matrix3d& R) {
  const double level = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), level);
  if (level < 1e-9) return {0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

std::string placeText(const Eigen::Vector3d& p) {
  return "x " + formatFixed(p.x(), 3) + ", y " + formatFixed(p.y(), 3) + ", z " + formatFixed(p.z(), 3) + " m";
}

std::string turnText(const Eigen::Matrix3d& R) {
  const Eigen::Vector3d deg = rpyOf(R) * 180 / M_PI;
  return "roll " + formatFixed(deg[0], 1) + ", pitch " + formatFixed(deg[1], 1) + ", yaw " + formatFixed(deg[2], 1) + " deg";
}

std::map<std::string, double> valuesOf(const Pose& X_RT) {
  const Eigen::Vector3d p = X_RT.translation(), rpy = rpyOf(X_RT.linear());
  std::map<std::string, double> values;
  for (int i = 0; i < 3; ++i) {
    values[kNames[i]] = std::clamp(p[i], -kFar, kFar);
    values[kNames[3 + i]] = rpy[i];
  }
  return values;
}

Pose toolAt(const Workcell& cell, const Eigen::VectorXd& q) {
  return cell.model->forward(q, cell.model->linkIndex(cell.arm.tip_link).valueOr(cell.model->rootLink()));
}

// Whether some posture clear of everything holds the tool somewhere, for advice.
class Tries {
 public:
  Tries(PlanningRun& run, const ArmSpace& space)
      : m_run(run), m_space(space), m_solver(run.workcell().model, run.workcell().arm, space.full(run.start())),
        m_until(std::min(steadyNow() + kAdviceTime, run.deadline_s())) {
    m_solver.setLimits(space.lower(), space.upper());
  }
  bool over() const { return steadyNow() > m_until || m_run.cancelled(); }
  bool holds(const Pose& X_RT) const {
    IkOptions options;
    options.restarts = 5;
    options.seed = m_run.context().seed;
    const auto postures = m_solver.solveAll(X_RT, m_run.start(), options, 0.1);
    if (!postures) return false;
    return std::any_of(postures->begin(), postures->end(), [this](const IkSolution& one) { return m_space.valid(one.joints); });
  }

 private:
  PlanningRun& m_run;
  const ArmSpace& m_space;
  IkSolver m_solver;
  double m_until;
};

// The least turned away pose at the same place.
std::optional<Pose> otherTurn(PlanningRun& run, const ArmSpace& space, const Pose& X_RT) {
  const Tries tries(run, space);
  for (const auto& direction : directionsAround(X_RT.linear().col(2), M_PI / 2)) {
    const Pose X = poseAt(X_RT.translation(), toolRotation(direction.z, X_RT.linear().col(0)));
    for (const double roll : anglesAround(M_PI, kRollStep)) {
      if (tries.over()) return {};
      const Pose turned = rolled(X, roll);
      if (tries.holds(turned)) return turned;
    }
  }
  return {};
}

// The furthest place on the straight way from here, with the same orientation.
std::optional<Pose> furthest(PlanningRun& run, const ArmSpace& space, const Pose& X_RT) {
  const Tries tries(run, space);
  const Eigen::Vector3d from = space.tip(run.start()).translation(), way = X_RT.translation() - from;
  for (int i = kSteps - 1; i > 0 && !tries.over() && way.norm() > kHere; --i) {
    const Pose X = poseAt(from + way * i / kSteps, X_RT.linear());
    if (tries.holds(X)) return X;
  }
  return {};
}

void advise(PlanningRun& run, const Pose& X_RT) {
  const std::vector<std::string> notes = run.plan().notes;
  const auto world = run.makeWorld({}, run.configuration());
  run.plan().notes = notes;
  const ArmSpace space(run.workcell(), *world, run.configuration(), run.context().cancel);
  auto& advice = run.plan().advice;
  if (const auto turned = otherTurn(run, space, X_RT)) advice.push_back("At that place the tool can be held at " + turnText(turned->linear()) + ".");
  if (const auto near = furthest(run, space, X_RT)) {
    advice.push_back("Turned as wanted it gets as far as " + placeText(near->translation()) + " on the straight way from here.");
  }
  const Pose now = toolAt(run.workcell(), run.context().start);
  advice.push_back("Now the tool is at " + placeText(now.translation()) + ", " + turnText(now.linear()) + ".");
}

Plan planTo(PlanningRun& run, const Pose& X_RT) {
  const Pose now = toolAt(run.workcell(), run.configuration());
  const bool here = (now.translation() - X_RT.translation()).norm() < kHere && angleBetween(now.linear(), X_RT.linear()) < kHere;
  if (here) run.keepContact();
  else if (!run.leaveContact()) return run.plan();
  ToolJob job;
  job.subject = "the pose " + placeText(X_RT.translation()) + ", " + turnText(X_RT.linear());
  job.place = X_RT.translation();
  job.in_base_frame = true;
  ToolTask task;
  task.X_entry = X_RT;
  task.restarts = kTries;
  job.parts.push_back({"", false, false, {std::move(task)}});
  Plan plan = TaskPlanner(run, job).plan();
  if (plan.status != PlanStatus::kUnreachable && plan.status != PlanStatus::kGoalInCollision) return plan;
  advise(run, X_RT);
  return run.plan();
}

}  // namespace

MoveTo::MoveTo(const Workcell& workcell) {
  Eigen::VectorXd q = workcell.model->neutral();
  for (const char* name : {"home", "ready"}) {
    const auto pose = workcell.poses.find(name);
    if (pose == workcell.poses.end()) continue;
    for (const auto& [joint, value] : pose->second) {
      const auto index = workcell.model->jointIndex(joint);
      const int at = index ? workcell.model->joints()[static_cast<std::size_t>(*index)].q_index : -1;
      if (at >= 0) q[at] = value;
    }
  }
  m_usual = defaultsAt(workcell, q);
  for (auto& [name, value] : m_usual) value = std::round(value * 1e3) / 1e3;
}

MacroInfo MoveTo::info() const {
  MacroInfo info{"move_to", "Move Tool To", "Moves the tool to a typed pose in the robot's base frame; what is not set stays as it is.", {}};
  const auto add = [&](const char* name, const char* unit, double most, const char* description) {
    info.parameters.push_back({name, unit, m_usual.at(name), -most, most, description});
  };
  add("x", "m", kFar, "Of the tool, forwards in the base frame; left out: as it is now.");
  add("y", "m", kFar, "Of the tool, to the left in the base frame; left out: as it is now.");
  add("z", "m", kFar, "Of the tool, upwards in the base frame; left out: as it is now.");
  add("roll", "rad", 2 * M_PI, "Turn of the tool about the base's x, first; left out: as it is now.");
  add("pitch", "rad", 2 * M_PI, "Turn of the tool about the base's y, second; left out: as it is now.");
  add("yaw", "rad", 2 * M_PI, "Turn of the tool about the base's z, last; left out: as it is now.");
  return info;
}

std::map<std::string, double> MoveTo::defaultsAt(const Workcell& workcell, const Eigen::VectorXd& q) const {
  if (q.size() != workcell.model->dof() || !q.allFinite()) return {};
  return valuesOf(toolAt(workcell, q));
}

Plan MoveTo::plan(const PlanContext& context, const vision::Feature* feature) const {
  const MacroInfo about = info();
  try {
    PlanningRun run(context, about.name);
    if (feature != nullptr) return run.fail(PlanStatus::kBadFeature, about.title + " takes no feature: select nothing.");
    if (const auto good = MacroArguments::from(about, context.arguments); !good) {
      return run.fail(PlanStatus::kLimits, "Cannot plan: " + good.error().message + ".");
    }
    if (!run.begin()) return run.plan();
    std::map<std::string, double> values = defaultsAt(run.workcell(), context.start);
    for (const auto& [name, value] : context.arguments) values[name] = value;
    return planTo(run, poseFromRpy({values["x"], values["y"], values["z"]}, {values["roll"], values["pitch"], values["yaw"]}));
  } catch (const std::exception& e) {
    return PlanningRun(context, about.name).fail(PlanStatus::kNoPath, std::string("Planning failed inside: ") + e.what());
  }
}

}  // namespace longarm::planning
