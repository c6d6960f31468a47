#include "planning/motion/arm_space.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning {

ArmSpace::ArmSpace(const Workcell& workcell, CollisionWorld& world, Eigen::VectorXd q, CancelToken cancel)
    : m_workcell(&workcell),
      m_world(&world),
      m_q(std::move(q)),
      m_scratch(m_q),
      m_lower(workcell.arm_limits.lower.cwiseMax(-2 * M_PI)),
      m_upper(workcell.arm_limits.upper.cwiseMin(2 * M_PI)),
      m_tip(workcell.model->linkIndex(workcell.arm.tip_link).valueOr(workcell.model->rootLink())),
      m_cancel(std::move(cancel)) {}

Eigen::VectorXd ArmSpace::full(const Eigen::VectorXd& arm) const {
  Eigen::VectorXd q = m_q;
  setGroupPositions(model(), group(), arm, q);
  return q;
}

Pose ArmSpace::tip(const Eigen::VectorXd& arm) const { return model().forward(full(arm), m_tip); }

bool ArmSpace::withinLimits(const Eigen::VectorXd& arm, double tolerance) const {
  return ((arm - m_lower).array() >= -tolerance).all() && ((m_upper - arm).array() >= -tolerance).all();
}

bool ArmSpace::valid(const Eigen::VectorXd& arm, Contact* contact) const {
  if (cancelled()) return false;
  setGroupPositions(model(), group(), arm, m_scratch);
  return !m_world->inCollision(m_scratch, contact);
}

bool ArmSpace::segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const {
  return !cancelled() && m_world->segmentFree(full(a), full(b), contact);
}

double ArmSpace::toolWay(const Eigen::VectorXd& arm, const Eigen::VectorXd& dq) const {
  return (model().jacobian(full(arm), group()).bottomRows<3>() * dq).norm();
}

}  // namespace longarm::planning
