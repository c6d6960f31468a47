#include "planning/macros/recorded_motion.h"

#include <algorithm>
#include <cctype>
#include <exception>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "planning/macros/free_move.h"
#include "planning/macros/planning_run.h"
#include "planning/motion/timed_motion.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

using nlohmann::json;

constexpr double kHere = 1e-4;  // nearer is where the arm stands [rad or m]
constexpr std::size_t kLongestFile = 4u << 20;

// Largest difference of a joint from the straight way between two others.
double offStraight(const Eigen::VectorXd& q, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const Eigen::VectorXd way = b - a;
  const double length2 = way.squaredNorm();
  const double s = length2 > 0 ? std::clamp((q - a).dot(way) / length2, 0.0, 1.0) : 0;
  return (q - a - s * way).cwiseAbs().maxCoeff();
}

void thin(const std::vector<Eigen::VectorXd>& all, std::size_t from, std::size_t to, double tolerance,
          std::vector<bool>& kept) {
  std::vector<std::pair<std::size_t, std::size_t>> open{{from, to}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double worst = tolerance;
    std::size_t at = 0;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double off = offStraight(all[i], all[a], all[b]);
      if (off > worst) worst = off, at = i;
    }
    if (at == 0) continue;
    kept[at] = true;
    open.push_back({a, at});
    open.push_back({at, b});
  }
}

class RecordedRun {
 public:
  RecordedRun(const PlanContext& context, const std::string& macro, const RecordedMotion& motion)
      : m_run(context, macro), m_motion(motion) {}

  Plan run() {
    if (!m_run.begin() || !readWaypoints()) return m_run.plan();
    const bool here = (m_points.front() - m_run.start()).cwiseAbs().maxCoeff() < kHere;
    if (here)
      m_run.keepContact();
    else if (!m_run.leaveContact())
      return m_run.plan();
    const auto world = m_run.makeWorld({}, m_run.configuration());
    const ArmSpace space(m_run.workcell(), *world, m_run.configuration(), m_run.context().cancel);
    m_run.plan().goal = space.tip(m_points.front());
    if (!checkFree(space)) return m_run.plan();
    const std::string where = "the first way-point of \"" + m_motion.name + "\"";
    if (!here && !appendFreeMove(m_run, space, m_points.front(), where, "approach")) return m_run.plan();
    return replay(space);
  }

 private:
  // The arm's joints in its order, without way-points that repeat the one before.
  bool readWaypoints() {
    const auto names = m_run.workcell().armJointNames();
    std::vector<Eigen::Index> order;
    for (const auto& name : names) {
      const auto found = std::find(m_motion.joint_names.begin(), m_motion.joint_names.end(), name);
      if (found == m_motion.joint_names.end()) {
        m_run.fail(PlanStatus::kLimits,
                   "\"" + m_motion.name + "\" was recorded with another arm: it has no joint " + name + ".");
        return false;
      }
      order.push_back(found - m_motion.joint_names.begin());
    }
    const auto& limits = m_run.workcell().arm_limits;
    for (std::size_t i = 0; i < m_motion.waypoints.size(); ++i) {
      Eigen::VectorXd q(static_cast<Eigen::Index>(names.size()));
      for (std::size_t j = 0; j < names.size(); ++j)
        q[static_cast<Eigen::Index>(j)] = m_motion.waypoints[i].joints[order[j]];
      for (Eigen::Index j = 0; j < q.size(); ++j) {
        if (q[j] >= limits.lower[j] - 2e-3 && q[j] <= limits.upper[j] + 2e-3) continue;
        m_run.fail(PlanStatus::kLimits,
                   "Way-point \"" + m_motion.waypoints[i].name + "\" wants " +
                       names[static_cast<std::size_t>(j)] + " at " + formatFixed(q[j], 3) +
                       ", outside its limits. Delete it.",
                   static_cast<int>(i));
        return false;
      }
      q = q.cwiseMax(limits.lower).cwiseMin(limits.upper);
      if (!m_points.empty() && (q - m_points.back()).cwiseAbs().maxCoeff() < kHere) continue;
      m_points.push_back(q);
      m_names.push_back(m_motion.waypoints[i].name);
    }
    return true;
  }

  bool checkFree(const ArmSpace& space) {
    Contact contact;
    if (!space.valid(m_points.front(), &contact))
      return refuse(space, 0, "At way-point \"" + m_names.front() + "\"", contact);
    for (std::size_t i = 1; i < m_points.size(); ++i) {
      if (space.segmentFree(m_points[i - 1], m_points[i], &contact)) continue;
      return refuse(space, i, "Between way-points \"" + m_names[i - 1] + "\" and \"" + m_names[i] + "\"",
                    contact);
    }
    return true;
  }

  bool refuse(const ArmSpace& space, std::size_t i, const std::string& where, const Contact& contact) {
    m_run.fail(PlanStatus::kApproachBlocked, where + " the arm would collide: " + contact.sentence() + ".",
               static_cast<int>(i), space.tip(m_points[i]));
    m_run.plan().failed_stage = "replay";
    return false;
  }

