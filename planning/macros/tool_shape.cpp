#include "planning/macros/tool_shape.h"

#include <algorithm>

#include "planning/collision/body_distance.h"
#include "planning/collision/bounds.h"

namespace longarm::planning {
namespace {

constexpr double kInside = 0.002;        // model errors [m]
constexpr double kPoint = 5e-4;          // radius of a point that FCL can handle [m]

// Furthest way of a bounded shape along a direction, both in one frame.
double supportOf(const ShapeBounds& bounds, const Pose& X, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d local = X.linear().transpose() * direction;
  const double box = local.dot(bounds.center) + local.cwiseAbs().dot(bounds.half);
  const double capsule = std::max(local.dot(bounds.a), local.dot(bounds.b)) + bounds.radius;
  return direction.dot(X.translation()) + std::min(box, capsule);
}

int tipOf(const Workcell& workcell) { return workcell.model->linkIndex(workcell.arm.tip_link).valueOr(workcell.model->rootLink()); }

}  // namespace

bool beyondArm(const Workcell& workcell, int link) {
  const RobotModel& model = *workcell.model;
  while (link >= 0) {
    const int joint = model.links()[static_cast<std::size_t>(link)].parent_joint;
    if (joint < 0) return false;
    if (joint == workcell.arm.joints.back()) return true;
    link = model.joints()[static_cast<std::size_t>(joint)].parent_link;
  }
  return false;
}

std::vector<std::string> toolLinks(const Workcell& workcell) {
  if (workcell.gripper && !workcell.gripper->links.empty()) return workcell.gripper->links;
  std::vector<std::string> names;
  const auto& links = workcell.model->links();
  for (std::size_t i = 0; i < links.size(); ++i) {
    if (beyondArm(workcell, static_cast<int>(i))) names.push_back(links[i].name);
  }
  return names;
}

double toolOverhang(const Workcell& workcell, const Eigen::VectorXd& q) {
  const RobotModel& model = *workcell.model;
  const Pose X_TR = model.forward(q, tipOf(workcell)).inverse();
  double most = 0;
  for (const auto& name : toolLinks(workcell)) {
    const auto link = model.linkIndex(name);
    if (!link) continue;
    const Pose X_TL = X_TR * model.forward(q, *link);
    for (const auto& shape : model.links()[static_cast<std::size_t>(*link)].collisions) {
      most = std::max(most, supportOf(boundsOf(shape.shape), X_TL * shape.X_LS, Eigen::Vector3d::UnitZ()));
    }
  }
  return most;
}

double heldBelow(const PlanContext& context, const Eigen::Vector3d& down) {
  const RobotModel& model = *context.workcell->model;
  const Eigen::Vector3d tool = model.forward(context.start, tipOf(*context.workcell)).translation();
  double most = 0;
  for (const auto& object : context.objects) {
    const auto link = object.attached_link.empty() ? Result<int>(ErrorCode::kNotFound, "") : model.linkIndex(object.attached_link);
    if (!link || !beyondArm(*context.workcell, *link)) continue;
    const Pose X = model.forward(context.start, *link) * object.X_WO;
    most = std::max(most, supportOf(boundsOf(object.shape), X, down) - down.dot(tool));
  }
  return most;
}

std::vector<std::string> objectsNear(const PlanContext& context, const Eigen::Vector3d& p, double distance) {
  WorldObject here;
  here.shape = Sphere{kPoint};
  here.X_WO.translation() = p;
  std::vector<std::string> names;
  for (const auto* list : {&context.workcell->objects, &context.objects}) {
    for (const auto& object : *list) {
      if (!object.standsInTheWay()) continue;
      if (bodyDistance(here, object, distance + kPoint) < distance) names.push_back(object.name);
    }
  }
  return names;
}

std::vector<std::string> objectsThrough(const PlanContext& context, const Eigen::Vector3d& p) {
  return objectsNear(context, p, kInside);
}

}  // namespace longarm::planning
