#include "planning/jog/jogger.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/text.h"
#include "planning/macros/grip.h"

namespace longarm::planning {

namespace {

constexpr const char* kOwner = "jog";
constexpr double kStands = 1e-4;           // slower is standing [rad/s or m/s]
constexpr double kScales[] = {1, 0.6, 0.35, 0.2, 0.1};
constexpr double kSeen_m = 1;              // clearances beyond this are not told apart
constexpr double kLook_s = 0.02;           // so far ahead it is seen whether a motion leads away
constexpr double kAway_m = 1e-5;           // a motion that ends this much further from everything leads away

double ramp(double value, double low, double high) { return std::clamp((value - low) / (high - low), 0.0, 1.0); }

CollisionOptions optionsFor(const Workcell& workcell) {
  CollisionOptions options;
  options.moving = movingIndices(*workcell.model, workcell.arm);
  return options;
}

}  // namespace

// Where the next horizon begins: the first points of what is in force, or the arm at rest.
struct Jogger::Base {
  std::vector<TrajectoryPoint> points;
  const TrajectoryPoint& end() const { return points.back(); }
};

Jogger::Jogger(std::shared_ptr<const Workcell> workcell, JogOptions options)
    : m_workcell(std::move(workcell)), m_options(options), m_allowed(allowedPairs(*m_workcell)) {
  setObjects(m_workcell->objects);
}

Jogger::~Jogger() = default;

void Jogger::setObjects(const std::vector<WorldObject>& objects) {
  m_world = std::make_unique<CollisionWorld>(m_workcell->model, objects, m_allowed, optionsFor(*m_workcell));
  allowGrip(*m_world, *m_workcell, objects, {});   // what is carried lies between the fingers
}

Status Jogger::command(const JogCommand& command, double now_s) {
  // Checked here, where somebody hears the answer; q does not matter for that.
  const auto possible = jogVelocity(*m_workcell, m_workcell->model->neutral(), command, m_options.speeds);
  if (!possible) return possible.error();
  m_command = command;
  m_commanded_s = now_s;
  if (command.isIdle()) release();
  return {};
}

void Jogger::release() { m_command.reset(); }

void Jogger::halt() {
  release();
  m_in_force = {};
}

bool Jogger::inForce(double now_s) const { return !m_in_force.empty() && now_s < m_start_s + m_in_force.duration(); }

bool Jogger::active(double now_s) const { return m_command.has_value() || inForce(now_s); }

Jogger::Base Jogger::baseAt(double now_s, const Eigen::VectorXd& q) const {
  const VelocityHorizonOptions& h = m_options.horizon;
  const int pieces = static_cast<int>(std::lround(h.commit_s / h.spacing_s));
  Base base;
  for (int i = 0; i <= pieces; ++i) {
    const double t = i * h.spacing_s;
    if (inForce(now_s)) {
      base.points.push_back(m_in_force.sample(now_s + t - m_start_s));
    } else {
      const Eigen::VectorXd zero = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m_workcell->arm.joints.size()));
      base.points.push_back({0, groupPositions(*m_workcell->model, m_workcell->arm, q), zero, zero});
    }
    base.points.back().t = t;
    if (!inForce(now_s)) break;
  }
  return base;
}

double Jogger::tipSpeed(const Eigen::VectorXd& q, const Eigen::VectorXd& joints) const {
  return (m_workcell->model->jacobian(q, m_workcell->arm).bottomRows(3) * joints).norm();
}

// Full speed in the open and on the way out, a creep next to something.
double Jogger::obstacleFactor(const Eigen::VectorXd& q, const Eigen::VectorXd& joints, double wanted_speed) {
  const auto [world, self] = m_world->clearances(q, kSeen_m);
  m_report.clearance = std::min(world, self);
  const double open = std::min(ramp(world, m_options.creep_from_m, m_options.slow_from_m),
                               ramp(self, m_options.self_creep_from_m, m_options.self_slow_from_m));
  if (open >= 1 || wanted_speed <= m_options.speeds.creep) return 1;
  const Eigen::VectorXd arm = groupPositions(*m_workcell->model, m_workcell->arm, q);
  const auto [world_next, self_next] = m_world->clearances(withArm(*m_workcell, q, arm + kLook_s * joints), kSeen_m);
  if (std::min(world_next, self_next) > m_report.clearance + kAway_m) return 1;
  Contact nearest;
  (void)m_world->clearance(q, &nearest, kSeen_m);
  m_report.reason = "slowed: " + nearest.sentence();
  return std::max(open, m_options.speeds.creep / wanted_speed);
}