  Plan replay(const ArmSpace& space) {
    Plan& plan = m_run.plan();
    const double start = plan.trajectory.duration();
    if (m_points.size() == 1 && plan.trajectory.empty()) {
      plan.notes.push_back("The arm is already there.");
      m_points.push_back(m_points.front());
      appendStage(plan, "replay", false, standStill(m_run.workcell().armJointNames(), m_points.front(), 0.1));
    } else if (m_points.size() > 1) {
      const auto timed = timedPath(m_run.workcell(), space, m_points, {m_run.workcell().max_tool_speed});
      if (!timed) return m_run.fail(PlanStatus::kNoPath, timed.error().message);
      appendStage(plan, "replay", false, *timed);
    }
    measureRatios(m_run.workcell(), plan, m_run.context().cancel);
    measureClearance(space, plan, start, plan.trajectory.duration());
    plan.goal = space.tip(m_points.back());
    return m_run.finish();
  }

  PlanningRun m_run;
  const RecordedMotion& m_motion;
  std::vector<Eigen::VectorXd> m_points;
  std::vector<std::string> m_names;
};

class RecordedMacro final : public Macro {
 public:
  explicit RecordedMacro(RecordedMotion motion) : m_motion(std::move(motion)), m_name(macroName(m_motion)) {}

  MacroInfo info() const override {
    return {m_name,
            m_motion.name,
            "Replays the recorded motion \"" + m_motion.name + "\", " +
                std::to_string(m_motion.waypoints.size()) + " way-points.",
            {}};
  }
  Plan plan(const PlanContext& context, const vision::Feature* feature) const override {
    try {
      if (feature != nullptr) {
        return PlanningRun(context, m_name)
            .fail(PlanStatus::kBadFeature, "\"" + m_motion.name + "\" takes no feature: select nothing.");
      }
      return RecordedRun(context, m_name, m_motion).run();
    } catch (const std::exception& e) {
      return PlanningRun(context, m_name)
          .fail(PlanStatus::kNoPath, std::string("Planning failed inside: ") + e.what());
    }
  }

 private:
  const RecordedMotion m_motion;
  const std::string m_name;
};

json toJson(const RecordedMotion& motion) {
  json points = json::array();
  for (const auto& p : motion.waypoints) {
    points.push_back(
        {{"name", p.name},
         {"positions", std::vector<double>(p.joints.data(), p.joints.data() + p.joints.size())}});
  }
  return {{"format", 1}, {"name", motion.name}, {"joints", motion.joint_names}, {"waypoints", points}};
}

// Throws what nlohmann::json throws.
RecordedMotion fromJson(const json& file) {
  RecordedMotion motion;
  motion.name = file.at("name").get<std::string>();
  motion.joint_names = file.at("joints").get<std::vector<std::string>>();
  for (const auto& point : file.at("waypoints")) {
    const auto list = point.at("positions").get<std::vector<double>>();
    motion.waypoints.push_back(
        {point.at("name").get<std::string>(),
         Eigen::Map<const Eigen::VectorXd>(list.data(), static_cast<Eigen::Index>(list.size()))});
  }
  return motion;
}

}  // namespace

Status validate(const RecordedMotion& motion) {
  const auto wrong = [&](const std::string& what) {
    return Status(ErrorCode::kInvalidInput, "recorded motion \"" + motion.name + "\": " + what);
  };
  if (motion.name.empty() || motion.name.size() > 60) return wrong("its name must have 1 to 60 characters");
  if (motion.joint_names.empty()) return wrong("it names no joints");
  if (motion.waypoints.empty() || motion.waypoints.size() > kMostWaypoints) {
    return wrong("it has " + std::to_string(motion.waypoints.size()) + " way-points; 1 to " +
                 std::to_string(kMostWaypoints) + " are allowed");
  }
  for (const auto& p : motion.waypoints) {
    if (p.joints.size() != static_cast<Eigen::Index>(motion.joint_names.size()) || !p.joints.allFinite()) {
      return wrong("way-point \"" + p.name + "\" needs " + std::to_string(motion.joint_names.size()) +
                   " finite joints");
    }
  }
  return {};
}

std::string macroName(const RecordedMotion& motion) {
  std::string out = "recorded_";
  for (const char c : motion.name) {
    const auto byte = static_cast<unsigned char>(c);
    out += byte < 128 && std::isalnum(byte) != 0 ? static_cast<char>(std::tolower(byte)) : '_';
  }
  return out;
}

std::vector<Eigen::VectorXd> thinned(const std::vector<Eigen::VectorXd>& joints, double tolerance) {
  if (joints.size() < 3) return joints;
  std::vector<bool> kept(joints.size(), false);
  kept.front() = kept.back() = true;
  thin(joints, 0, joints.size() - 1, tolerance, kept);
  std::vector<Eigen::VectorXd> out;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (kept[i]) out.push_back(joints[i]);
  }
  return out;
}

Status writeRecordedMotion(const std::string& path, const RecordedMotion& motion) {
  if (auto status = validate(motion); !status) return status;
  return writeFileAtomically(path, toJson(motion).dump(1) + "\n");
}

Result<RecordedMotion> readRecordedMotion(const std::string& path) {
  const auto text = readTextFile(path, kLongestFile);
  if (!text) return text.error();
  try {
    RecordedMotion motion = fromJson(json::parse(*text));
    if (auto status = validate(motion); !status)
      return Error{status.error().code, path + ": " + status.error().message};
    return motion;
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInvalidInput, path + ": is no recorded motion: " + e.what()};
  }
}

std::unique_ptr<Macro> makeRecordedMotion(RecordedMotion motion) {
  return std::make_unique<RecordedMacro>(std::move(motion));
}

}  // namespace longarm::planning
