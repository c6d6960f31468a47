#include "app/virtual_robot/robot_body.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "app/virtual_robot/seeded_random.h"
#include "core/text.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kAxisAcceleration = 6.0;  // of pan-tilts and the torso [rad/s^2 or m/s^2]
constexpr double kBreakaway = 0.02;        // a sticking joint moves when it is this far behind [rad or m]
constexpr double kSticksAgain = 0.002;     // ... until it is this near
constexpr double kKnock = 1.0 * M_PI / 180;
constexpr double kGraspTolerance = 1e-9;
// How far the base may be from where contacts were last prepared; preparing costs too much for every reading
// [m].
constexpr double kDrivingShift = 5e-3, kRestingShift = 1e-12;

std::set<std::string> touchGoals(const planning::Scenario& scenario) {
  std::set<std::string> out;
  for (const auto& goal : scenario.goals) {
    if (goal.kind == "touch") out.insert(goal.object);
  }
  return out;
}

MotionLimits hardLimits(const planning::Workcell& workcell) {
  MotionLimits out = workcell.arm_limits;
  for (std::size_t j = 0; j < workcell.arm.joints.size(); ++j) {
    const auto& joint = workcell.model->joints()[static_cast<std::size_t>(workcell.arm.joints[j])];
    out.lower[static_cast<Eigen::Index>(j)] = joint.lower;
    out.upper[static_cast<Eigen::Index>(j)] = joint.upper;
  }
  return out;
}

Result<Eigen::VectorXd> startConfiguration(const planning::Workcell& workcell, const planning::Scenario& scenario) {
  const std::string& pose = scenario.start_pose;
  const auto found = workcell.poses.find(pose);
  if (found == workcell.poses.end()) {
    return Error{ErrorCode::kInvalidInput, "start_pose \"" + pose + "\" is not among the poses of " + workcell.path};
  }
  const auto& model = *workcell.model;
  Eigen::VectorXd q = model.neutral();
  for (int i = 0; i < model.dof(); ++i) {
    const std::string& name = model.actuatedNames()[static_cast<std::size_t>(i)];
    const auto value = found->second.find(name);
    if (value != found->second.end()) q[i] = value->second;
    if (workcell.gripper && workcell.gripper->joint == name) q[i] = workcell.gripper->open;
    const auto own = scenario.start_joints.find(name);
    if (own != scenario.start_joints.end()) q[i] = own->second;
  }
  for (const auto& [name, value] : scenario.start_joints) {
    const auto& names = model.actuatedNames();
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    return Error{ErrorCode::kInvalidInput, "start_joints." + name + ": " + workcell.path + " has no such joint"};
  }
  return q;
}

// A turn about an axis of the camera's own that the seed and its name choose; never about its line of sight alone.
Pose knock(const std::string& camera, unsigned seed) {
  std::uint32_t word = seed;
  for (const char c : camera) word = word * 31 + static_cast<unsigned char>(c);
  const double angle = SeededRandom(word).between(0, 2 * M_PI);
  Pose out = Pose::Identity();
  out.linear() = expSO3(kKnock * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0));
  return out;
}

}  // namespace

std::string usualCamera(const planning::Workcell& workcell) {
  for (const auto& camera : workcell.cameras) {
    if (camera.role == "stereo_left") return camera.name;
  }
  return workcell.cameras.empty() ? std::string() : workcell.cameras.front().name;
}

Result<std::unique_ptr<RobotBody>> RobotBody::create(const planning::Workcell& workcell,
                                                     const planning::Scenario& scenario, unsigned seed) {
  const auto start = startConfiguration(workcell, scenario);
  if (!start) return start.error();
  std::optional<FingerZone> zone;
  if (workcell.gripper) {
    const auto made = FingerZone::of(workcell);
    if (!made) return made.error();
    zone = *made;
  }
  return std::unique_ptr<RobotBody>(
      new RobotBody(workcell, planning::randomised(scenario, seed), seed, *start, zone));
}

