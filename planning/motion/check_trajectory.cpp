#include "planning/motion/check_trajectory.h"

#include <algorithm>
#include <cmath>

#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/collision_object.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "planning/collision/collision_world.h"
#include "planning/collision/fcl_shapes.h"
#include "planning/world/zone.h"

namespace longarm::planning {
namespace {

constexpr double kSampleStep = 1e-3;     // [s]

// One body of the sweep, as FCL's own collision object.
struct SweptBody {
  std::string name;
  int link = -1;
  bool object = false;
  BodyRole role = BodyRole::kSolid;
  Pose X_LS = Pose::Identity();
  std::shared_ptr<fcl::CollisionObject<double>> fcl;
};

class Sweep {
 public:
  Sweep(const Workcell& workcell, const CheckOptions& options) : m_workcell(workcell), m_options(options) {
    const RobotModel& model = *workcell.model;
    for (std::size_t i = 0; i < model.links().size(); ++i) {
      for (const auto& shape : model.links()[i].collisions) {
        add(model.links()[i].name, static_cast<int>(i), false, shape.shape, shape.X_LS);
      }
    }
    for (const auto* list : {&workcell.objects, &options.objects}) {
      for (const auto& object : *list) {
        if (!object.collides) continue;
        const int link = object.attached_link.empty() ? -1 : model.linkIndex(object.attached_link).valueOr(-1);
        for (const auto& barrier : barriersOf(object)) add(barrier.name, link, true, barrier.shape, barrier.X_WO, barrier.role);
      }
    }
    pairUp(allowedPairs(workcell));
  }

  // Names of a pair that touches at q, or empty names.
  std::pair<std::string, std::string> touching(const Eigen::VectorXd& q, double t) {
    std::vector<Pose> links;
    m_workcell.model->forward(q, links);
    for (auto& body : m_bodies) {
      body.fcl->setTransform(body.link < 0 ? body.X_LS : links[static_cast<std::size_t>(body.link)] * body.X_LS);
      body.fcl->computeAABB();
    }
    for (const auto& [a, b] : m_pairs) {
      if (!a->fcl->getAABB().overlap(b->fcl->getAABB()) || excused(*a, *b, t)) continue;
      if (collide(*a, *b)) return {a->name, b->name};
    }
    return {};
  }

 private:
  void add(const std::string& name, int link, bool object, const Shape& shape, const Pose& X_LS,
           BodyRole role = BodyRole::kSolid) {
    const internal::FclGeometry geometry = internal::toFcl(shape);
    if (!geometry) return;
    m_bodies.push_back({name, link, object, role, X_LS, std::make_shared<fcl::CollisionObject<double>>(geometry)});
  }

  // Zones are for the arm and what it carries.
  bool concerns(const SweptBody& zone, const SweptBody& other) const {
    return zone.role == BodyRole::kSolid || movedByArm(m_workcell, other.link);
  }

  void pairUp(const AllowedPairs& allowed) {
    for (std::size_t i = 0; i < m_bodies.size(); ++i) {
      for (std::size_t j = i + 1; j < m_bodies.size(); ++j) {
        const SweptBody& a = m_bodies[i];
        const SweptBody& b = m_bodies[j];
        if (a.link == b.link || (a.link < 0 && b.link < 0)) continue;
        if (!a.object && !b.object && allowed.count({std::min(a.link, b.link), std::max(a.link, b.link)})) continue;
        if (holds(a, b) || holds(b, a) || !concerns(a, b) || !concerns(b, a)) continue;
        m_pairs.emplace_back(&a, &b);
      }
    }
  }

  bool isGripper(const std::string& link) const {
    if (!m_workcell.gripper) return false;
    const auto& links = m_workcell.gripper->links;
    return std::find(links.begin(), links.end(), link) != links.end();
  }
  // Whether what hangs on this link is in the gripper's hand.
  bool gripped(int link) const {
    const std::string& name = m_workcell.model->links()[static_cast<std::size_t>(link)].name;
    return name == m_workcell.arm.tip_link || isGripper(name);
  }

  // Whether `object` is carried by, or next to, the link of `other`, or in the gripper of which that is a part.
  bool holds(const SweptBody& object, const SweptBody& other) const {
    if (!object.object || object.link < 0 || other.link < 0) return false;
    if (gripped(object.link) && isGripper(other.name)) return true;
    for (const auto& joint : m_workcell.model->joints()) {
      const bool joins = (joint.parent_link == object.link && joint.child_link == other.link) ||
                         (joint.child_link == object.link && joint.parent_link == other.link);
      if (joins) return true;
    }
    return false;
  }

  bool excused(const SweptBody& a, const SweptBody& b, double t) const {
    return std::any_of(m_options.allowed.begin(), m_options.allowed.end(), [&](const AllowedContact& contact) {
      const auto names = [&](const SweptBody& object, const SweptBody& link) {
        return object.object && object.role == BodyRole::kSolid && object.name == contact.object &&
               std::find(contact.links.begin(), contact.links.end(), link.name) != contact.links.end();
      };
      return t >= contact.from_s && t <= contact.to_s && (names(a, b) || names(b, a));
    });
  }

