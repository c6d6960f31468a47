#include "planning/world/zone.h"

#include <algorithm>

namespace longarm::planning {
namespace {

constexpr double kThick = 5;             // further out than any arm reaches [m]

}  // namespace

std::vector<WorldObject> barriersOf(const WorldObject& object) {
  if (object.role != BodyRole::kKeepIn) return {object};
  const auto* box = std::get_if<Box>(&object.shape);
  if (box == nullptr) return {};
  std::vector<WorldObject> walls;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      WorldObject wall = object;
      Eigen::Vector3d size = box->size + Eigen::Vector3d::Constant(2 * kThick);
      size(axis) = kThick;
      wall.shape = Box{size};
      wall.X_WO = object.X_WO * Eigen::Translation3d(side * (box->size(axis) + kThick) / 2 * Eigen::Vector3d::Unit(axis));
      walls.push_back(std::move(wall));
    }
  }
  return walls;
}

bool movedByArm(const Workcell& workcell, int link) {
  const RobotModel& model = *workcell.model;
  const auto& arm = workcell.arm.joints;
  while (link >= 0) {
    const int joint = model.links()[static_cast<std::size_t>(link)].parent_joint;
    if (joint < 0) return false;
    if (std::find(arm.begin(), arm.end(), joint) != arm.end()) return true;
    link = model.joints()[static_cast<std::size_t>(joint)].parent_link;
  }
  return false;
}

Eigen::Vector4d zoneColour(BodyRole role) {
  return role == BodyRole::kKeepOut ? Eigen::Vector4d(0.95, 0.25, 0.2, 0.3) : Eigen::Vector4d(0.35, 0.75, 1, 0.08);
}

std::string meetingWords(BodyRole role, const std::string& name) {
  switch (role) {
    case BodyRole::kSolid: break;
    case BodyRole::kKeepOut: return "is inside the keep-out zone " + name;
    case BodyRole::kKeepIn: return "is outside the workspace " + name;
  }
  return "touches " + name;
}

}  // namespace longarm::planning
