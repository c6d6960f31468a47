#include "planning/collision/body_distance.h"

#include <algorithm>

#include "planning/collision/bounds.h"
#include "planning/collision/fcl_shapes.h"

namespace longarm::planning {
namespace {

bool holds(const WorldObject& outer, const WorldObject& inner) {
  const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&outer.shape);
  if (mesh == nullptr || *mesh == nullptr) return false;
  const auto* other = std::get_if<std::shared_ptr<const TriangleMesh>>(&inner.shape);
  const bool from_mesh = other != nullptr && *other != nullptr && !(*other)->vertices.empty();
  const Eigen::Vector3d p = from_mesh ? (*other)->vertices.front() : boundsOf(inner.shape).center;
  return insideMesh(**mesh, outer.X_WO.inverse() * (inner.X_WO * p));
}

}  // namespace

double bodyDistance(const WorldObject& a, const WorldObject& b, double cap) {
  if (distanceBound(place(boundsOf(a.shape), a.X_WO), place(boundsOf(b.shape), b.X_WO)) >= cap) return cap;
  const internal::FclGeometry first = internal::toFcl(a.shape), second = internal::toFcl(b.shape);
  if (!first || !second) return cap;
  const double distance = std::min(cap, internal::fclDistance(*first, a.X_WO, *second, b.X_WO, cap));
  return distance > 0 && (holds(a, b) || holds(b, a)) ? 0 : distance;
}

}  // namespace longarm::planning
