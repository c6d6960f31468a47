#include "session/calibration/known_geometry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <variant>

#include "planning/world/shape_rays.h"

namespace longarm::session {

namespace {

using Eigen::Vector3d;
using planning::Box;
using planning::Cylinder;
using planning::TriangleMesh;
using Segment = KnownGeometry::Segment;

constexpr double kSharp_rad = 25 * 3.14159265358979323846 / 180;
constexpr double kTurn_rad = 40 * 3.14159265358979323846 / 180;   // Where an edge turns further, there is a corner.
constexpr int kRim = 48;                   // Chords of a cylinder's rim.
constexpr double kHousing_m = 0.03;
constexpr double kWeld_m = 1e-5;
constexpr double kCornerSigma_m = 0.0005, kEdgeSigma_m = 0.001, kSurfaceSigma_m = 0.002;

struct Features {
  std::vector<Vector3d> corners;
  std::vector<Segment> edges;
};

Features featuresOf(const Box& box) {
  Features out;
  for (int i = 0; i < 8; ++i) {
    const auto corner = [&](int k) { return Vector3d((k & 1) != 0 ? 0.5 : -0.5, (k & 2) != 0 ? 0.5 : -0.5, (k & 4) != 0 ? 0.5 : -0.5).cwiseProduct(box.size).eval(); };
    out.corners.push_back(corner(i));
    for (const int bit : {1, 2, 4}) {
      if ((i & bit) == 0) out.edges.emplace_back(corner(i), corner(i | bit));
    }
  }
  return out;
}

Features featuresOf(const Cylinder& cylinder) {
  Features out;
  for (const double z : {-cylinder.length / 2, cylinder.length / 2}) {
    const auto at = [&](int k) {
      const double angle = 2 * 3.14159265358979323846 * k / kRim;
      return Vector3d(cylinder.radius * std::cos(angle), cylinder.radius * std::sin(angle), z);
    };
    for (int k = 0; k < kRim; ++k) out.edges.emplace_back(at(k), at(k + 1));
  }
  return out;
}

/// The mesh's sharp edges between welded vertices.
class MeshFeatures {
 public:
  explicit MeshFeatures(const TriangleMesh& mesh) : m_mesh(mesh) {
    for (const auto& v : mesh.vertices) m_welded.push_back(indexOf(v));
    for (const auto& t : mesh.triangles) addTriangle(t);
  }
  Features take() const {
    Features out;
    std::map<int, std::vector<Vector3d>> directions;
    for (const auto& [edge, normals] : m_edges) {
      if (!isSharp(normals)) continue;
      const Vector3d &a = m_places[static_cast<std::size_t>(edge.first)], &b = m_places[static_cast<std::size_t>(edge.second)];
      out.edges.emplace_back(a, b);
      directions[edge.first].push_back((b - a).normalized());
      directions[edge.second].push_back((a - b).normalized());
    }
    for (const auto& [vertex, out_of] : directions) {
      if (isCorner(out_of)) out.corners.push_back(m_places[static_cast<std::size_t>(vertex)]);
    }
    return out;
  }

 private:
  int indexOf(const Vector3d& v) {
    const std::array<long long, 3> key = {std::llround(v.x() / kWeld_m), std::llround(v.y() / kWeld_m), std::llround(v.z() / kWeld_m)};
    const auto [at, fresh] = m_known.emplace(key, static_cast<int>(m_places.size()));
    if (fresh) m_places.push_back(v);
    return at->second;
  }
  void addTriangle(const std::array<int, 3>& triangle) {
    std::array<int, 3> v{};
    for (std::size_t i = 0; i < 3; ++i) v[i] = m_welded[static_cast<std::size_t>(triangle[i])];
    const auto at = [&](int i) { return m_places[static_cast<std::size_t>(i)]; };
    const Vector3d normal = (at(v[1]) - at(v[0])).cross(at(v[2]) - at(v[0]));
    if (normal.norm() < 1e-14) return;
    for (std::size_t i = 0; i < 3; ++i) m_edges[std::minmax(v[i], v[(i + 1) % 3])].push_back(normal.normalized());
  }
  static bool isSharp(const std::vector<Vector3d>& normals) {
    return normals.size() != 2 || normals[0].dot(normals[1]) < std::cos(kSharp_rad);
  }
  static bool isCorner(const std::vector<Vector3d>& out_of) { return out_of.size() != 2 || out_of[0].dot(out_of[1]) > -std::cos(kTurn_rad); }

