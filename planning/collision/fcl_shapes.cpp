#include "planning/collision/fcl_shapes.h"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

namespace longarm::planning::internal {
namespace {

constexpr double kSmallest = 1e-4;
// Closer than this, collide() is asked as well: the two solvers disagree about touching shapes.
constexpr double kNearlyTouching = 1e-3;

bool usable(double size) { return std::isfinite(size) && size >= kSmallest; }

FclGeometry meshToFcl(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  const auto count = static_cast<int>(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const bool in_range = std::all_of(t.begin(), t.end(), [count](int i) { return i >= 0 && i < count; });
    if (in_range) {
      triangles.emplace_back(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(t[1]),
                             static_cast<std::size_t>(t[2]));
    }
  }
  if (triangles.empty()) return nullptr;
  auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSS<double>>>();
  model->beginModel();
  model->addSubModel(mesh.vertices, triangles);
  model->endModel();
  return model;
}

FclGeometry convert(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) {
    if (!usable(box->size.minCoeff()) || !box->size.allFinite()) return nullptr;
    return std::make_shared<fcl::Box<double>>(box->size);
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    if (!usable(cylinder->radius) || !usable(cylinder->length)) return nullptr;
    return std::make_shared<fcl::Cylinder<double>>(cylinder->radius, cylinder->length);
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    if (!usable(sphere->radius)) return nullptr;
    return std::make_shared<fcl::Sphere<double>>(sphere->radius);
  }
  const auto& mesh = std::get<std::shared_ptr<const TriangleMesh>>(shape);
  return mesh ? meshToFcl(*mesh) : nullptr;
}

}  // namespace

FclGeometry toFcl(const Shape& shape) {
  FclGeometry geometry = convert(shape);
  if (geometry) geometry->computeLocalAABB();
  return geometry;
}

bool fclTouch(const fcl::CollisionGeometry<double>& a, const Pose& X_A, const fcl::CollisionGeometry<double>& b,
              const Pose& X_B) {
  fcl::CollisionRequest<double> request(1, false);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::CollisionResult<double> result;
  try {
    fcl::collide(&a, X_A, &b, X_B, request, result);
  } catch (const std::exception&) {
    return true;
  }
  return result.isCollision();
}

double fclDistance(const fcl::CollisionGeometry<double>& a, const Pose& X_A, const fcl::CollisionGeometry<double>& b,
                   const Pose& X_B, double cap) {
  fcl::DistanceRequest<double> request(false);
  request.gjk_solver_type = fcl::GST_LIBCCD;
  fcl::DistanceResult<double> result;
  result.min_distance = cap;             // prunes the trees of meshes
  double distance = 0;
  try {
    distance = fcl::distance(&a, X_A, &b, X_B, request, result);
    distance = std::min(distance, result.min_distance);
  } catch (const std::exception&) {
    return 0;
  }
  if (!(distance > 0)) return 0;         // not a number as well
  if (distance < kNearlyTouching && fclTouch(a, X_A, b, X_B)) return 0;
  return distance;
}

}  // namespace longarm::planning::internal
