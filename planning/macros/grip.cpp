#include "planning/macros/grip.h"

#include <algorithm>
#include <optional>

#include "planning/collision/body_distance.h"
#include "planning/collision/bounds.h"
#include "planning/macros/tool_shape.h"

namespace longarm::planning {
namespace {

constexpr double kHeldDistance = 0.003;  // of a finger from what it holds, model errors included [m]
constexpr double kSupportDistance = 0.004;   // [m]
constexpr double kOffStop = 1e-3;        // of the finger joint from open and shut [m or rad]
constexpr double kEdge = 0.003;          // [m]
constexpr double kThinnest = 1e-3;       // [m]

struct HandShape {
  int link;
  WorldObject body;                      // in the root frame
};

std::vector<HandShape> gripperShapes(const Workcell& workcell, const Eigen::VectorXd& q) {
  std::vector<HandShape> out;
  const RobotModel& model = *workcell.model;
  for (const auto& name : workcell.gripper->links) {
    const auto link = model.linkIndex(name);
    if (!link) continue;
    for (const auto& shape : model.links()[static_cast<std::size_t>(*link)].collisions) {
      WorldObject body;
      body.name = name;
      body.shape = shape.shape;
      body.X_WO = model.forward(q, *link) * shape.X_LS;
      out.push_back({*link, std::move(body)});
    }
  }
  return out;
}

int fingerIndex(const Workcell& workcell) {
  const auto joint = workcell.model->jointIndex(workcell.gripper->joint);
  return joint ? workcell.model->joints()[static_cast<std::size_t>(*joint)].q_index : -1;
}

Pose tipPose(const Workcell& workcell, const Eigen::VectorXd& q) {
  const RobotModel& model = *workcell.model;
  return model.forward(q, model.linkIndex(workcell.arm.tip_link).valueOr(model.rootLink()));
}

// Gripper links that the finger joint moves against the tool.
std::vector<int> fingers(const Workcell& workcell, const Eigen::VectorXd& q, int index) {
  const RobotModel& model = *workcell.model;
  Eigen::VectorXd moved = q;
  moved[index] += kOffStop;
  std::vector<int> out;
  for (const auto& name : workcell.gripper->links) {
    const auto link = model.linkIndex(name);
    if (!link) continue;
    const Pose before = tipPose(workcell, q).inverse() * model.forward(q, *link);
    const Pose after = tipPose(workcell, moved).inverse() * model.forward(moved, *link);
    if (!before.isApprox(after, 1e-9)) out.push_back(*link);
  }
  return out;
}

// The room between two fingers: a box in the tool frame.
std::optional<WorldObject> roomBetween(const Pose& X_RT, const std::vector<HandShape>& shapes, int first, int second) {
  Eigen::AlignedBox3d boxes[2];
  for (const auto& shape : shapes) {
    if (shape.link != first && shape.link != second) continue;
    const ShapeBounds bounds = boundsOf(shape.body.shape);
    const Pose X_TS = X_RT.inverse() * shape.body.X_WO;
    const Eigen::Vector3d half = X_TS.linear().cwiseAbs() * bounds.half, center = X_TS * bounds.center;
    Eigen::AlignedBox3d& box = boxes[shape.link == first ? 0 : 1];
    box.extend(center - half);
    box.extend(center + half);
  }
  if (boxes[0].isEmpty() || boxes[1].isEmpty()) return {};
  int axis = 0;
  (boxes[1].center() - boxes[0].center()).cwiseAbs().maxCoeff(&axis);
  if (boxes[1].center()[axis] < boxes[0].center()[axis]) std::swap(boxes[0], boxes[1]);
  Eigen::AlignedBox3d room = boxes[0].intersection(boxes[1]);
  room.min().array() += kEdge;           // what lies before the fingertips is not between them
  room.max().array() -= kEdge;
  room.min()[axis] = boxes[0].max()[axis];
  room.max()[axis] = boxes[1].min()[axis];
  if (room.sizes().minCoeff() < kThinnest) return {};
  WorldObject out;
  out.shape = Box{room.sizes()};
  out.X_WO = X_RT * Eigen::Translation3d(room.center());
  return out;
}

bool halfOpen(const Workcell& workcell, double joint) {
  const auto [low, high] = std::minmax(workcell.gripper->open, workcell.gripper->closed);
  return joint > low + kOffStop && joint < high - kOffStop;
}

double linkDistance(const std::vector<HandShape>& shapes, int link, const WorldObject& object) {
  double least = 2 * kHeldDistance;      // further away does not matter
  for (const auto& shape : shapes) {
    if (link < 0 || shape.link == link) least = std::min(least, bodyDistance(shape.body, object, least));
  }
  return least;
}

bool heldBy(const std::vector<HandShape>& shapes, const std::vector<int>& links, const Pose& X_RT, const WorldObject& object) {
  for (std::size_t i = 0; i < links.size(); ++i) {
    for (std::size_t j = i + 1; j < links.size(); ++j) {
      if (linkDistance(shapes, links[i], object) > kHeldDistance || linkDistance(shapes, links[j], object) > kHeldDistance) continue;
      const auto room = roomBetween(X_RT, shapes, links[i], links[j]);
      if (room && bodyDistance(*room, object, kHeldDistance) <= 0) return true;
    }
  }
  return false;
}

}  // namespace

Grip gripAt(const Workcell& workcell, const std::vector<WorldObject>& objects, const Eigen::VectorXd& q,
            const std::vector<std::string>& known) {
  Grip grip;
  if (!workcell.gripper) return grip;
  const std::vector<HandShape> shapes = gripperShapes(workcell, q);
  const int index = fingerIndex(workcell);
  const bool half_open = index >= 0 && halfOpen(workcell, q[index]);
  const std::vector<int> links = half_open ? fingers(workcell, q, index) : std::vector<int>{};
  const auto stays = [](const WorldObject& object) { return object.standsInTheWay(); };
  const auto is_known = [&](const WorldObject& object) {
    return half_open && std::find(known.begin(), known.end(), object.name) != known.end();
  };
  for (const auto& object : objects) {
    if (!stays(object)) continue;
    if (is_known(object) || heldBy(shapes, links, tipPose(workcell, q), object)) grip.held.push_back(object.name);
    else if (linkDistance(shapes, -1, object) <= 0) grip.touched.push_back(object.name);
  }
  const auto held = [&](const WorldObject& object) { return std::find(grip.held.begin(), grip.held.end(), object.name) != grip.held.end(); };
  for (const auto& object : objects) {
    for (const auto& below : objects) {
      if (!stays(object) || !stays(below) || !held(object) || held(below)) continue;
      if (bodyDistance(object, below, 2 * kSupportDistance) <= kSupportDistance) grip.supports.emplace_back(object.name, below.name);
    }
  }
  return grip;
}

std::vector<WorldObject> withHeldAttached(const Workcell& workcell, std::vector<WorldObject> objects, const Grip& grip,
                                          const Eigen::VectorXd& q) {
  for (auto& object : objects) {
    if (!object.attached_link.empty() || std::find(grip.held.begin(), grip.held.end(), object.name) == grip.held.end()) continue;
    object.attached_link = workcell.arm.tip_link;
    object.X_WO = tipPose(workcell, q).inverse() * object.X_WO;
  }
  return objects;
}

void allowGrip(CollisionWorld& world, const Workcell& workcell, const std::vector<WorldObject>& objects, const Grip& grip) {
  if (!workcell.gripper) return;
  for (const auto& object : objects) {
    const auto link = workcell.model->linkIndex(object.attached_link);
    if (link && beyondArm(workcell, *link)) world.allow(object.name, workcell.gripper->links);
  }
  for (const auto& [held, below] : grip.supports) world.allow(held, {below});
}

}  // namespace longarm::planning
