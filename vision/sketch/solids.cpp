#include "vision/sketch/solids.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vision/stereo/project_polyline.h"

namespace longarm::vision {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Line = std::vector<Vector3d>;

constexpr int kCircle = 48;
constexpr int kAlong = 9;                    // points along an edge, for the hull of a bent one

double cross(const Vector2d& o, const Vector2d& a, const Vector2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

Line circle(const Pose& X, double radius, double z) {
  Line line;
  for (int i = 0; i <= kCircle; ++i) {
    const double angle = 2 * M_PI * (i % kCircle) / kCircle;
    line.push_back(X * Vector3d(radius * std::cos(angle), radius * std::sin(angle), z));
  }
  return line;
}

// A solid that reaches behind the camera has no outline that a hull of what is seen would give.
std::vector<Vector2d> covered(const std::vector<Line>& lines, const View& view) {
  std::vector<Vector2d> pixels;
  for (const auto& line : lines) {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const int pieces = i == 0 || line.size() > 4 ? 1 : kAlong;
      for (int k = 1; k <= pieces; ++k) {
        const Vector3d p = i == 0 ? line[0] : Vector3d(line[i - 1] + (line[i] - line[i - 1]) * k / pieces);
        const auto pixel = view.project(p);
        if (!pixel) return {};
        pixels.push_back(*pixel);
      }
    }
  }
  return convexHull(std::move(pixels));
}

void addLines(const std::vector<Line>& lines, const View& view, const SolidLook& look, Overlay* overlay) {
  if (look.filled) {
    auto area = covered(lines, view);
    if (area.size() > 2) overlay->shapes.push_back({OverlayShape::Kind::kArea, look.role, std::move(area), {}, look.colour_rgb});
  }
  for (const auto& line : lines) {
    for (auto& piece : projectPolyline(view, line)) {
      overlay->shapes.push_back({OverlayShape::Kind::kPolyline, look.role, std::move(piece), {}, look.colour_rgb});
    }
  }
}

}  // namespace

std::vector<Vector2d> convexHull(std::vector<Vector2d> points) {
  // Andrew's monotone chain (Information Processing Letters 9(5), 1979).
  std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vector2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const auto& p : points) {
      while (hull.size() >= base + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

void addBox(const Pose& X_WB, const Vector3d& size, const View& view, const SolidLook& look, Overlay* overlay) {
  std::vector<Line> lines;
  const Vector3d half = size / 2;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-1.0, 1.0}) {
        Vector3d from = half;
        from((axis + 1) % 3) *= a;
        from((axis + 2) % 3) *= b;
        Vector3d to = from;
        to(axis) = -to(axis);
        lines.push_back({X_WB * from, X_WB * to});
      }
    }
  }
  addLines(lines, view, look, overlay);
}

void addCylinder(const Pose& X_WC, double radius, double length, const View& view, const SolidLook& look, Overlay* overlay) {
  std::vector<Line> lines{circle(X_WC, radius, -length / 2), circle(X_WC, radius, length / 2)};
  const Vector3d eye = X_WC.inverse() * view.X_WC.translation();
  const double away = eye.head<2>().norm();
  if (away > radius) {
    const double towards = std::atan2(eye.y(), eye.x()), turn = std::acos(radius / away);
    for (const double angle : {towards - turn, towards + turn}) {
      const Vector3d side(radius * std::cos(angle), radius * std::sin(angle), 0);
      lines.push_back({X_WC * (side - Vector3d(0, 0, length / 2)), X_WC * (side + Vector3d(0, 0, length / 2))});
    }
  }
  addLines(lines, view, look, overlay);
}

void addSphere(const Vector3d& centre_W, double radius, const View& view, const SolidLook& look, Overlay* overlay) {
  const Vector3d to_eye = view.X_WC.translation() - centre_W;
  const double away = to_eye.norm();
  if (away <= radius) return;
  // Tangents from the eye touch the sphere on a circle that lies this far towards it.
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), to_eye).toRotationMatrix();
  X.translation() = centre_W;
  const double towards = radius * radius / away;
  addLines({circle(X, std::sqrt(radius * radius - towards * towards), towards)}, view, look, overlay);
}

}  // namespace longarm::vision
