#include "app/virtual_robot/finger_zone.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "app/virtual_robot/shape_rays.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kStep = 0.002;          // between surface points [m]
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Corners and rims of a link's collision shapes in the link's frame.
std::vector<Eigen::Vector3d> outline(const planning::Link& link) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& shape : link.collisions) {
    for (const auto& p : surfacePoints(shape.shape, 0.02)) out.push_back(shape.X_LS * p);
  }
  return out;
}

}  // namespace

Result<FingerZone> FingerZone::of(const planning::Workcell& workcell) {
  const auto& model = *workcell.model;
  const std::string name = workcell.gripper ? workcell.gripper->joint : std::string();
  const auto index = model.jointIndex(name);
  if (!index) return index.error();
  const auto tip = model.linkIndex(workcell.arm.tip_link);
  if (!tip) return tip.error();
  const auto& joint = model.joints()[static_cast<std::size_t>(*index)];
  const auto points = outline(model.links()[static_cast<std::size_t>(joint.child_link)]);
  if (joint.type != planning::JointType::kPrismatic || points.empty()) {
    return Error{ErrorCode::kInvalidInput, "gripper joint \"" + name +
                                               "\": the virtual robot needs a sliding finger with a collision shape"};
  }
  Eigen::VectorXd q = model.neutral();
  q[joint.q_index] = 0;
  const Pose X_TL = model.forward(q, *tip).inverse() * model.forward(q, joint.child_link);
  const Eigen::Vector3d y = (X_TL.linear() * joint.axis).normalized();
  const Eigen::Vector3d x = y.cross(Eigen::Vector3d::UnitZ()).normalized();
  FingerZone zone;
  zone.m_X_TZ.linear() << x, y, x.cross(y);
  Eigen::AlignedBox3d box;
  for (const auto& p : points) box.extend(zone.m_X_TZ.inverse() * (X_TL * p));
  zone.m_X_TZ.translation() = zone.m_X_TZ.linear().col(0) * box.center().x();
  zone.m_half_width = box.sizes().x() / 2;
  zone.m_pad_at_zero = box.min().y();
  zone.m_from = box.min().z();
  zone.m_to = box.max().z();
  return zone;
}

std::optional<Pinch> FingerZone::pinch(const planning::Shape& shape, const Pose& X_TO) const {
  const Pose X_ZO = m_X_TZ.inverse() * X_TO;
  const Eigen::Vector3d center(0, 0, (m_from + m_to) / 2);
  const double reach = boundingRadius(shape) + 0.3;
  if ((X_ZO.translation() - center).norm() > reach) return {};
  double low = kInfinity, high = -kInfinity, bottom = kInfinity, top = -kInfinity;
  for (const auto& point : surfacePoints(shape, kStep)) {
    const Eigen::Vector3d p = X_ZO * point;
    if (std::abs(p.x()) > m_half_width || p.z() < m_from || p.z() > m_to) continue;
    low = std::min(low, p.y());
    high = std::max(high, p.y());
    bottom = std::min(bottom, p.z());
    top = std::max(top, p.z());
  }
  if (low > high) return {};
  return Pinch{low, high, top - bottom};
}

}  // namespace longarm::virtual_robot
