#include "app/virtual_robot/joint_errors.h"

#include <algorithm>

namespace longarm::virtual_robot {
namespace {

constexpr double kDegree = M_PI / 180;

}  // namespace

JointErrors::JointErrors(const planning::RobotModel& model, const planning::JointGroup& arm,
                         const planning::Imperfections& imperfections, unsigned seed)
    : m_random(seed ^ 0x5eedu) {
  const auto n = static_cast<Eigen::Index>(arm.joints.size());
  m_offsets = m_half_play = m_noise = Eigen::VectorXd::Zero(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const auto& joint = model.joints()[static_cast<std::size_t>(arm.joints[static_cast<std::size_t>(j)])];
    const double drawn = m_random.between(-1, 1);
    if (joint.type == planning::JointType::kPrismatic) continue;
    m_offsets[j] = drawn * imperfections.joint_offset_deg * kDegree;
    m_half_play[j] = imperfections.backlash_deg * kDegree / 2;
    m_noise[j] = imperfections.encoder_noise_deg * kDegree;
  }
}

const Eigen::VectorXd& JointErrors::follow(const Eigen::VectorXd& motor) {
  if (!m_started) m_geared = motor;
  m_started = true;
  m_geared = m_geared.cwiseMax(motor - m_half_play).cwiseMin(motor + m_half_play);
  m_true = m_geared + m_offsets;
  return m_true;
}

Eigen::VectorXd JointErrors::read(const Eigen::VectorXd& motor) {
  Eigen::VectorXd out = motor;
  for (Eigen::Index j = 0; j < out.size(); ++j) {
    if (m_noise[j] > 0) out[j] += m_random.normal(m_noise[j]);
  }
  return out;
}

}  // namespace longarm::virtual_robot