bool Jogger::insideLimits(const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  const MotionLimits& limits = m_workcell->arm_limits;
  for (Eigen::Index j = 0; j < to.size(); ++j) {
    const bool out = (to[j] < limits.lower[j] && to[j] < from[j]) || (to[j] > limits.upper[j] && to[j] > from[j]);
    if (!out) continue;
    m_report.reason = "joint " + m_workcell->armJointNames()[static_cast<std::size_t>(j)] + " is at its limit";
    return false;
  }
  return true;
}

// Whether the whole horizon stays inside the limits and free, or leads out of where it must not be.
bool Jogger::goesOn(const Base& base, const std::vector<TrajectoryPoint>& points, const Eigen::VectorXd& q) {
  if (!insideLimits(base.end().positions, points.back().positions)) return false;
  const bool through = m_command && m_command->through_contact;
  Eigen::VectorXd from = withArm(*m_workcell, q, base.end().positions);
  const double before = m_world->clearance(from, nullptr, kSeen_m);
  Contact contact;
  const bool was_free = !m_world->inCollision(from);
  const bool was_in_zone = m_world->inZone(from);
  const int every = 4;
  for (std::size_t i = base.points.size() + every - 1;; i += every) {
    const Eigen::VectorXd to = withArm(*m_workcell, q, points[std::min(i, points.size() - 1)].positions);
    if (was_free && !m_world->segmentFree(from, to, &contact)) {
      m_report.reason = "stopped: " + contact.sentence();
      if (!through || contact.role != BodyRole::kSolid) return false;
    }
    if (!was_free && !was_in_zone && m_world->inZone(to, &contact)) {
      m_report.reason = "stopped: " + contact.sentence();
      return false;
    }
    from = to;
    if (i + 1 >= points.size()) break;
  }
  if (was_free || (through && !was_in_zone)) return true;
  if (m_world->clearance(from, nullptr, kSeen_m) > before + kAway_m) return true;
  m_report.reason = "too close to something: only away from it, or creep through";
  return false;
}

Horizon Jogger::horizonOf(std::vector<TrajectoryPoint> points, double now_s) {
  m_in_force.joint_names = m_workcell->armJointNames();
  m_in_force.points = std::move(points);
  m_start_s = now_s;
  m_braking = !m_command;
  Horizon horizon;
  horizon.sequence = ++m_sequence;
  horizon.owner = kOwner;
  horizon.start_s = now_s;
  horizon.joint_names = m_in_force.joint_names;
  horizon.points = m_in_force.points;
  return horizon;
}

Horizon Jogger::tick(double now_s, const Eigen::VectorXd& q) {
  if (m_command && now_s - m_commanded_s > m_options.command_life_s) release();
  m_report = {};
  if (!active(now_s) || (!m_command && m_braking)) return {};
  const Base base = baseAt(now_s, q);
  const Eigen::VectorXd there = withArm(*m_workcell, q, base.end().positions);
  JogVelocity wanted{Eigen::VectorXd::Zero(base.end().positions.size()), 1};
  if (m_command) {
    if (auto found = jogVelocity(*m_workcell, there, *m_command, m_options.speeds)) wanted = *found;
    if (wanted.dexterity < 0.99) m_report.reason = "slowed: the arm cannot move that way here; bend it or turn the wrist";
  }
  const double speed = tipSpeed(there, wanted.joints);
  double factor = m_command ? obstacleFactor(there, wanted.joints, speed) : 1;
  if (m_command && m_command->through_contact && speed > 0) factor = std::min(factor, m_options.speeds.creep / speed);
  const bool moves = base.end().velocities.cwiseAbs().maxCoeff() > kStands;
  if (!m_command && !moves) return {};      // what is in force ends by itself
  for (const double scale : kScales) {
    const auto velocity = brakeable(factor * scale * wanted.joints, m_workcell->arm_limits, m_options.horizon);
    auto points = velocityHorizon(base.points, velocity, m_workcell->arm_limits, m_options.horizon);
    if (!goesOn(base, points, q)) continue;
    m_report.factor = factor * scale * wanted.dexterity;
    if (!moves && velocity.cwiseAbs().maxCoeff() <= kStands) return {};
    return horizonOf(std::move(points), now_s);
  }
  m_report.factor = 0;
  return {};
}

}  // namespace longarm::planning