RobotBody::RobotBody(const planning::Workcell& workcell, const planning::Scenario& scenario, unsigned seed,
                     const Eigen::VectorXd& start, std::optional<FingerZone> zone)
    : m_workcell(workcell),
      m_scenario(scenario),
      m_seed(seed),
      m_arm(m_workcell.armJointNames(), planning::groupPositions(*m_workcell.model, m_workcell.arm, start),
            hardLimits(m_workcell), {scenario.imperfections.latency_s}),
      m_errors(*m_workcell.model, m_workcell.arm, scenario.imperfections, seed),
      m_world(m_scenario),
      m_contacts(m_workcell, touchGoals(m_scenario)),
      m_faults(scenario.faults),
      m_q(start) {
  const auto& model = *m_workcell.model;
  if (zone) m_gripper.emplace(m_workcell, *zone);
  if (zone) m_pusher.emplace(m_workcell);
  if (m_workcell.base) {
    const double share = scenario.imperfections.odometry_share;
    SeededRandom random(seed + 17);
    const double forward = 1 + random.between(-share, share), turn = 1 + random.between(-share, share);
    m_base.emplace(*m_workcell.base, forward, turn);
  }
  m_arm_indices = planning::movingIndices(model, m_workcell.arm);
  m_motor = planning::groupPositions(model, m_workcell.arm, start);
  m_motor_velocity = Eigen::VectorXd::Zero(m_motor.size());
  for (int i = 0; i < model.dof(); ++i) {
    const auto& joint = model.joints()[static_cast<std::size_t>(model.actuatedJoints()[static_cast<std::size_t>(i)])];
    const bool in_arm = std::find(m_arm_indices.begin(), m_arm_indices.end(), i) != m_arm_indices.end();
    if (m_gripper && joint.name == m_workcell.gripper->joint) {
      m_gripper_index = i;
    } else if (!in_arm) {
      m_axes.emplace(joint.name, Axis{i, JointServo(start[i], joint.lower, joint.upper, joint.max_velocity,
                                                    kAxisAcceleration)});
    }
  }
  m_names = model.actuatedNames();
  for (const auto& joint : model.joints()) {
    if (joint.mimic_of >= 0) m_names.push_back(joint.name);
  }
  driveArm();
  read();
}

void RobotBody::later(std::function<void()> command) {
  m_pending.emplace_back(time_s() + m_scenario.imperfections.latency_s, std::move(command));
}

void RobotBody::heartbeat() {
  m_heartbeat_s = time_s();
  m_quiet = false;
}

void RobotBody::clientLost() {
  if (!m_quiet) m_arm.brake(time_s());
  if (m_base) m_base->halt();
  m_quiet = true;
}

Status RobotBody::follow(const Horizon& horizon) {
  if (m_quiet) {
    return {ErrorCode::kRefused, "the arm refuses a horizon: no heartbeat for " + formatNumber(kQuiet_s) +
                                     " s; publish /longarm/heartbeat at 20 Hz"};
  }
  return m_arm.accept(horizon, time_s());
}

void RobotBody::stop() {
  m_arm.stop(time_s());
  if (m_base) m_base->halt();
}

Status RobotBody::drive(const BaseTwist& twist) {
  if (!m_base) return {ErrorCode::kNotFound, "this robot has no base that drives"};
  if (twist.still()) return m_base->command(twist, time_s());
  if (m_quiet) {
    return {ErrorCode::kRefused, "the base refuses to drive: no heartbeat for " + formatNumber(kQuiet_s) +
                                     " s; publish /longarm/heartbeat at 20 Hz"};
  }
  if (m_arm.moving(time_s())) return {ErrorCode::kRefused, "the base refuses to drive: the arm moves"};
  return m_base->command(twist, time_s());
}

Status RobotBody::moveGripper(double joint) {
  if (!m_gripper) return {ErrorCode::kNotFound, "this robot has no gripper"};
  if (!std::isfinite(joint)) return {ErrorCode::kInvalidInput, "gripper command is not a finite number"};
  later([this, joint] { m_gripper->command(joint); });
  return {};
}

