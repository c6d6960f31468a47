#include "planning/macros/reach_advice.h"

#include <cmath>

#include "core/text.h"

namespace longarm::planning {
namespace {

constexpr double kComfort = 0.85;        // share of the full reach at which hands can still be turned
constexpr double kTooNear = 0.3;

std::string metres(double value) { return formatFixed(value, 2) + " m"; }

// Way to drive, level, until the point is `wanted` from the shoulder; negative: away from it.
double wayToDrive(const Eigen::Vector3d& offset, double wanted) {
  const double level = offset.head<2>().norm();
  const double left = wanted * wanted - offset.z() * offset.z();
  return level - std::sqrt(std::max(left, 0.0));
}

}  // namespace

Reach reachOf(const Workcell& workcell, const Eigen::VectorXd& q) {
  const RobotModel& model = *workcell.model;
  const auto joint = [&](int i) -> const Joint& { return model.joints()[static_cast<std::size_t>(i)]; };
  Reach out;
  const auto& joints = workcell.arm.joints;
  const Joint& first = joint(joints.front());
  const Joint& second = joint(joints.size() > 2 ? joints[1] : joints[0]);
  const Pose X_first = model.forward(q, first.parent_link) * first.X_PJ;
  const Eigen::Vector3d axis = X_first.linear() * first.axis.normalized();
  const Eigen::Vector3d origin = (model.forward(q, second.parent_link) * second.X_PJ).translation();
  out.shoulder = X_first.translation() + axis.dot(origin - X_first.translation()) * axis;
  // From the tool back to the second joint: the lengths of all offsets, stretched out.
  int link = model.linkIndex(workcell.arm.tip_link).valueOr(model.rootLink());
  while (link != second.child_link && model.links()[static_cast<std::size_t>(link)].parent_joint >= 0) {
    const Joint& j = joint(model.links()[static_cast<std::size_t>(link)].parent_joint);
    out.length += j.X_PJ.translation().norm();
    if (j.type == JointType::kPrismatic) out.length += std::max(std::abs(j.lower), std::abs(j.upper));
    link = j.parent_link;
  }
  return out;
}

std::string reachFacts(const Reach& reach, const std::string& what, const Eigen::Vector3d& point) {
  return what + " is " + metres((point - reach.shoulder).norm()) + " from the shoulder, the arm reaches " + metres(reach.length);
}

std::string reachAdvice(const Reach& reach, const std::string& what, const Eigen::Vector3d& point) {
  const Eigen::Vector3d offset = point - reach.shoulder;
  const double distance = offset.norm();
  const double comfortable = kComfort * reach.length;
  const std::string facts = reachFacts(reach, what, point);
  if (std::abs(offset.z()) > comfortable) {
    return facts + ": it is " + metres(std::abs(offset.z())) + (offset.z() > 0 ? " above" : " below") +
           " the shoulder, driving does not help";
  }
  if (distance > comfortable) return facts + ": drive " + metres(wayToDrive(offset, comfortable)) + " closer";
  if (distance < kTooNear * reach.length) {
    return facts + ": it is too near, drive " + metres(-wayToDrive(offset, 0.5 * reach.length)) + " back";
  }
  return facts + ", but the hand cannot be turned there as it must be: drive so that it lies about " +
         metres(0.6 * reach.length) + " straight ahead of the arm";
}

}  // namespace longarm::planning
