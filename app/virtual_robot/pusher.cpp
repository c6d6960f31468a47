#include "app/virtual_robot/pusher.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "app/virtual_robot/shape_rays.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kSpacing = 0.004;       // between points of a link's surface [m]
constexpr double kTogether = 2e-4;       // points that are as deep as the deepest but for this push together [m]
constexpr double kLeast = 1e-7;          // less depth is touching [m]
constexpr double kUpright = 0.999;       // cosine of the lean that still counts as standing
constexpr int kRounds = 4;               // two fingers push in turn

// A standing body seen from above, z up, in its own frame turned so that the vertical axis comes last.
struct Standing {
  Pose X_WS = Pose::Identity();
  Eigen::Vector3d half = Eigen::Vector3d::Zero();  // a cylinder: radius, radius, half its length
  bool round = false;
};

std::optional<Standing> standing(const planning::WorldObject& body) {
  Standing out;
  out.X_WS = body.X_WO;
  if (const auto* cylinder = std::get_if<planning::Cylinder>(&body.shape)) {
    out.half = {cylinder->radius, cylinder->radius, cylinder->length / 2};
    out.round = true;
    if (std::abs(body.X_WO.linear()(2, 2)) < kUpright) return std::nullopt;
    return out;
  }
  const auto* box = std::get_if<planning::Box>(&body.shape);
  if (box == nullptr) return std::nullopt;
  int up = 0;
  if (body.X_WO.linear().row(2).cwiseAbs().maxCoeff(&up) < kUpright) return std::nullopt;
  const int x = (up + 1) % 3, y = (up + 2) % 3;
  const Eigen::Matrix3d R = body.X_WO.linear();
  out.X_WS.linear() << R.col(x), R.col(y), R.col(up);
  out.half = 0.5 * Eigen::Vector3d(box->size[x], box->size[y], box->size[up]);
  return out;
}

// How deep a point lies under the nearest side, and the way out of it for the body; none from above or below.
struct Entry {
  double depth = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), way = Eigen::Vector3d::UnitX();
};

std::optional<Entry> entryOf(const Standing& body, const Eigen::Vector3d& p) {
  Entry out;
  out.point = p;
  const double under = body.half.z() - std::abs(p.z());
  if (under <= 0) return std::nullopt;
  if (body.round) {
    const double r = p.head<2>().norm();
    out.depth = body.half.x() - r;
    if (r > 0) out.way = {-p.x() / r, -p.y() / r, 0};
  } else {
    const Eigen::Vector2d deep = (body.half - p.cwiseAbs()).head<2>();
    const int side = deep.x() < deep.y() ? 0 : 1;
    out.depth = deep[side];
    out.way = Eigen::Vector3d::Zero();
    out.way[side] = p[side] > 0 ? -1 : 1;
  }
  if (out.depth <= kLeast || out.depth > under) return std::nullopt;
  return out;
}

// The deepest points as one.
std::optional<Entry> deepest(const Standing& body, const std::vector<Eigen::Vector3d>& points) {
  std::vector<Entry> entries;
  double most = 0;
  for (const auto& p : points) {
    const auto entry = entryOf(body, p);
    if (!entry) continue;
    most = std::max(most, entry->depth);
    entries.push_back(*entry);
  }
  Entry out;
  out.depth = most;
  int count = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero(), way = Eigen::Vector3d::Zero();
  for (const auto& entry : entries) {
    if (entry.depth < most - kTogether) continue;
    point += entry.point;
    way += entry.way;
    ++count;
  }
  if (count == 0 || way.norm() < 1e-9) return std::nullopt;
  out.point = point / count;
  out.way = way.normalized();
  return out;
}

// Torque over force that friction bears: the mean distance from the middle of an evenly pressed base.
double frictionRadius(const Standing& body) {
  if (body.round) return 2.0 / 3.0 * body.half.x();
  constexpr int kCells = 12;
  double sum = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int k = 0; k < kCells; ++k) sum += std::hypot((i + 0.5) / kCells * body.half.x(), (k + 0.5) / kCells * body.half.y());
  }
  return sum / (kCells * kCells);
}

// Where the body goes when its point of contact is taken along by `entry.way * entry.depth`.
Pose pushed(const Standing& body, const Entry& entry, const Pose& X_WO) {
  const double c = frictionRadius(body), c2 = c * c, x = entry.point.x(), y = entry.point.y();
  const Eigen::Vector2d v = entry.depth * entry.way.head<2>();
  const double whole = c2 + x * x + y * y;
  const double vx = ((c2 + x * x) * v.x() + x * y * v.y()) / whole;
  const double vy = (x * y * v.x() + (c2 + y * y) * v.y()) / whole;
  const Eigen::AngleAxisd turn((x * vy - y * vx) / c2, body.X_WS.linear().col(2));
  Pose out = X_WO;
  out.linear() = (Eigen::Quaterniond(turn) * Eigen::Quaterniond(X_WO.linear())).normalized().toRotationMatrix();   // thousands follow
  out.translation() += body.X_WS.linear() * Eigen::Vector3d(vx, vy, 0);
  return out;
}

}  // namespace

Pusher::Pusher(const planning::Workcell& workcell) : m_workcell(workcell) {
  const auto& model = *workcell.model;
  for (const auto& name : workcell.gripper->links) {
    const auto link = model.linkIndex(name);
    if (!link) continue;
    Part part{*link, {}, 0};
    for (const auto& shape : model.links()[static_cast<std::size_t>(*link)].collisions) {
      for (const auto& p : surfacePoints(shape.shape, kSpacing)) {
        part.points.push_back(shape.X_LS * p);
        part.radius = std::max(part.radius, part.points.back().norm());
      }
    }
    if (!part.points.empty()) m_parts.push_back(std::move(part));
  }
}

void Pusher::step(const Eigen::VectorXd& q, const Pose& X_WB, TrueWorld& world) const {
  for (std::size_t i = 0; i < world.objects().size(); ++i) {
    if (!world.objects()[i].slides || world.held() == i) continue;
    for (int round = 0; round < kRounds; ++round) {
      const auto& object = world.objects()[i].body;
      const auto body = standing(object);
      if (!body) break;
      std::vector<Eigen::Vector3d> points;
      for (const auto& part : m_parts) {
        const Pose X_SL = body->X_WS.inverse() * X_WB * m_workcell.model->forward(q, part.link);
        if (X_SL.translation().norm() > part.radius + body->half.norm()) continue;
        for (const auto& p : part.points) points.push_back(X_SL * p);
      }
      const auto entry = deepest(*body, points);
      if (!entry) break;
      if (!world.slide(i, pushed(*body, *entry, object.X_WO))) break;
    }
  }
}

}  // namespace longarm::virtual_robot
