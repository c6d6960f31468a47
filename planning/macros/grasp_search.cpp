#include "planning/macros/grasp_search.h"

#include <algorithm>

namespace longarm::planning {
namespace {

constexpr int kRestarts = 5;             // of the inverse kinematics, per grasp
constexpr double kDistinct = 0.1;        // postures closer than this are one [rad]

}  // namespace

GraspSearch::GraspSearch(PlanningRun& run, const ArmSpace& transit, const ArmSpace& approach,
                         const GrabPipeOptions& options)
    : m_run(run),
      m_transit(transit),
      m_approach(approach),
      m_options(options),
      m_solver(run.workcell().model, run.workcell().arm, transit.full(run.start())) {}

void GraspSearch::tryGrasp(const PipeGrasp& grasp, std::vector<ReachableGrasp>& out) {
  IkOptions options;
  options.restarts = kRestarts;
  options.seed = m_run.context().seed;
  const auto postures = m_solver.solveAll(grasp.X_RT, m_run.start(), options, kDistinct);
  bool within_limits = false;
  if (postures) {
    for (const auto& posture : *postures) {
      if (m_run.cancelled() || m_run.timeUp()) return;
      if (!m_approach.withinLimits(posture.joints)) continue;
      within_limits = true;
      tryPosture(grasp, posture.joints, out);
    }
  }
  if (!within_limits) ++m_refusals.unreachable;
  if (!m_refusals.pose && out.empty()) m_refusals.pose = grasp.X_RT;
}

bool GraspSearch::tryPosture(const PipeGrasp& grasp, const Eigen::VectorXd& arm, std::vector<ReachableGrasp>& out) {
  Contact contact;
  if (!m_approach.valid(arm, &contact)) {
    if (m_refusals.colliding++ == 0) m_refusals.contact = contact;
    return false;
  }
  const auto blocked = [&](const std::string& why) {
    if (m_refusals.blocked++ == 0) m_refusals.leg = why;
    return false;
  };
  // Walked backwards, from the grasp, whose joints are exact.
  StraightLeg leg = followLine(m_approach, arm, grasp.X_RT * Eigen::Translation3d(0, 0, -m_options.standoff));
  if (!leg.ok) return blocked(leg.why);
  if (!m_transit.valid(leg.waypoints.back(), &contact)) return blocked("before it, " + contact.sentence());
  for (std::size_t i = 1; i < leg.waypoints.size(); ++i) {
    if (!m_approach.segmentFree(leg.waypoints[i - 1], leg.waypoints[i], &contact)) return blocked("on it, " + contact.sentence());
  }
  std::reverse(leg.waypoints.begin(), leg.waypoints.end());
  std::reverse(leg.way.begin(), leg.way.end());
  const double length = leg.way.front();
  for (double& way : leg.way) way = length - way;
  out.push_back({grasp, std::move(leg)});
  return true;
}

}  // namespace longarm::planning
