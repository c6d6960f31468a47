#include "planning/world/shape_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace longarm::planning {
namespace {

using Eigen::Vector3d;
using MeshPtr = std::shared_ptr<const TriangleMesh>;

std::optional<double> hitBox(const Box& box, const Vector3d& o, const Vector3d& d) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const double half = box.size[k] / 2;
    if (std::abs(d[k]) < 1e-12) {
      if (std::abs(o[k]) > half) return {};
      continue;
    }
    const double a = (-half - o[k]) / d[k], b = (half - o[k]) / d[k];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (enter > leave) return {};
  return enter;
}

std::optional<double> hitCylinder(const Cylinder& c, const Vector3d& o, const Vector3d& d) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  const double half = c.length / 2;
  if (std::abs(d.z()) < 1e-12) {
    if (std::abs(o.z()) > half) return {};
  } else {
    const double a = (-half - o.z()) / d.z(), b = (half - o.z()) / d.z();
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  const double qa = d.head<2>().squaredNorm(), qb = o.head<2>().dot(d.head<2>());
  const double qc = o.head<2>().squaredNorm() - c.radius * c.radius;
  if (qa < 1e-12) {
    if (qc > 0) return {};
  } else {
    const double root = qb * qb - qa * qc;
    if (root < 0) return {};
    enter = std::max(enter, (-qb - std::sqrt(root)) / qa);
    leave = std::min(leave, (-qb + std::sqrt(root)) / qa);
  }
  if (enter > leave) return {};
  return enter;
}

std::optional<double> hitSphere(const Sphere& s, const Vector3d& o, const Vector3d& d) {
  const double b = o.dot(d), c = o.squaredNorm() - s.radius * s.radius;
  if (c <= 0) return 0.0;
  const double root = b * b - c;
  if (root < 0 || b > 0) return {};
  return -b - std::sqrt(root);
}

// Moeller and Trumbore, "Fast, minimum storage ray-triangle intersection", 1997.
std::optional<double> hitMesh(const TriangleMesh& mesh, const Vector3d& o, const Vector3d& d) {
  std::optional<double> best;
  for (const auto& t : mesh.triangles) {
    const Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Vector3d ab = mesh.vertices[static_cast<std::size_t>(t[1])] - a;
    const Vector3d ac = mesh.vertices[static_cast<std::size_t>(t[2])] - a;
    const Vector3d p = d.cross(ac);
    const double det = ab.dot(p);
    if (std::abs(det) < 1e-18) continue;
    const Vector3d s = o - a;
    const double u = s.dot(p) / det;
    const Vector3d q = s.cross(ab);
    const double v = d.dot(q) / det, w = ac.dot(q) / det;
    if (u < 0 || v < 0 || u + v > 1 || w < 0) continue;
    if (!best || w < *best) best = w;
  }
  return best;
}

}  // namespace

std::optional<double> rayDistance(const Shape& shape, const Pose& pose, const Vector3d& origin,
                                  const Vector3d& direction) {
  const Vector3d o = pose.inverse() * origin, d = pose.linear().transpose() * direction;
  if (const auto* box = std::get_if<Box>(&shape)) return hitBox(*box, o, d);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return hitCylinder(*cylinder, o, d);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return hitSphere(*sphere, o, d);
  const auto& mesh = std::get<MeshPtr>(shape);
  return mesh ? hitMesh(*mesh, o, d) : std::nullopt;
}

double boundingRadius(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return box->size.norm() / 2;
  if (const auto* c = std::get_if<Cylinder>(&shape)) return std::hypot(c->radius, c->length / 2);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  double radius = 0;
  const auto& mesh = std::get<MeshPtr>(shape);
  if (mesh) {
    for (const auto& v : mesh->vertices) radius = std::max(radius, v.norm());
  }
  return radius;
}

}  // namespace longarm::planning
