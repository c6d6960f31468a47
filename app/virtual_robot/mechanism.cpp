#include "app/virtual_robot/mechanism.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace longarm::virtual_robot {

using planning::ScenarioMechanism;

Mechanism::Mechanism(ScenarioMechanism spec, std::vector<std::size_t> moves)
    : m_spec(std::move(spec)), m_moves(std::move(moves)) {}

bool Mechanism::carries(std::size_t object) const {
  return std::find(m_moves.begin(), m_moves.end(), object) != m_moves.end();
}

Pose Mechanism::motion(double value) const {
  Pose X = Pose::Identity();
  if (m_spec.kind == ScenarioMechanism::Kind::kSlide) {
    X.translation() = m_spec.axis * value;
    return X;
  }
  X.linear() = Eigen::AngleAxisd(value, m_spec.axis).toRotationMatrix();
  X.translation() = m_spec.origin - X.linear() * m_spec.origin;
  return X;
}

double Mechanism::nearest(const Eigen::Vector3d& grip_W, const Eigen::Vector3d& hand_W) const {
  if (m_spec.kind == ScenarioMechanism::Kind::kSlide) return m_spec.axis.dot(hand_W - grip_W);
  const auto across = [this](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    const Eigen::Vector3d arm = p - m_spec.origin;
    return arm - arm.dot(m_spec.axis) * m_spec.axis;
  };
  const Eigen::Vector3d from = across(grip_W), to = across(hand_W);
  const double angle = std::atan2(m_spec.axis.dot(from.cross(to)), from.dot(to));
  // A valve turns more than once round: the turn next to where it is.
  return angle + 2 * M_PI * std::round((m_value - angle) / (2 * M_PI));
}

double Mechanism::follow(const Eigen::Vector3d& grip_W, const Eigen::Vector3d& hand_W) {
  m_value = std::clamp(nearest(grip_W, hand_W), m_spec.lower, m_spec.upper);
  return (motion(m_value) * grip_W - hand_W).norm();
}

}  // namespace longarm::virtual_robot
