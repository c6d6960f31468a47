#include "planning/macros/planning_run.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "planning/motion/path_planner.h"

namespace longarm::planning {
namespace {

constexpr double kLimitSlack = 2e-3;     // encoders may read a hair outside a limit [rad or m]
constexpr double kStartShare = 0.8;

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
  m_plan.status = status;
  m_plan.reason = reason;
  m_plan.failed_waypoint = waypoint;
  m_plan.failed_pose = pose;
  m_plan.trajectory = {};
  m_plan.stages.clear();
  m_plan.planning_seconds = elapsed();
  return m_plan;
}

Plan PlanningRun::finish() {
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

bool PlanningRun::begin() {
  if (!checkContext()) return false;
  m_start = groupPositions(model(), workcell().arm, m_context.start);
  if (!checkLimits()) return false;
  m_allowed = allowedPairs(workcell().model);
  std::vector<WorldObject> objects = workcell().objects;
  objects.insert(objects.end(), m_context.objects.begin(), m_context.objects.end());
  const CollisionWorld world(workcell().model, objects, m_allowed);
  Contact contact;
  if (world.touching(m_context.start, &contact)) {
    fail(PlanStatus::kStartInCollision,
         "The robot already stands in collision: " + contact.sentence() + ". Jog it clear, or correct the scene.", 0);
    return false;
  }
  return true;
}

std::unique_ptr<CollisionWorld> PlanningRun::makeWorld(const std::vector<WorldObject>& extra, const Eigen::VectorXd& q) {
  std::vector<WorldObject> objects = workcell().objects;
  objects.insert(objects.end(), m_context.objects.begin(), m_context.objects.end());
  objects.insert(objects.end(), extra.begin(), extra.end());
  CollisionOptions options;
  options.moving = movingIndices(model(), workcell().arm);
  auto world = std::make_unique<CollisionWorld>(workcell().model, objects, m_allowed, options);
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

std::string interruption(PlanStatus status, double budget_s) {
  if (status == PlanStatus::kCancelled) return "Planning was cancelled.";
  return "Planning took longer than its " + formatFixed(budget_s, 1) +
         " s. Try again, give it more time, or start from another pose.";
}

}  // namespace longarm::planning