  const TriangleMesh& m_mesh;
  std::map<std::array<long long, 3>, int> m_known;
  std::vector<Vector3d> m_places;
  std::vector<int> m_welded;
  std::map<std::pair<int, int>, std::vector<Vector3d>> m_edges;
};

Features featuresOf(const planning::Shape& shape) {
  if (const auto* box = std::get_if<Box>(&shape)) return featuresOf(*box);
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return featuresOf(*cylinder);
  if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&shape); mesh != nullptr && *mesh) return MeshFeatures(**mesh).take();
  return {};
}

// The place of a segment nearest to a ray.
Vector3d nearestOn(const Segment& segment, const Vector3d& from, const Vector3d& along) {
  const Vector3d d = segment.second - segment.first, w = segment.first - from;
  const Vector3d across = d - d.dot(along) * along, off = w - w.dot(along) * along;
  const double length2 = across.squaredNorm();
  const double s = length2 > 1e-18 ? std::clamp(-across.dot(off) / length2, 0.0, 1.0) : 0;
  return segment.first + s * d;
}

// Angle between the ray and the way to a place; nothing behind.
std::optional<double> angleTo(const Vector3d& from, const Vector3d& along, const Vector3d& place) {
  const Vector3d way = place - from;
  const double forward = way.dot(along);
  if (forward <= 0) return std::nullopt;
  return std::atan2((way - forward * along).norm(), forward);
}

}  // namespace

const char* toString(GeometryPoint::Kind kind) {
  switch (kind) {
    case GeometryPoint::Kind::kCorner: return "corner";
    case GeometryPoint::Kind::kEdge: return "edge";
    case GeometryPoint::Kind::kSurface: return "surface";
  }
  return "";
}

struct KnownGeometry::Sight {
  std::vector<Pose> X_WO;                  // of every body
  Vector3d from;
};

KnownGeometry::KnownGeometry(std::shared_ptr<const planning::Workcell> workcell, const std::vector<WorldItem>& sketched) : m_workcell(std::move(workcell)) {
  if (!m_workcell || !m_workcell->model) return;
  for (const auto& object : m_workcell->objects) add(object.name, object.attached_link, object.X_WO, object.shape);
  for (const auto& link : m_workcell->model->links()) {
    for (const auto& shape : link.visuals.empty() ? link.collisions : link.visuals) add(link.name, link.name, shape.X_LS, shape.shape);
  }
  const auto& root = m_workcell->model->links()[static_cast<std::size_t>(m_workcell->model->rootLink())].name;
  for (const auto& item : sketched) {
    const bool is_body = item.role == WorldRole::kObstacle || item.role == WorldRole::kDrawn;   // zones have no surface
    if (!is_body || item.hidden || (!item.parent.empty() && item.parent != root)) continue;
    for (const auto& body : bodiesOf(item, false)) add(item.name, {}, body.X_WO, body.shape);
  }
}

void KnownGeometry::add(const std::string& thing, const std::string& link, const Pose& X_LO, const planning::Shape& shape) {
  Body body;
  body.thing = thing;
  body.link = link;
  body.X_LO = X_LO;
  body.shape = shape;
  body.radius = planning::boundingRadius(shape);
  Features features = featuresOf(shape);
  body.corners = std::move(features.corners);
  body.edges = std::move(features.edges);
  m_bodies.push_back(std::move(body));
}

void KnownGeometry::place(const std::string& object, const Pose& X_WO) {
  if (!m_workcell) return;
  // Objects come first, in the order of the workcell.
  for (std::size_t i = 0; i < m_workcell->objects.size() && i < m_bodies.size(); ++i) {
    if (m_workcell->objects[i].name == object) m_bodies[i].X_LO = X_WO;
  }
}

