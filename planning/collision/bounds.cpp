#include "planning/collision/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace longarm::planning {
namespace {

ShapeBounds boxBounds(const Eigen::Vector3d& center, const Eigen::Vector3d& half) {
  int axis = 0;
  half.maxCoeff(&axis);
  Eigen::Vector3d cross = half;
  cross[axis] = 0;
  ShapeBounds out;
  out.a = out.b = out.center = center;
  out.a[axis] -= half[axis];
  out.b[axis] += half[axis];
  out.radius = cross.norm();
  out.half = half;
  return out;
}

ShapeBounds meshBounds(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return {};
  Eigen::Vector3d low = mesh.vertices[0], high = low;
  for (const auto& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  ShapeBounds out = boxBounds(0.5 * (low + high), 0.5 * (high - low));
  // The capsule's radius from the vertices themselves; its axis pulled in by as much.
  double radius = 0;
  const Eigen::Vector3d d = out.b - out.a;
  const double length2 = d.squaredNorm();
  for (const auto& v : mesh.vertices) {
    const double t = length2 > 0 ? std::clamp((v - out.a).dot(d) / length2, 0.0, 1.0) : 0.0;
    radius = std::max(radius, (out.a + t * d - v).norm());
  }
  out.radius = radius;
  return out;
}

// Lower bound of the distance of a capsule from a box: gaps along the box's own axes.
double capsuleBox(const PlacedBounds& capsule, const PlacedBounds& box) {
  const Eigen::Vector3d p = box.R.transpose() * (capsule.a - box.center);
  const Eigen::Vector3d q = box.R.transpose() * (capsule.b - box.center);
  const Eigen::Vector3d above = p.cwiseMin(q) - box.half;
  const Eigen::Vector3d below = -p.cwiseMax(q) - box.half;
  return above.cwiseMax(below).cwiseMax(0.0).norm() - capsule.radius;
}

}  // namespace

ShapeBounds boundsOf(const Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return boxBounds(Eigen::Vector3d::Zero(), 0.5 * box->size);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    ShapeBounds out;
    out.radius = sphere->radius;
    out.half.setConstant(sphere->radius);
    return out;
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    ShapeBounds out;
    out.half = {cylinder->radius, cylinder->radius, 0.5 * cylinder->length};
    if (cylinder->length >= 2 * cylinder->radius) {
      out.a = {0, 0, -0.5 * cylinder->length};
      out.b = -out.a;
      out.radius = cylinder->radius;
    } else {
      out.radius = std::hypot(cylinder->radius, 0.5 * cylinder->length);
    }
    return out;
  }
  const auto& mesh = std::get<std::shared_ptr<const TriangleMesh>>(shape);
  return mesh ? meshBounds(*mesh) : ShapeBounds{};
}

PlacedBounds place(const ShapeBounds& bounds, const Pose& X) {
  return {X * bounds.a, X * bounds.b, bounds.radius, X * bounds.center, bounds.half, X.linear()};
}

double squaredDistance(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1, const Eigen::Vector3d& b0,
                       const Eigen::Vector3d& b1) {
  const Eigen::Vector3d d1 = a1 - a0, d2 = b1 - b0, r = a0 - b0;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), c = d1.dot(r), f = d2.dot(r);
  constexpr double kPoint = 1e-18;
  double s = 0, t = 0;
  if (a <= kPoint && e <= kPoint) return r.squaredNorm();
  if (a <= kPoint) {
    t = std::clamp(f / e, 0.0, 1.0);
  } else if (e <= kPoint) {
    s = std::clamp(-c / a, 0.0, 1.0);
  } else {
    const double b = d1.dot(d2);
    const double denominator = a * e - b * b;
    if (denominator > 1e-12 * a * e) s = std::clamp((b * f - c * e) / denominator, 0.0, 1.0);
    t = (b * s + f) / e;
    if (t < 0) {
      t = 0;
      s = std::clamp(-c / a, 0.0, 1.0);
    } else if (t > 1) {
      t = 1;
      s = std::clamp((b - c) / a, 0.0, 1.0);
    }
  }
  return (r + s * d1 - t * d2).squaredNorm();
}

double distanceBound(const PlacedBounds& first, const PlacedBounds& second) {
  const double capsules =
      std::sqrt(squaredDistance(first.a, first.b, second.a, second.b)) - first.radius - second.radius;
  return std::max({capsules, capsuleBox(first, second), capsuleBox(second, first)});
}

bool insideMesh(const TriangleMesh& mesh, const Eigen::Vector3d& p) {
  // A direction that no edge of a modelled part is likely to lie along.
  const Eigen::Vector3d ray = Eigen::Vector3d(0.5773, 0.2113, 0.7887).normalized();
  bool inside = false;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d& v0 = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3d e1 = mesh.vertices[static_cast<std::size_t>(t[1])] - v0;
    const Eigen::Vector3d e2 = mesh.vertices[static_cast<std::size_t>(t[2])] - v0;
    const Eigen::Vector3d h = ray.cross(e2);
    const double det = e1.dot(h);
    if (std::abs(det) < 1e-18) continue;
    const Eigen::Vector3d s = p - v0;
    const double u = s.dot(h) / det;
    if (u < 0 || u > 1) continue;
    const Eigen::Vector3d k = s.cross(e1);
    const double v = ray.dot(k) / det;
    if (v < 0 || u + v > 1) continue;
    if (e2.dot(k) / det > 0) inside = !inside;
  }
  return inside;
}

}  // namespace longarm::planning