  static bool collide(const SweptBody& a, const SweptBody& b) {
    fcl::CollisionRequest<double> request(1, false);
    fcl::CollisionResult<double> result;
    try {
      fcl::collide(a.fcl.get(), b.fcl.get(), request, result);
    } catch (const std::exception&) {
      return true;
    }
    return result.isCollision();
  }

  const Workcell& m_workcell;
  const CheckOptions& m_options;
  std::vector<SweptBody> m_bodies;
  std::vector<std::pair<const SweptBody*, const SweptBody*>> m_pairs;
};

class Checker {
 public:
  Checker(const Workcell& workcell, const Trajectory& trajectory, Eigen::VectorXd q, const CheckOptions& options)
      : m_workcell(workcell), m_trajectory(trajectory), m_q(std::move(q)), m_options(options) {
    m_tip = workcell.model->linkIndex(workcell.arm.tip_link).valueOr(0);
    // The arm's joint behind each joint of the trajectory.
    const std::vector<std::string> arm = workcell.armJointNames();
    for (const auto& name : trajectory.joint_names) {
      m_order.push_back(std::find(arm.begin(), arm.end(), name) - arm.begin());
    }
  }

  CheckReport run() {
    m_report.duration = m_trajectory.duration();
    checkContinuity();
    checkLimits();
    checkCollisions();
    m_report.ok = m_report.violations.empty();
    return m_report;
  }

 private:
  const std::string& name(Eigen::Index j) const { return m_trajectory.joint_names[static_cast<std::size_t>(j)]; }

  void note(const std::string& kind, double t, const std::string& first, const std::string& second, double value,
            double limit, const std::string& sentence) {
    if (m_report.violations.size() >= m_options.max_violations) return;
    m_report.violations.push_back({kind, t, first, second, value, limit, sentence + " at t = " + formatFixed(t, 3) + " s"});
  }

  // One violation per joint and kind: the first sample past the limit, with the worst value.
  void noteWorst(const std::string& kind, Eigen::Index j, double t, double value, double limit) {
    for (auto& v : m_report.violations) {
      if (v.kind != kind || v.first != name(j)) continue;
      if (std::abs(value) <= std::abs(v.value)) return;
      m_report.violations.erase(m_report.violations.begin() + (&v - m_report.violations.data()));
      break;
    }
    note(kind, t, name(j), "", value, limit,
         name(j) + " has " + kind + " " + formatFixed(value, 4) + ", the limit is " + formatFixed(limit, 4));
  }

  // Between two points the joint must go as its velocities say: the mean of both ends, give or take what the
  // accelerations can make of it.
  void checkContinuity() {
    const auto& limits = m_workcell.arm_limits;
    for (std::size_t i = 1; i < m_trajectory.points.size(); ++i) {
      const auto& a = m_trajectory.points[i - 1];
      const auto& b = m_trajectory.points[i];
      const double h = b.t - a.t;
      for (Eigen::Index j = 0; j < a.positions.size(); ++j) {
        const double most = limits.max_velocity[m_order[static_cast<std::size_t>(j)]] * h + m_options.limit_tolerance;
        const double move = std::abs(b.positions[j] - a.positions[j]);
        if (move > most) {
          note("continuity", a.t, name(j), "", move, most,
               name(j) + " moves " + formatFixed(move, 4) + " in " + formatFixed(h, 4) + " s, at most " +
                   formatFixed(most, 4) + " is possible");
        }
      }
    }
  }

  void checkLimits() {
    const auto& limits = m_workcell.arm_limits;
    const int samples = static_cast<int>(std::ceil(m_trajectory.duration() / kSampleStep));
    Eigen::Vector3d before = m_workcell.model->forward(fullAt(0), m_tip).translation();
    for (int i = 0; i <= samples; ++i) {
      const double t = std::min(i * kSampleStep, m_trajectory.duration());
      const TrajectoryPoint p = m_trajectory.sample(t);
      for (Eigen::Index j = 0; j < p.positions.size(); ++j) {
        const Eigen::Index k = m_order[static_cast<std::size_t>(j)];
        checkJoint(p, j, limits.lower[k], limits.upper[k], limits.max_velocity[k], limits.max_acceleration[k]);
      }
      const Eigen::Vector3d now = m_workcell.model->forward(fullAt(t), m_tip).translation();
      if (i > 0 && i < samples) m_report.max_tool_speed = std::max(m_report.max_tool_speed, (now - before).norm() / kSampleStep);
      before = now;
    }
  }

