#include "planning/collision/reach.h"

#include <algorithm>
#include <cmath>

namespace longarm::planning {
namespace {

double distanceFromAxis(const Eigen::Vector3d& p, const Eigen::Vector3d& axis) { return (p - p.dot(axis) * axis).norm(); }

double largestTravel(const RobotModel& model, const Joint& joint) {
  if (joint.mimic_of < 0) return std::max(std::abs(joint.lower), std::abs(joint.upper));
  const Joint& leader = model.joints()[static_cast<std::size_t>(joint.mimic_of)];
  return std::abs(joint.mimic_multiplier) * largestTravel(model, leader) + std::abs(joint.mimic_offset);
}

// Entry of q that drives the joint, and how much the joint moves per unit of it.
std::pair<int, double> driver(const RobotModel& model, const Joint& joint) {
  if (joint.mimic_of < 0) return {joint.q_index, 1};
  const auto [index, factor] = driver(model, model.joints()[static_cast<std::size_t>(joint.mimic_of)]);
  return {index, factor * std::abs(joint.mimic_multiplier)};
}

// The swept body as seen while walking towards the root: exact until the first moving joint, a ball after it.
struct Swept {
  Eigen::Vector3d a, b;
  double radius = 0;

  void transform(const Pose& X) {
    a = X * a;
    b = X * b;
  }
  double fromAxis(const Eigen::Vector3d& axis) const {
    return std::max(distanceFromAxis(a, axis), distanceFromAxis(b, axis)) + radius;
  }
  // Every point that turning about, or sliding along, the joint's origin can reach.
  void becomeBall(double travel) {
    radius += std::max(a.norm(), b.norm()) + travel;
    a.setZero();
    b.setZero();
  }
};

void add(MotionBound& bound, int q_index, double reach) {
  for (auto& entry : bound) {
    if (entry.first == q_index) {
      entry.second += reach;
      return;
    }
  }
  bound.emplace_back(q_index, reach);
}

}  // namespace

MotionBound motionBound(const RobotModel& model, int link, int ancestor, const ShapeBounds& bounds, const Pose& X_LS) {
  MotionBound out;
  Swept swept{X_LS * bounds.a, X_LS * bounds.b, bounds.radius};
  while (link != ancestor && link >= 0) {
    const int j = model.links()[static_cast<std::size_t>(link)].parent_joint;
    if (j < 0) break;
    const Joint& joint = model.joints()[static_cast<std::size_t>(j)];
    if (joint.type != JointType::kFixed) {
      const auto [q_index, factor] = driver(model, joint);
      const bool slides = joint.type == JointType::kPrismatic;
      if (q_index >= 0) add(out, q_index, factor * (slides ? 1 : swept.fromAxis(joint.axis)));
      swept.becomeBall(slides ? largestTravel(model, joint) : 0);
    }
    swept.transform(joint.X_PJ);
    link = joint.parent_link;
  }
  return out;
}

int commonAncestor(const RobotModel& model, int a, int b) {
  const auto parent = [&model](int link) {
    const int j = model.links()[static_cast<std::size_t>(link)].parent_joint;
    return j < 0 ? -1 : model.joints()[static_cast<std::size_t>(j)].parent_link;
  };
  std::vector<bool> above(model.links().size(), false);
  for (int link = a; link >= 0; link = parent(link)) above[static_cast<std::size_t>(link)] = true;
  for (int link = b; link >= 0; link = parent(link)) {
    if (above[static_cast<std::size_t>(link)]) return link;
  }
  return -1;
}

}  // namespace longarm::planning
