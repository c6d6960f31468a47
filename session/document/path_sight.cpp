#include "session/document/path_sight.h"

#include <algorithm>

#include "planning/world/shape_rays.h"
#include "session/document/standing_items.h"

namespace longarm::session {
namespace {

using planning::WorldObject;

constexpr double kBefore_m = 0.005;

bool between(const WorldObject& body, const Eigen::Vector3d& eye, const Eigen::Vector3d& direction, double distance) {
  const Eigen::Vector3d middle = body.X_WO.translation() - eye;
  const double along = std::clamp(middle.dot(direction), 0.0, distance);
  if ((middle - along * direction).norm() > planning::boundingRadius(body.shape)) return false;
  const auto hit = planning::rayDistance(body.shape, body.X_WO, eye, direction);
  return hit && *hit > 0 && *hit < distance - kBefore_m;
}

}  // namespace

std::vector<WorldObject> bodiesInSight(const Document& document, const std::string& frame) {
  std::vector<WorldObject> bodies;
  const auto& workcell = document.workcell();
  const auto* model = workcell ? workcell->model.get() : nullptr;
  if (model != nullptr && model->links()[static_cast<std::size_t>(model->rootLink())].name == frame) {
    for (const auto& object : workcell->objects) {
      if (object.standsInTheWay()) bodies.push_back(object);
    }
  }
  for (const auto& item : standingItems(document)) {
    const bool thing = item.role == WorldRole::kObstacle || item.role == WorldRole::kDrawn;
    if (!thing || item.hidden || item.parent != frame) continue;
    for (auto& body : bodiesOf(item, false)) bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<bool> hiddenBehind(const std::vector<WorldObject>& bodies, const Eigen::Vector3d& eye,
                               const std::vector<Eigen::Vector3d>& points) {
  std::vector<bool> hidden;
  for (const auto& point : points) {
    const double distance = (point - eye).norm();
    const Eigen::Vector3d direction = (point - eye) / std::max(distance, 1e-9);
    hidden.push_back(std::any_of(bodies.begin(), bodies.end(),
                                 [&](const WorldObject& body) { return between(body, eye, direction, distance); }));
  }
  return hidden;
}

}  // namespace longarm::session
