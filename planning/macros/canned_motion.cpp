#include "planning/macros/canned_motion.h"

#include <algorithm>
#include <cctype>
#include <exception>

#include "core/text.h"
#include "planning/macros/free_move.h"
#include "planning/macros/macro_arguments.h"
#include "planning/macros/planning_run.h"
#include "planning/motion/timed_motion.h"
#include "planning/trajectory/time_parameterization.h"

namespace longarm::planning {
namespace {

std::string titleOf(const std::string& name) {
  std::string title = name;
  bool start = true;
  for (char& c : title) {
    if (c == '_') c = ' ';
    if (start) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    start = c == ' ';
  }
  return title;
}

class CannedRun {
 public:
  CannedRun(const PlanContext& context, const std::string& name, const std::map<std::string, double>& joints)
      : m_run(context, name), m_name(name), m_joints(joints) {}

  Plan run() {
    if (!m_run.begin()) return m_run.plan();
    if (!readGoal()) return m_run.plan();
    if ((m_goal - m_run.start()).norm() < 1e-6) m_run.keepContact();
    else if (!m_run.leaveContact()) return m_run.plan();
    const auto world = m_run.makeWorld({}, m_run.configuration());
    const ArmSpace space(m_run.workcell(), *world, m_run.configuration(), m_run.context().cancel);
    m_run.plan().goal = space.tip(m_goal);
    if ((m_goal - m_run.start()).norm() < 1e-6) return standHere(space);
    Contact contact;
    if (!space.valid(m_goal, &contact)) {
      return m_run.fail(PlanStatus::kGoalInCollision,
                        "At \"" + m_name + "\" the arm would collide: " + contact.sentence() + ".", 1, m_run.plan().goal);
    }
    return move(space);
  }

 private:
  bool readGoal() {
    m_goal = m_run.start();
    const auto names = m_run.workcell().armJointNames();
    const auto& limits = m_run.workcell().arm_limits;
    std::string others;
    for (const auto& [joint, value] : m_joints) {
      const auto it = std::find(names.begin(), names.end(), joint);
      if (it == names.end()) {
        others += (others.empty() ? "" : ", ") + joint;
        continue;
      }
      const auto j = static_cast<Eigen::Index>(it - names.begin());
      if (!(value >= limits.lower[j] && value <= limits.upper[j])) {
        m_run.fail(PlanStatus::kLimits, "Pose \"" + m_name + "\" wants " + joint + " at " + formatFixed(value, 3) +
                                            ", outside its limits " + formatFixed(limits.lower[j], 3) + " ... " +
                                            formatFixed(limits.upper[j], 3) + ": correct the workcell.", 1);
        return false;
      }
      m_goal[j] = value;
    }
    if (!others.empty()) m_run.plan().notes.push_back("The pose also names " + others + ", which this motion leaves alone.");
    return true;
  }

  Plan standHere(const ArmSpace& space) {
    m_run.plan().notes.push_back("The arm is already there.");
    appendStage(m_run.plan(), "transit", false, standStill(m_run.workcell().armJointNames(), m_goal, 0.1));
    measureClearance(space, m_run.plan(), 0, 0.1);
    return m_run.finish();
  }

  Plan move(const ArmSpace& space) {
    if (!appendFreeMove(m_run, space, m_goal, "\"" + m_name + "\"", "transit")) return m_run.plan();
    return m_run.finish();
  }

  PlanningRun m_run;
  const std::string& m_name;
  const std::map<std::string, double>& m_joints;
  Eigen::VectorXd m_goal;
};

}  // namespace

CannedMotion::CannedMotion(std::string name, std::map<std::string, double> joints)
    : m_name(std::move(name)), m_joints(std::move(joints)) {}

MacroInfo CannedMotion::info() const {
  return {m_name, titleOf(m_name), "Moves the arm to its pose \"" + m_name + "\".", {}};
}

Plan CannedMotion::plan(const PlanContext& context, const vision::Feature* feature) const {
  try {
    if (feature != nullptr) {
      return PlanningRun(context, m_name).fail(PlanStatus::kBadFeature, "\"" + m_name + "\" takes no feature: select nothing.");
    }
    if (const auto arguments = MacroArguments::from(info(), context.arguments); !arguments) {
      return PlanningRun(context, m_name).fail(PlanStatus::kLimits, "Cannot plan: " + arguments.error().message + ".");
    }
    return CannedRun(context, m_name, m_joints).run();
  } catch (const std::exception& e) {
    return PlanningRun(context, m_name).fail(PlanStatus::kNoPath, std::string("Planning failed inside: ") + e.what());
  }
}

}  // namespace longarm::planning