Status RobotBody::aim(const std::string& pan_tilt, const std::map<std::string, double>& joints) {
  const auto& all = m_workcell.pan_tilts;
  const auto spec = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.name == pan_tilt; });
  if (spec == all.end()) return {ErrorCode::kNotFound, "this robot has no pan-tilt \"" + pan_tilt + "\""};
  for (const auto& [name, value] : joints) {
    if ((name != spec->pan_joint && name != spec->tilt_joint) || m_axes.count(name) == 0) {
      return {ErrorCode::kInvalidInput, "pan-tilt \"" + pan_tilt + "\" has no joint \"" + name + "\""};
    }
    if (!std::isfinite(value)) {
      return {ErrorCode::kInvalidInput, "pan-tilt \"" + pan_tilt + "\": joint " + name + " is not a finite number"};
    }
  }
  later([this, joints] {
    for (const auto& [name, value] : joints) m_axes.at(name).servo.moveTo(value);
  });
  return {};
}

void RobotBody::watchHeartbeat() {
  if (m_quiet || time_s() - m_heartbeat_s <= kQuiet_s) return;
  m_arm.brake(time_s());
  if (m_base) m_base->halt();
  m_quiet = true;
}

Eigen::Index RobotBody::stuckJoint() const {
  const auto target = m_faults.target("joint_stiction");
  if (!target) return -1;
  const auto& names = m_arm.joints();
  const auto found = std::find(names.begin(), names.end(), *target);
  if (found != names.end()) return found - names.begin();
  return static_cast<Eigen::Index>(std::min<std::size_t>(2, names.size() - 1));
}

void RobotBody::driveArm() {
  const Eigen::VectorXd wanted = m_arm.commandedAt(time_s()).positions;
  const Eigen::VectorXd before = m_motor;
  const Eigen::Index stuck = stuckJoint();
  for (Eigen::Index j = 0; j < m_motor.size(); ++j) {
    const double behind = std::abs(wanted[j] - m_motor[j]);
    if (j == stuck) {
      m_slipped_free = behind > (m_slipped_free ? kSticksAgain : kBreakaway);
      if (!m_slipped_free) continue;
    }
    const double reach = m_workcell.arm_limits.max_velocity[j] * kTick_s;
    m_motor[j] += std::clamp(wanted[j] - m_motor[j], -reach, reach);
  }
  if (stuck < 0) m_slipped_free = false;
  m_motor_velocity = (m_motor - before) / kTick_s;
  planning::setGroupPositions(*m_workcell.model, m_workcell.arm, m_errors.follow(m_motor), m_q);
}

void RobotBody::driveOthers() {
  for (auto& [name, axis] : m_axes) {
    axis.servo.step(kTick_s);
    m_q[axis.q_index] = axis.servo.position();
  }
  if (m_gripper) {
    m_gripper->step(kTick_s, X_WT(), m_faults.active("slipping_grasp"), m_world);
    m_q[m_gripper_index] = m_gripper->position();
    m_pusher->step(m_q, X_WB(), m_world);
  }
  m_world.step(kTick_s);
}

void RobotBody::tick() {
  ++m_ticks;
  while (!m_pending.empty() && m_pending.front().first <= time_s() + 1e-9) {
    m_pending.front().second();
    m_pending.pop_front();
  }
  m_faults.tick(time_s(), m_arm.moving(time_s()), kTick_s);
  watchHeartbeat();
  if (m_base) m_base->step(time_s(), kTick_s);
  driveArm();
  driveOthers();
  if (!readingIsNew()) return;
  m_contacts.check(m_q, X_WB(), m_world, time_s(),
                   m_base && m_base->moving() ? kDrivingShift : kRestingShift);
  read();
}

void RobotBody::read() {
  const auto& model = *m_workcell.model;
  Eigen::VectorXd q = m_q, v = Eigen::VectorXd::Zero(m_q.size());
  planning::setGroupPositions(model, m_workcell.arm, m_errors.read(m_motor), q);
  planning::setGroupPositions(model, m_workcell.arm, m_motor_velocity, v);
  for (const auto& [name, axis] : m_axes) v[axis.q_index] = axis.servo.velocity();
  if (m_gripper) v[m_gripper_index] = m_gripper->velocity();
  const auto n = static_cast<Eigen::Index>(m_names.size());
  m_measured = {time_s(), m_names, Eigen::VectorXd(n), Eigen::VectorXd(n)};
  m_measured.positions.head(q.size()) = q;
  m_measured.velocities.head(v.size()) = v;
  Eigen::Index at = q.size();
  for (const auto& joint : model.joints()) {
    if (joint.mimic_of < 0) continue;
    const int source = model.joints()[static_cast<std::size_t>(joint.mimic_of)].q_index;
    m_measured.positions[at] = joint.mimic_multiplier * q[source] + joint.mimic_offset;
    m_measured.velocities[at++] = joint.mimic_multiplier * v[source];
  }
}

