#include "planning/collision/convex.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace longarm::planning::internal {
namespace {

using Eigen::Vector3d;

constexpr int kIterations = 48;
constexpr double kSmallest = 1e-4;       // [m]
constexpr double kConverged = 1e-9;      // between the two bounds [m]
constexpr double kGivenUp = 1e-6;        // ... where they come no nearer
constexpr double kCoarse = 0.9;
constexpr double kFlat = 1e-12;          // of a tetrahedron's volume, against its size

// Furthest point of the core along d.
Vector3d support(const Convex& body, const Pose& X, const Vector3d& d) {
  if (body.kind == Convex::Kind::kPoint) return X.translation();
  const Vector3d local = X.linear().transpose() * d;
  Vector3d p = body.half;
  if (local.z() < 0) p.z() = -p.z();
  if (body.kind == Convex::Kind::kBox) {
    if (local.x() < 0) p.x() = -p.x();
    if (local.y() < 0) p.y() = -p.y();
  } else {
    const double level = std::sqrt(local.x() * local.x() + local.y() * local.y());
    const double scale = level > 0 ? body.half.x() / level : 0;
    p.x() = scale * local.x();
    p.y() = scale * local.y();
  }
  return X.linear() * p + X.translation();
}

// Up to four points of the difference of two bodies.
struct Simplex {
  Vector3d points[4];
  int count = 0;

  void keep(int a) { points[0] = points[a], count = 1; }
  void keep(int a, int b) {
    const Vector3d p = points[a], q = points[b];
    points[0] = p, points[1] = q, count = 2;
  }
  void keep(int a, int b, int c) {
    const Vector3d p = points[a], q = points[b], r = points[c];
    points[0] = p, points[1] = q, points[2] = r, count = 3;
  }
};

// Point nearest the origin, and which corners it lies between (bits).
struct Nearest {
  Vector3d point = Vector3d::Zero();
  unsigned corners = 0;
};

Nearest onSegment(const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double t = -a.dot(ab), whole = ab.squaredNorm();
  if (t <= 0 || whole <= 0) return {a, 1};
  if (t >= whole) return {b, 2};
  return {a + t / whole * ab, 3};
}

// Ericson, "Real-Time Collision Detection", 2005, 5.1.5, for the origin.
Nearest onTriangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return {a, 1};
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return {b, 2};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, 3};
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return {c, 4};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, 5};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 6};
  const double sum = va + vb + vc;
  if (sum <= 0) {                        // no area: its edges
    const Nearest sides[3] = {onSegment(a, b), onSegment(a, c), onSegment(b, c)};
    const unsigned bits[3][4] = {{0, 1, 2, 3}, {0, 1, 4, 5}, {0, 2, 4, 6}};
    int best = 0;
    for (int i = 1; i < 3; ++i) {
      if (sides[i].point.squaredNorm() < sides[best].point.squaredNorm()) best = i;
    }
    return {sides[best].point, bits[best][sides[best].corners]};
  }
  return {a + (vb / sum) * ab + (vc / sum) * ac, 7};
}

// Reduces the simplex to the corners that the nearest point lies between.  @returns whether it holds the origin.
bool reduce(Simplex& s, Vector3d& v) {
  const auto keepBits = [&s](const Nearest& nearest, int a, int b, int c) {
    const int corner[3] = {a, b, c};
    int kept[3], n = 0;
    for (int i = 0; i < 3; ++i) {
      if (nearest.corners & (1U << i)) kept[n++] = corner[i];
    }
    if (n == 1) s.keep(kept[0]);
    else if (n == 2) s.keep(kept[0], kept[1]);
    else s.keep(kept[0], kept[1], kept[2]);
  };
  if (s.count == 1) {
    v = s.points[0];
    return false;
  }
  if (s.count == 2) {
    const Nearest nearest = onSegment(s.points[0], s.points[1]);
    v = nearest.point;
    keepBits(nearest, 0, 1, 1);
    return false;
  }
  if (s.count == 3) {
    const Nearest nearest = onTriangle(s.points[0], s.points[1], s.points[2]);
    v = nearest.point;
    keepBits(nearest, 0, 1, 2);
    return false;
  }
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};
  Nearest best;
  int face = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i) {
    const Vector3d &a = s.points[kFaces[i][0]], &b = s.points[kFaces[i][1]], &c = s.points[kFaces[i][2]], &d = s.points[kFaces[i][3]];
    const Vector3d normal = (b - a).cross(c - a);
    const double origin = -normal.dot(a), other = normal.dot(d - a);
    const bool flat = std::abs(other) <= kFlat * normal.norm() * (d - a).norm();
    if (!flat && origin * other >= 0) continue;          // on the inner side of this face
    const Nearest nearest = onTriangle(a, b, c);
    const double distance = nearest.point.squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = nearest;
    face = i;
  }
  if (face < 0) return true;
  v = best.point;
  keepBits(best, kFaces[face][0], kFaces[face][1], kFaces[face][2]);
  return false;
}

