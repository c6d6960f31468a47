#include "app/virtual_robot/shape_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace longarm::virtual_robot {
namespace {

using Eigen::Vector3d;
using planning::boundingRadius;
using planning::Box;
using planning::Cylinder;
using planning::rayDistance;
using planning::Sphere;
using planning::TriangleMesh;
using MeshPtr = std::shared_ptr<const TriangleMesh>;

constexpr int kMaxCells = 160;           // per edge of a surface
constexpr double kFallStep = 0.003;      // between two rays [m]
constexpr double kStartAbove = 0.002;    // rays start this far inside, so that a touching pair is seen [m]

int cells(double length, double step) {
  return std::clamp(static_cast<int>(std::ceil(length / step)), 1, kMaxCells);
}

void addBox(const Box& box, double step, std::vector<Vector3d>& out) {
  const Vector3d half = box.size / 2;
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const int na = cells(box.size[a], step), nb = cells(box.size[b], step);
    for (int i = 0; i <= na; ++i) {
      for (int j = 0; j <= nb; ++j) {
        Vector3d p;
        p[a] = half[a] * (2.0 * i / na - 1);
        p[b] = half[b] * (2.0 * j / nb - 1);
        for (const double side : {-1.0, 1.0}) {
          p[axis] = side * half[axis];
          out.push_back(p);
        }
      }
    }
  }
}

void addCylinder(const Cylinder& c, double step, std::vector<Vector3d>& out) {
  const int around = std::max(96, cells(2 * M_PI * c.radius, step)), along = cells(c.length, step);
  const int rings = cells(c.radius, step);
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * M_PI * i / around;
    const Vector3d rim(c.radius * std::cos(angle), c.radius * std::sin(angle), 0);
    for (int k = 0; k <= along; ++k) out.push_back(rim + Vector3d(0, 0, c.length * (1.0 * k / along - 0.5)));
    for (int k = 0; k < rings; ++k) {
      for (const double side : {-0.5, 0.5}) out.push_back(rim * k / rings + Vector3d(0, 0, side * c.length));
    }
  }
}

void addSphere(const Sphere& s, double step, std::vector<Vector3d>& out) {
  const int n = std::clamp(static_cast<int>(4 * M_PI * s.radius * s.radius / (step * step)), 200, 20000);
  for (int i = 0; i < n; ++i) {
    const double z = 1 - 2 * (i + 0.5) / n, r = std::sqrt(1 - z * z), angle = i * M_PI * (3 - std::sqrt(5.0));
    out.push_back(s.radius * Vector3d(r * std::cos(angle), r * std::sin(angle), z));
  }
}

void addMesh(const TriangleMesh& mesh, double step, std::vector<Vector3d>& out) {
  out.insert(out.end(), mesh.vertices.begin(), mesh.vertices.end());
  for (const auto& t : mesh.triangles) {
    const Vector3d& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Vector3d ab = mesh.vertices[static_cast<std::size_t>(t[1])] - a;
    const Vector3d ac = mesh.vertices[static_cast<std::size_t>(t[2])] - a;
    const int n = cells(std::max(ab.norm(), ac.norm()), step);
    if (out.size() > 200000) return;
    for (int i = 0; i <= n; ++i) {
      for (int j = 0; i + j <= n; ++j) out.push_back(a + ab * i / n + ac * j / n);
    }
  }
}

// Least way of rays from the points (in the frame of `pose`) to `target`, those that can reach it.
double leastWay(const std::vector<Vector3d>& points, const Pose& pose, const planning::WorldObject& target,
                const Vector3d& direction, double best) {
  const double radius = boundingRadius(target.shape);
  const Vector3d center = target.X_WO.translation();
  for (const Vector3d& local : points) {
    const Vector3d p = pose * local;
    if ((p - center).head<2>().norm() > radius) continue;
    const auto way = rayDistance(target.shape, target.X_WO, p - kStartAbove * direction, direction);
    if (way) best = std::min(best, std::max(0.0, *way - kStartAbove));
  }
  return best;
}

}  // namespace

std::vector<Vector3d> surfacePoints(const planning::Shape& shape, double step_m) {
  std::vector<Vector3d> out;
  if (const auto* box = std::get_if<Box>(&shape)) addBox(*box, step_m, out);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) addCylinder(*cylinder, step_m, out);
  if (const auto* sphere = std::get_if<Sphere>(&shape)) addSphere(*sphere, step_m, out);
  if (const auto* mesh = std::get_if<MeshPtr>(&shape); mesh != nullptr && *mesh) addMesh(**mesh, step_m, out);
  return out;
}

double fallDistance(const planning::WorldObject& body, const std::vector<planning::WorldObject>& others,
                    double ground_z) {
  const Vector3d down(0, 0, -1);
  const auto points = surfacePoints(body.shape, kFallStep);
  double best = std::numeric_limits<double>::infinity();
  for (const Vector3d& p : points) best = std::min(best, std::max(0.0, (body.X_WO * p).z() - ground_z));
  const double reach = boundingRadius(body.shape);
  for (const auto& other : others) {
    if (!other.collides) continue;
    const double apart = (other.X_WO.translation() - body.X_WO.translation()).head<2>().norm();
    if (apart > reach + boundingRadius(other.shape)) continue;
    best = leastWay(points, body.X_WO, other, down, best);
    best = leastWay(surfacePoints(other.shape, kFallStep), other.X_WO, body, -down, best);
  }
  return std::isfinite(best) ? best : 0;
}

}  // namespace longarm::virtual_robot