  void checkJoint(const TrajectoryPoint& p, Eigen::Index j, double lower, double upper, double v, double a) {
    const double tolerance = m_options.limit_tolerance;
    if (p.positions[j] < lower - tolerance) noteWorst("position", j, p.t, p.positions[j], lower);
    if (p.positions[j] > upper + tolerance) noteWorst("position", j, p.t, p.positions[j], upper);
    if (std::abs(p.velocities[j]) > v + tolerance) noteWorst("velocity", j, p.t, p.velocities[j], v);
    if (std::abs(p.accelerations[j]) > a + tolerance) noteWorst("acceleration", j, p.t, p.accelerations[j], a);
    m_report.max_velocity_ratio = std::max(m_report.max_velocity_ratio, std::abs(p.velocities[j]) / v);
    m_report.max_acceleration_ratio = std::max(m_report.max_acceleration_ratio, std::abs(p.accelerations[j]) / a);
  }

  Eigen::VectorXd fullAt(double t) const {
    const TrajectoryPoint p = m_trajectory.sample(t);
    Eigen::VectorXd arm = groupPositions(*m_workcell.model, m_workcell.arm, m_q);
    for (std::size_t j = 0; j < m_order.size(); ++j) arm[m_order[j]] = p.positions[static_cast<Eigen::Index>(j)];
    Eigen::VectorXd q = m_q;
    setGroupPositions(*m_workcell.model, m_workcell.arm, arm, q);
    return q;
  }

  void checkCollisions() {
    Sweep sweep(m_workcell, m_options);
    Eigen::VectorXd last = fullAt(0);
    std::pair<std::string, std::string> before = sweep.touching(last, 0);
    m_report.states = 1;
    if (!before.first.empty()) noteCollision(before, 0);
    const int samples = static_cast<int>(std::ceil(m_trajectory.duration() / kSampleStep));
    for (int i = 1; i <= samples; ++i) {
      const double t = std::min(i * kSampleStep, m_trajectory.duration());
      const Eigen::VectorXd q = fullAt(t);
      const double move = (q - last).cwiseAbs().maxCoeff();
      if (move < 0.5 * m_options.joint_step && i < samples) continue;
      // A jump between two samples (a bad file) is walked through as well.
      const int steps = std::clamp(static_cast<int>(std::ceil(move / m_options.joint_step)), 1, 10000);
      for (int k = 1; k <= steps; ++k) {
        const auto pair = sweep.touching(last + (q - last) * k / steps, t);
        ++m_report.states;
        if (!pair.first.empty() && pair != before) noteCollision(pair, t);
        before = pair;
      }
      last = q;
    }
  }

  void noteCollision(const std::pair<std::string, std::string>& pair, double t) {
    note("collision", t, pair.first, pair.second, 0, 0, pair.first + " touches " + pair.second);
  }

  const Workcell& m_workcell;
  const Trajectory& m_trajectory;
  Eigen::VectorXd m_q;
  const CheckOptions& m_options;
  int m_tip = 0;
  std::vector<Eigen::Index> m_order;
  CheckReport m_report;
};

Status checkArguments(const Workcell& workcell, const Trajectory& trajectory, const Eigen::VectorXd& q) {
  if (q.size() != workcell.model->dof()) {
    return {ErrorCode::kInvalidInput, "check: configuration has " + std::to_string(q.size()) + " joints, the robot " +
                                          std::to_string(workcell.model->dof())};
  }
  const std::vector<std::string> arm = workcell.armJointNames();
  for (const auto& name : trajectory.joint_names) {
    if (std::find(arm.begin(), arm.end(), name) != arm.end()) continue;
    std::string known;
    for (const auto& joint : arm) known += (known.empty() ? "" : ", ") + joint;
    return {ErrorCode::kInvalidInput, "check: joint \"" + name + "\" is none of the arm's (" + known + ")"};
  }
  return {};
}

}  // namespace

Result<CheckReport> checkTrajectory(const Workcell& workcell, const Trajectory& trajectory, const Eigen::VectorXd& q,
                                    const CheckOptions& options) {
  if (auto status = checkArguments(workcell, trajectory, q); !status) return status.error();
  if (auto status = validate(trajectory); !status) {
    CheckReport report;
    report.violations.push_back({"malformed", 0, "", "", 0, 0, status.error().message});
    return report;
  }
  if (trajectory.duration() > 3600) {
    return Error{ErrorCode::kInvalidInput, "check: trajectory lasts " + formatNumber(trajectory.duration()) +
                                               " s (limit 3600 s)"};
  }
  return Checker(workcell, trajectory, q, options).run();
}

nlohmann::json toJson(const CheckReport& report) {
  nlohmann::json violations = nlohmann::json::array();
  for (const auto& v : report.violations) {
    nlohmann::json entry{{"kind", v.kind}, {"t", v.t}, {"value", v.value}, {"limit", v.limit}, {"reason", v.sentence}};
    if (v.second.empty()) {
      entry["joint"] = v.first;
    } else {
      entry["links"] = {v.first, v.second};
    }
    violations.push_back(std::move(entry));
  }
  return {{"ok", report.ok},
          {"duration", report.duration},
          {"max_velocity_ratio", report.max_velocity_ratio},
          {"max_acceleration_ratio", report.max_acceleration_ratio},
          {"max_tool_speed", report.max_tool_speed},
          {"states", report.states},
          {"violations", std::move(violations)}};
}

}  // namespace longarm::planning