std::vector<Pose> KnownGeometry::places(const Eigen::VectorXd& q) const {
  std::vector<Pose> X_WL, out;
  if (!m_bodies.empty()) m_workcell->model->forward(q, X_WL);
  for (const auto& body : m_bodies) {
    const auto link = body.link.empty() ? Result<int>(m_workcell->model->rootLink()) : m_workcell->model->linkIndex(body.link);
    out.push_back(link ? X_WL[static_cast<std::size_t>(*link)] * body.X_LO : body.X_LO);
  }
  return out;
}

std::optional<std::pair<std::size_t, double>> KnownGeometry::firstHit(const Sight& sight, const Vector3d& along) const {
  std::optional<std::pair<std::size_t, double>> first;
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    const Vector3d middle = sight.X_WO[i].translation() - sight.from;
    const double forward = middle.dot(along), radius = m_bodies[i].radius;
    if ((middle - forward * along).norm() > radius || forward < -radius || (first && forward - radius > first->second)) continue;
    const auto at = planning::rayDistance(m_bodies[i].shape, sight.X_WO[i], sight.from, along);
    if (at && *at > kHousing_m && (!first || *at < first->second)) first = {i, *at};
  }
  return first;
}

bool KnownGeometry::inSight(const Sight& sight, const Vector3d& p_W) const {
  const Vector3d way = p_W - sight.from;
  const double distance = way.norm();
  const auto hit = firstHit(sight, way / distance);
  return !hit || hit->second > distance - std::max(0.002, 0.003 * distance);
}

std::optional<GeometryPoint> KnownGeometry::pointOn(const Vector3d& from, const Vector3d& along, double snap_rad, const Eigen::VectorXd& q, const Serves& serves) const {
  const Sight sight{places(q), from};
  struct Candidate {
    GeometryPoint::Kind kind;
    double angle;
    std::size_t body;
    Vector3d p_W;
  };
  std::vector<Candidate> near;
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    const Body& body = m_bodies[i];
    if (!serves(body.thing, body.link)) continue;
    const auto consider = [&](GeometryPoint::Kind kind, const Vector3d& p_W) {
      const auto angle = angleTo(from, along, p_W);
      if (angle && *angle <= snap_rad) near.push_back({kind, *angle, i, p_W});
    };
    for (const auto& corner : body.corners) consider(GeometryPoint::Kind::kCorner, sight.X_WO[i] * corner);
    for (const auto& edge : body.edges) consider(GeometryPoint::Kind::kEdge, nearestOn({sight.X_WO[i] * edge.first, sight.X_WO[i] * edge.second}, from, along));
  }
  std::stable_sort(near.begin(), near.end(), [](const Candidate& a, const Candidate& b) { return std::tie(a.kind, a.angle) < std::tie(b.kind, b.angle); });
  const auto found = [&](GeometryPoint::Kind kind, std::size_t i, const Vector3d& p_W) {
    GeometryPoint out;
    out.kind = kind;
    out.distance_m = (p_W - from).norm();
    out.landmark.thing = m_bodies[i].thing;
    out.landmark.link = m_bodies[i].link;
    out.landmark.X_LO = m_bodies[i].X_LO;
    out.landmark.xyz = sight.X_WO[i].inverse() * p_W;
    out.landmark.sigma_m = kind == GeometryPoint::Kind::kCorner ? kCornerSigma_m : kind == GeometryPoint::Kind::kEdge ? kEdgeSigma_m : kSurfaceSigma_m;
    return out;
  };
  for (const auto& candidate : near) {
    if (inSight(sight, candidate.p_W)) return found(candidate.kind, candidate.body, candidate.p_W);
  }
  const auto hit = firstHit(sight, along);
  if (!hit || !serves(m_bodies[hit->first].thing, m_bodies[hit->first].link)) return std::nullopt;
  return found(GeometryPoint::Kind::kSurface, hit->first, from + hit->second * along);
}

std::vector<Segment> KnownGeometry::edges(const Eigen::VectorXd& q, const Serves& serves) const {
  const auto X_WO = places(q);
  std::vector<Segment> out;
  for (std::size_t i = 0; i < m_bodies.size(); ++i) {
    if (!serves(m_bodies[i].thing, m_bodies[i].link)) continue;
    for (const auto& edge : m_bodies[i].edges) out.emplace_back(X_WO[i] * edge.first, X_WO[i] * edge.second);
  }
  return out;
}

}  // namespace longarm::session