std::map<std::string, double> RobotBody::trueJoints() const {
  std::map<std::string, double> out;
  const auto& model = *m_workcell.model;
  for (const auto& joint : model.joints()) {
    if (joint.q_index >= 0) out[joint.name] = m_q[joint.q_index];
    if (joint.mimic_of < 0) continue;
    const int source = model.joints()[static_cast<std::size_t>(joint.mimic_of)].q_index;
    out[joint.name] = joint.mimic_multiplier * m_q[source] + joint.mimic_offset;
  }
  return out;
}

Pose RobotBody::X_WB() const {
  const Pose X_WB = m_base ? poseOf(m_base->truth()) : Pose::Identity();
  if (!m_faults.active("moved_base")) return X_WB;
  return X_WB * poseFromRpy({0.02, 0.01, 0}, {0, 0, 1.0 * M_PI / 180});
}

std::optional<Attitude> RobotBody::attitude() const {
  if (!m_workcell.imu) return std::nullopt;
  const auto link = m_workcell.model->linkIndex(m_workcell.imu->link);
  const Pose X_WI = X_WB() * m_workcell.model->forward(m_q, *link);
  return Attitude{time_s(), X_WI.linear().transpose() * m_scenario.up};
}

Pose RobotBody::X_WT() const {
  const auto tip = m_workcell.model->linkIndex(m_workcell.arm.tip_link);
  return X_WB() * m_workcell.model->forward(m_q, *tip);
}

WorldSnapshot RobotBody::snapshot() const {
  const auto& model = *m_workcell.model;
  WorldSnapshot out;
  out.time_s = time_s();
  model.forward(m_q, out.X_WL);
  for (auto& X : out.X_WL) X = X_WB() * X;
  for (const auto& object : m_world.objects()) out.objects.push_back(object.body);
  const std::string usual = usualCamera(m_workcell);
  for (const auto& camera : m_workcell.cameras) {
    const auto link = model.linkIndex(camera.link);
    if (!link) continue;
    Pose X_WC = out.X_WL[static_cast<std::size_t>(*link)];
    if (m_faults.strikes("knocked_camera", camera.name, usual)) X_WC = X_WC * knock(camera.name, m_seed);
    out.X_WC[camera.name] = X_WC;
  }
  return out;
}

std::vector<GoalState> RobotBody::goals() const {
  std::vector<GoalState> out;
  for (const auto& goal : m_scenario.goals) {
    GoalState state{goal, false};
    const auto index = m_world.indexOf(goal.object);
    const bool held = index && m_world.held() == index;
    if (goal.kind == "grasp") state.reached = held;
    if (goal.kind == "lift" && held) {
      const double height = m_world.objects()[*index].body.X_WO.translation().z();
      state.reached = height - m_world.startPose(*index).translation().z() >= goal.amount - kGraspTolerance;
    }
    if (goal.kind == "open") {
      const auto& all = m_world.mechanisms();
      state.reached = std::any_of(all.begin(), all.end(), [&](const Mechanism& m) {
        return m.spec().name == goal.object && std::abs(m.value()) >= goal.amount;
      });
    }
    if (goal.kind == "move" && index) {
      const Eigen::Vector3d way = m_world.objects()[*index].body.X_WO.translation() - m_world.startPose(*index).translation();
      state.reached = way.head<2>().norm() >= goal.amount;
    }
    if (goal.kind == "touch") state.reached = m_contacts.touched(goal.object);
    if (goal.kind == "no_contact") {
      const auto& all = m_contacts.contacts();
      state.reached = std::none_of(all.begin(), all.end(), [&](const ContactEvent& c) {
        return goal.object.empty() || c.a == goal.object || c.b == goal.object;
      });
    }
    out.push_back(state);
  }
  return out;
}

}  // namespace longarm::virtual_robot
