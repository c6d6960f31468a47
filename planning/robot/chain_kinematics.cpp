#include "planning/robot/chain_kinematics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/require.h"

namespace longarm::planning {
namespace {

Eigen::Matrix3d aboutZ(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

/// R = Rz(a) Rx(b) Rz(c).
struct ZxzAngles {
  double a = 0, b = 0, c = 0;
};

ZxzAngles zxzOf(const Eigen::Matrix3d& R) {
  ZxzAngles angles;
  const double tilt = std::hypot(R(0, 2), R(1, 2));
  angles.b = std::atan2(tilt, R(2, 2));
  if (tilt > 1e-14) angles.a = std::atan2(R(0, 2), -R(1, 2));
  const Eigen::Matrix3d rest = Eigen::AngleAxisd(-angles.b, Eigen::Vector3d::UnitX()).toRotationMatrix() *
                               aboutZ(-angles.a) * R;
  angles.c = std::atan2(rest(1, 0), rest(0, 0));
  return angles;
}

double heldValue(const RobotModel& model, const Joint& joint, const Eigen::VectorXd& reference) {
  if (joint.q_index >= 0) return reference[joint.q_index];
  if (joint.mimic_of < 0) return 0;
  const Joint& driver = model.joints()[static_cast<std::size_t>(joint.mimic_of)];
  return joint.mimic_multiplier * reference[driver.q_index] + joint.mimic_offset;
}

Pose heldMotion(const Joint& joint, double value) {
  Pose X = Pose::Identity();
  if (joint.type == JointType::kPrismatic) X.translation() = value * joint.axis;
  if (joint.type == JointType::kRevolute || joint.type == JointType::kContinuous) {
    X.linear() = Eigen::AngleAxisd(value, joint.axis).toRotationMatrix();
  }
  return X;
}

std::vector<int> pathFromRoot(const RobotModel& model, int link) {
  std::vector<int> path;
  for (int up = model.links()[static_cast<std::size_t>(link)].parent_joint; up >= 0;) {
    path.push_back(up);
    up = model.links()[static_cast<std::size_t>(model.joints()[static_cast<std::size_t>(up)].parent_link)].parent_joint;
  }
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace

ChainKinematics::ChainKinematics(const RobotModel& model, const JointGroup& group,
                                 const Eigen::VectorXd& reference) {
  m_size = static_cast<int>(group.joints.size());
  LONGARM_REQUIRE(m_size >= 1 && m_size <= kMaxJoints, "a chain of " + std::to_string(m_size) + " joints");
  LONGARM_REQUIRE(reference.size() == model.dof(), "reference of the wrong size");
  const auto tip = model.linkIndex(group.tip_link);
  LONGARM_REQUIRE(tip.ok(), "group with an unknown tip \"" + group.tip_link + "\"");
  std::vector<bool> seen(group.joints.size(), false);
  Pose X = Pose::Identity();  // What is constant since the last moving joint.
  for (const int index : pathFromRoot(model, *tip)) {
    const Joint& joint = model.joints()[static_cast<std::size_t>(index)];
    X = X * joint.X_PJ;
    const int driver = joint.mimic_of >= 0 ? joint.mimic_of : index;
    const auto found = std::find(group.joints.begin(), group.joints.end(), driver);
    if (joint.type == JointType::kFixed || found == group.joints.end()) {
      X = X * heldMotion(joint, heldValue(model, joint, reference));
      continue;
    }
    const Eigen::Matrix3d R_axis = rotationWithZ(joint.axis);
    const ZxzAngles turn = zxzOf(X.linear() * R_axis);
    if (m_steps.empty()) {
      m_base = aboutZ(turn.a);
      m_base_shift = X.translation();
    } else {
      m_steps.back().offset += turn.a;
    }
    Step step;
    step.shift = m_steps.empty() ? Eigen::Vector3d::Zero() : Eigen::Vector3d(aboutZ(-turn.a) * X.translation());
    step.x_cos = std::cos(turn.b);
    step.x_sin = std::sin(turn.b);
    step.offset = turn.c;
    step.prismatic = joint.type == JointType::kPrismatic;
    step.column = static_cast<int>(found - group.joints.begin());
    step.adds = seen[static_cast<std::size_t>(step.column)];
    seen[static_cast<std::size_t>(step.column)] = true;
    if (joint.mimic_of >= 0) {
      step.multiplier = joint.mimic_multiplier;
      step.value_offset = joint.mimic_offset;
    }
    m_steps.push_back(step);
    X = Pose::Identity();
    X.linear() = R_axis.transpose();
  }
  m_tail = X.linear();
  m_tail_shift = X.translation();
  m_has_tail = !m_tail.isIdentity(0);
  LONGARM_REQUIRE(static_cast<int>(m_steps.size()) <= 2 * kMaxJoints, "too many mimic joints in a chain");
}

template <bool kWithAxes>
void ChainKinematics::walk(const double* q, Eigen::Matrix3d& R, Eigen::Vector3d& p, Eigen::Vector3d* axes,
                           Eigen::Vector3d* origins) const {
  Eigen::Vector3d x = m_base.col(0), y = m_base.col(1), z = m_base.col(2);
  p = m_base_shift;
  for (const Step& step : m_steps) {
    p += step.shift.x() * x + step.shift.y() * y + step.shift.z() * z;
    const Eigen::Vector3d turned = step.x_cos * y + step.x_sin * z;
    z = step.x_cos * z - step.x_sin * y;
    const double value = step.multiplier * q[step.column] + step.value_offset;
    const double angle = step.prismatic ? step.offset : value + step.offset;
    if (step.prismatic) p += value * z;
    const double c = std::cos(angle), s = std::sin(angle);
    y = c * turned - s * x;
    x = c * x + s * turned;
    if constexpr (kWithAxes) {
      *axes++ = z;
      *origins++ = p;
    }
  }
  p += m_tail_shift.x() * x + m_tail_shift.y() * y + m_tail_shift.z() * z;
  R.col(0) = x;
  R.col(1) = y;
  R.col(2) = z;
  if (m_has_tail) R = R * m_tail;
}

Pose ChainKinematics::forward(const double* q) const {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
  walk<false>(q, R, p, nullptr, nullptr);
  Pose X = Pose::Identity();
  X.linear() = R;
  X.translation() = p;
  return X;
}

void ChainKinematics::forwardAndJacobian(const double* q, Eigen::Matrix3d& R, Eigen::Vector3d& p,
                                         double* J) const {
  std::array<Eigen::Vector3d, 2 * kMaxJoints> axes, origins;
  walk<true>(q, R, p, axes.data(), origins.data());
  for (std::size_t i = 0; i < m_steps.size(); ++i) {
    const Step& step = m_steps[i];
    Eigen::Map<Eigen::Matrix<double, 6, 1>> column(J + 6 * step.column);
    const Eigen::Vector3d axis = step.multiplier * axes[i];
    const Eigen::Vector3d linear = step.prismatic ? axis : Eigen::Vector3d(axis.cross(p - origins[i]));
    if (!step.adds) column.setZero();
    if (!step.prismatic) column.head<3>() += axis;
    column.tail<3>() += linear;
  }
}

}  // namespace longarm::planning