struct Bounds {
  double low = 0, high = std::numeric_limits<double>::infinity();   // of the distance of the cores
};

// When to stop narrowing.
struct Goal {
  double enough;                         // low has reached this
  double little;                         // high has come down to this
  double above = std::numeric_limits<double>::infinity();   // low is above this, and ...
  double share = 1;                      // ... this share of high
};

// Narrows the bounds until the goal is met, or they meet.
Bounds narrow(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, const Goal& goal, Vector3d* axis) {
  Bounds bounds;
  Simplex simplex;
  Vector3d v = axis != nullptr ? *axis : Vector3d(X_A.translation() - X_B.translation());
  if (v.squaredNorm() < 1e-24) v = Vector3d::UnitX();
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kIterations; ++i) {
    const Vector3d w = support(a, X_A, -v) - support(b, X_B, v);
    const double low = v.dot(w) / v.norm();
    if (low > bounds.low) {
      bounds.low = low;
      if (axis != nullptr) *axis = v;
    }
    if (bounds.low >= goal.enough || bounds.high - bounds.low <= kConverged) return bounds;
    if (bounds.low > goal.above && bounds.low >= goal.share * bounds.high) return bounds;
    simplex.points[simplex.count++] = w;
    if (reduce(simplex, v)) {
      bounds.high = 0;
      return bounds;
    }
    const double distance = v.norm();
    bounds.high = std::min(bounds.high, distance);
    if (distance <= goal.little || distance < kConverged) return bounds;
    if (distance >= before * (1 - 1e-14)) return bounds;       // no nearer any more
    before = distance;
  }
  return bounds;
}

}  // namespace

std::optional<Convex> convexOf(const Shape& shape) {
  const auto usable = [](double size) { return std::isfinite(size) && size >= kSmallest; };
  Convex out;
  if (const auto* box = std::get_if<Box>(&shape)) {
    if (!box->size.allFinite() || !usable(box->size.minCoeff())) return std::nullopt;
    out.kind = Convex::Kind::kBox;
    out.half = 0.5 * box->size;
    return out;
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    if (!usable(cylinder->radius) || !usable(cylinder->length)) return std::nullopt;
    out.kind = Convex::Kind::kCylinder;
    out.half = {cylinder->radius, cylinder->radius, 0.5 * cylinder->length};
    return out;
  }
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    if (!usable(sphere->radius)) return std::nullopt;
    out.margin = sphere->radius;
    return out;
  }
  return std::nullopt;
}

std::optional<double> convexDistance(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, double cap, Vector3d* axis) {
  const double margin = a.margin + b.margin;
  const Bounds bounds = narrow(a, X_A, b, X_B, {cap + margin, margin}, axis);
  if (bounds.high <= margin) return 0.0;
  if (bounds.low >= cap + margin || bounds.high - bounds.low <= kGivenUp) return std::max(0.0, bounds.low - margin);
  return std::nullopt;
}

std::optional<double> convexClearance(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, double cap, double limit,
                                      Vector3d* axis) {
  const double margin = a.margin + b.margin;
  // A share of the cores' distance is a larger one of what the margins leave.
  const bool thin = margin > 0;
  const Goal goal{cap + margin, margin, limit + margin, thin ? 0.99 : kCoarse};
  const Bounds bounds = narrow(a, X_A, b, X_B, goal, axis);
  if (bounds.high <= margin) return 0.0;
  if (bounds.low > limit + margin) return bounds.low - margin;
  if (bounds.high - bounds.low <= kGivenUp) return std::max(0.0, bounds.low - margin);
  return std::nullopt;
}

std::optional<bool> convexWithin(const Convex& a, const Pose& X_A, const Convex& b, const Pose& X_B, double limit) {
  const double margin = a.margin + b.margin + limit;
  const Bounds bounds = narrow(a, X_A, b, X_B, {std::nextafter(margin, 2 * margin + 1), margin}, nullptr);
  if (bounds.high <= margin) return true;
  if (bounds.low > margin) return false;
  if (bounds.high - bounds.low <= kGivenUp) return bounds.low <= margin;
  return std::nullopt;
}

}  // namespace longarm::planning::internal
