#include "planning/macros/planning_run.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "planning/motion/path_planner.h"
#include "planning/motion/straight_leg.h"
#include "planning/motion/timed_motion.h"

namespace longarm::planning {
namespace {

constexpr double kLimitSlack = 2e-3;     // encoders may read a hair outside a limit [rad or m]
constexpr double kSameWay = 0.2;         // [rad]
constexpr double kStartShare = 0.8;
constexpr double kBackOff[] = {0.03, 0.06};      // [m]

std::string quoted(const std::vector<std::string>& names) {
  std::string out;
  for (const auto& name : names) out += (out.empty() ? "\"" : ", \"") + name + "\"";
  return out;
}

}  // namespace

PlanningRun::PlanningRun(const PlanContext& context, std::string macro) : m_context(context), m_started(steadyNow()) {
  m_plan.macro = std::move(macro);
  m_plan.start_configuration = context.start;
  m_deadline = m_started + context.budget_s;
}

double PlanningRun::elapsed() const { return steadyNow() - m_started; }
bool PlanningRun::timeUp() const { return steadyNow() > m_deadline; }

void PlanningRun::progress(double fraction, const std::string& what) const {
  if (m_context.progress) m_context.progress(fraction, what);
}

Plan PlanningRun::fail(PlanStatus status, const std::string& reason, int waypoint, const std::optional<Pose>& pose) {
  // After a cancel nothing is free any more, so that what else failed means nothing.
  m_plan.status = cancelled() ? PlanStatus::kCancelled : status;
  m_plan.reason = cancelled() ? interruption(PlanStatus::kCancelled, m_context.budget_s) : reason;
  m_plan.failed_waypoint = waypoint;
  m_plan.failed_pose = pose;
  m_plan.trajectory = {};
  m_plan.stages.clear();
  m_plan.clearance.clear();
  m_plan.planning_seconds = elapsed();
  return m_plan;
}

Plan PlanningRun::finish() {
  if (cancelled()) return fail(PlanStatus::kCancelled, {});
  m_plan.status = PlanStatus::kOk;
  m_plan.reason.clear();
  m_plan.planning_seconds = elapsed();
  return m_plan;
}

bool PlanningRun::checkContext() {
  const Workcell* cell = m_context.workcell;
  std::string wrong;
  if (cell == nullptr || cell->model == nullptr) {
    wrong = "no workcell is loaded";
  } else if (m_context.start.size() != cell->model->dof() || !m_context.start.allFinite()) {
    wrong = "the start names " + std::to_string(m_context.start.size()) + " joints, the robot has " +
            std::to_string(cell->model->dof()) + ", and all must be finite";
  } else if (cell->arm.joints.empty() ||
             cell->arm_limits.lower.size() != static_cast<Eigen::Index>(cell->arm.joints.size()) ||
             cell->arm_limits.max_acceleration.size() != static_cast<Eigen::Index>(cell->arm.joints.size())) {
    wrong = "the workcell's arm has " + std::to_string(cell->arm.joints.size()) + " joints but limits for " +
            std::to_string(cell->arm_limits.lower.size());
  }
  if (!wrong.empty()) fail(PlanStatus::kLimits, "Cannot plan: " + wrong + ".");
  return wrong.empty();
}

bool PlanningRun::checkLimits() {
  const auto& limits = workcell().arm_limits;
  const std::vector<std::string> names = workcell().armJointNames();
  for (Eigen::Index j = 0; j < m_start.size(); ++j) {
    const double outside = std::max(limits.lower[j] - m_start[j], m_start[j] - limits.upper[j]);
    if (outside > kLimitSlack) {
      const double limit = m_start[j] < limits.lower[j] ? limits.lower[j] : limits.upper[j];
      fail(PlanStatus::kLimits,
           names[static_cast<std::size_t>(j)] + " stands at " + formatFixed(m_start[j], 3) + ", outside its limit " +
               formatFixed(limit, 3) + ": move it back by jogging before planning.",
           0);
      return false;
    }
    m_start[j] = std::clamp(m_start[j], limits.lower[j], limits.upper[j]);
  }
  return true;
}

Eigen::VectorXd PlanningRun::withGripperAt(double position) const {
  Eigen::VectorXd q = m_configuration;
  if (!workcell().gripper) return q;
  const auto joint = model().jointIndex(workcell().gripper->joint);
  const int index = joint ? model().joints()[static_cast<std::size_t>(*joint)].q_index : -1;
  if (index >= 0) q[index] = position;
  return q;
}

bool PlanningRun::begin() {
  if (!checkContext()) return false;
  m_start = groupPositions(model(), workcell().arm, m_context.start);
  if (!checkLimits()) return false;
  m_configuration = m_context.start;
  m_allowed = allowedPairs(workcell());
  m_objects = m_context.objects;
  for (const auto& object : workcell().objects) {
    const auto same = [&](const WorldObject& other) { return other.name == object.name; };
    if (std::none_of(m_context.objects.begin(), m_context.objects.end(), same)) m_objects.push_back(object);
  }
  m_grip = gripAt(workcell(), m_objects, m_configuration, m_context.held);
  CollisionOptions options;
  options.moving = movingIndices(model(), workcell().arm);
  Contact contact;
  if (bareWorld({}, m_configuration, options, true)->touching(m_configuration, &contact)) {
    const bool zone = contact.role != BodyRole::kSolid;
    fail(PlanStatus::kStartInCollision,
         (zone ? "The arm stands where it must not be: " : "The robot already stands in collision: ") + contact.sentence() +
             (zone ? ". Jog it back, or change the zone." : ". Jog it clear, or correct the scene."),
         0);
    return false;
  }
  if (!m_grip.held.empty()) m_plan.notes.push_back("The gripper holds " + quoted(m_grip.held) + ": planned to move with the tool.");
  return true;
}

void PlanningRun::keepContact() {
  m_keeps_contact = true;
  if (m_grip.touched.empty()) return;
  m_plan.notes.push_back("The gripper touches " + quoted(m_grip.touched) + " and may go on touching it on the way.");
}

bool PlanningRun::leaveContact() {
  if (m_grip.touched.empty()) return true;
  const Eigen::Vector3d back = -model().forward(m_configuration, model().linkIndex(workcell().arm.tip_link).valueOr(0)).linear().col(2);
  for (const double way : kBackOff) {
    for (const Eigen::Vector3d& direction : {back, up()}) {
      if (backOff(way * direction)) return true;
    }
  }
  fail(PlanStatus::kStartInCollision,
       "The gripper touches " + quoted(m_grip.touched) + " and cannot back straight off it: jog it clear first.", 0);
  return false;
}

bool PlanningRun::backOff(const Eigen::Vector3d& way) {
  CollisionOptions options;
  options.moving = movingIndices(model(), workcell().arm);
  const auto touching = bareWorld({}, m_configuration, options, true);
  const auto [outside, inside] = touching->clearances(m_configuration, 2 * options.padding);
  touching->setPadding(std::min(options.padding, kStartShare * outside), std::min(options.self_padding, kStartShare * inside));
  const ArmSpace space(workcell(), *touching, m_configuration, m_context.cancel);
  Pose X_end = space.tip(m_start);
  X_end.translation() += way;
  const StraightLeg leg = followLine(space, m_start, X_end);
  if (!leg.ok || bareWorld({}, m_configuration, options, false)->inCollision(space.full(leg.waypoints.back()))) return false;
  for (std::size_t i = 1; i < leg.waypoints.size(); ++i) {
    if (!space.segmentFree(leg.waypoints[i - 1], leg.waypoints[i])) return false;
  }
  const auto timed = timedLeg(workcell(), space, leg, {std::min(workcell().approach_speed, workcell().max_tool_speed)});
  if (!timed) return false;
  m_plan.notes.push_back("The gripper touches " + quoted(m_grip.touched) + " and backs straight off it first.");
  appendStage(m_plan, "back off", true, *timed);
  m_start = leg.waypoints.back();
  m_configuration = space.full(m_start);
  return true;
}

std::unique_ptr<CollisionWorld> PlanningRun::bareWorld(const std::vector<WorldObject>& extra, const Eigen::VectorXd& q,
                                                       const CollisionOptions& options, bool may_touch) const {
  const Grip grip = gripAt(workcell(), m_objects, q, m_context.held);
  std::vector<WorldObject> objects = withHeldAttached(workcell(), m_objects, grip, q);
  objects.insert(objects.end(), extra.begin(), extra.end());
  auto world = std::make_unique<CollisionWorld>(workcell().model, objects, m_allowed, options);
  allowGrip(*world, workcell(), objects, grip);
  for (const auto& name : grip.touched) {
    if (may_touch) world->allow(name, workcell().gripper->links);
  }
  return world;
}

std::unique_ptr<CollisionWorld> PlanningRun::makeWorld(const std::vector<WorldObject>& extra, const Eigen::VectorXd& q) {
  CollisionOptions options;
  options.moving = movingIndices(model(), workcell().arm);
  auto world = bareWorld(extra, q, options, m_keeps_contact);
  const auto [outside, inside] = world->clearances(q, 2 * options.padding);
  if (outside <= options.padding || inside <= options.self_padding) {
    world->setPadding(std::min(options.padding, kStartShare * outside),
                      std::min(options.self_padding, kStartShare * inside));
    Contact contact;
    world->clearance(q, &contact, 2 * options.padding);
    m_plan.notes.push_back("The motion starts close to something (" + contact.sentence() + ") and keeps as little away.");
  }
  return world;
}

std::unique_ptr<CollisionWorld> PlanningRun::makeReleasedWorld(const Pose& X_moved, const Eigen::VectorXd& q, bool may_touch) {
  const auto held = [this](const WorldObject& object) {
    return std::find(m_grip.held.begin(), m_grip.held.end(), object.name) != m_grip.held.end();
  };
  std::vector<WorldObject> objects = m_objects;
  for (auto& object : objects) {
    if (held(object)) object.X_WO = X_moved * object.X_WO;
  }
  CollisionOptions options;
  options.moving = movingIndices(model(), workcell().arm);
  auto world = std::make_unique<CollisionWorld>(workcell().model, objects, m_allowed, options);
  allowGrip(*world, workcell(), objects, gripAt(workcell(), objects, q, {}));
  for (const auto& name : m_grip.held) {
    if (may_touch) world->allow(name, workcell().gripper->links);
  }
  for (const auto& name : m_grip.touched) {
    if (m_keeps_contact) world->allow(name, workcell().gripper->links);
  }
  return world;
}

bool isAvoided(const PlanContext& context, const Eigen::VectorXd& entry) {
  return std::any_of(context.avoid.begin(), context.avoid.end(), [&](const Eigen::VectorXd& other) {
    return other.size() == entry.size() && (other - entry).cwiseAbs().maxCoeff() < kSameWay;
  });
}

std::string interruption(PlanStatus status, double budget_s) {
  if (status == PlanStatus::kCancelled) return "Planning was cancelled.";
  return "Planning took longer than its " + formatFixed(budget_s, 1) +
         " s. Try again, give it more time, or start from another pose.";
}

}  // namespace longarm::planning
