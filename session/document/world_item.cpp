#include "session/document/world_item.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "core/text.h"
#include "planning/world/zone.h"
#include "vision/sketch/solids.h"

namespace longarm::session {

using Eigen::Vector3d;

namespace {

constexpr double kMostMargin_m = 0.1;
constexpr double kNormal95 = 1.959963984540054;
const Eigen::Vector4d kColour{0.72, 0.55, 0.95, 0.55};
constexpr double kBelowBase_m = 0.5;     // a workspace as offered reaches this far below the arm's base

bool sameBits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

template <typename A, typename B>
bool sameBits(const A& a, const B& b) {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (!sameBits(a(i), b(i))) return false;
  }
  return true;
}

Result<WorldItem> boxFrom(const vision::Feature& feature, WorldItem item) {
  if (!feature.box || !feature.box->is_box) {
    return Error{ErrorCode::kInvalidInput, "'" + feature.name + "' has no right angles: mark the corner of a box, or add its faces as planes."};
  }
  item.kind = WorldKind::kBox;
  item.X_WO = feature.box->X_WB;
  item.size = feature.box->size;
  return item;
}

// The rectangle around the parallelogram, its first edge along the first one marked.
Result<WorldItem> slabFrom(const vision::Feature& feature, WorldItem item) {
  const auto& plane = *feature.plane;
  const Vector3d x = (plane.corners[0] - plane.corners[1]).normalized(), z = plane.normal, y = z.cross(x);
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  Eigen::Matrix3d R;
  R << x, y, z;
  for (const auto& corner : plane.corners) {
    const Vector3d p = R.transpose() * (corner - plane.center);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  item.kind = WorldKind::kSlab;
  item.size = {high.x() - low.x(), high.y() - low.y(), kSlabThickness_m};
  item.X_WO.linear() = R;
  Vector3d middle = (low + high) / 2;
  middle.z() = -kSlabThickness_m / 2;
  item.X_WO.translation() = plane.center + R * middle;
  return item;
}

Result<WorldItem> pipeFrom(const vision::Feature& feature, WorldItem item) {
  if (!feature.pipe) {
    return Error{ErrorCode::kInvalidInput, "'" + feature.name + "' is a line without thickness: mark it with the pipe tool, which measures its radius."};
  }
  item.kind = WorldKind::kPipe;
  item.size = {2 * feature.pipe->radius, 2 * feature.pipe->radius, feature.length()};
  item.X_WO = vision::pipePose(feature);
  item.margin_m = std::min(item.margin_m + kNormal95 * feature.pipe->radius_sigma, kMostMargin_m);
  return item;
}

vision::OverlayRole overlayRole(WorldRole role) {
  if (role == WorldRole::kKeepOut) return vision::OverlayRole::kKeepOut;
  return role == WorldRole::kWorkspace ? vision::OverlayRole::kWorkspace : vision::OverlayRole::kWorld;
}

planning::BodyRole bodyRole(WorldRole role) {
  if (role == WorldRole::kKeepOut) return planning::BodyRole::kKeepOut;
  return role == WorldRole::kWorkspace ? planning::BodyRole::kKeepIn : planning::BodyRole::kSolid;
}

// All but shape and pose.
planning::WorldObject plainBody(const WorldItem& item) {
  planning::WorldObject body;
  body.name = item.name;
  body.role = bodyRole(item.role);
  body.rgba = body.role == planning::BodyRole::kSolid ? kColour : planning::zoneColour(body.role);
  body.collides = item.role != WorldRole::kDrawn;
  return body;
}

planning::WorldObject bodyOf(const WorldItem& item, double grown) {
  planning::WorldObject body = plainBody(item);
  body.X_WO = item.X_WO;
  if (item.kind == WorldKind::kPipe) {
    body.shape = planning::Cylinder{item.size.x() / 2 + grown, item.size.z() + 2 * grown};
  } else {
    body.shape = planning::Box{item.size + Vector3d::Constant(2 * grown)};
  }
  return body;
}

planning::Shape grownBy(const planning::Shape& shape, double grown) {
  if (const auto* box = std::get_if<planning::Box>(&shape)) return planning::Box{box->size + Vector3d::Constant(2 * grown)};
  if (const auto* c = std::get_if<planning::Cylinder>(&shape)) return planning::Cylinder{c->radius + grown, c->length + 2 * grown};
  if (const auto* s = std::get_if<planning::Sphere>(&shape)) return planning::Sphere{s->radius + grown};
  return shape;
}

std::vector<planning::WorldObject> partsOf(const WorldItem& item, double grown, bool without_moving) {
  std::vector<planning::WorldObject> bodies;
  for (const auto& part : item.parts) {
    if (without_moving && part.moves) continue;
    planning::WorldObject body = plainBody(item);
    body.name = item.name + "." + part.name;
    body.shape = grownBy(part.shape, grown);
    body.X_WO = item.X_WO * part.X_TP;
    bodies.push_back(std::move(body));
  }
  return bodies;
}

bool sameParts(const planning::TemplatePart& a, const planning::TemplatePart& b) {
  if (a.name != b.name || a.moves != b.moves || a.shape.index() != b.shape.index()) return false;
  if (!sameBits(a.X_TP.matrix().reshaped(), b.X_TP.matrix().reshaped())) return false;
  if (const auto* box = std::get_if<planning::Box>(&a.shape)) return sameBits(box->size, std::get<planning::Box>(b.shape).size);
  if (const auto* s = std::get_if<planning::Sphere>(&a.shape)) return sameBits(s->radius, std::get<planning::Sphere>(b.shape).radius);
  const auto &c = std::get<planning::Cylinder>(a.shape), &d = std::get<planning::Cylinder>(b.shape);
  return sameBits(c.radius, d.radius) && sameBits(c.length, d.length);
}

bool sameTemplate(const WorldItem& a, const WorldItem& b) {
  return a.template_name == b.template_name &&
         std::equal(a.parameters.begin(), a.parameters.end(), b.parameters.begin(), b.parameters.end(),
                    [](const auto& x, const auto& y) { return x.first == y.first && sameBits(x.second, y.second); }) &&
         std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), sameParts);
}

}  // namespace

double marginOf(const vision::Feature& feature) {
  double worst = 0;
  for (const auto& vertex : feature.vertices) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(vertex.covariance, Eigen::EigenvaluesOnly);
    worst = std::max(worst, kNormal95 * std::sqrt(std::max(0.0, axes.eigenvalues()(2))));
  }
  return std::min(worst, kMostMargin_m);
}

const char* toString(WorldKind kind) {
  switch (kind) {
    case WorldKind::kBox: return "box";
    case WorldKind::kSlab: return "slab";
    case WorldKind::kPipe: return "pipe";
    case WorldKind::kPoints: return "points";
    case WorldKind::kTemplate: return "template";
  }
  return "box";
}

std::optional<WorldKind> worldKindFrom(const std::string& word) {
  for (const WorldKind kind : {WorldKind::kBox, WorldKind::kSlab, WorldKind::kPipe, WorldKind::kPoints, WorldKind::kTemplate}) {
    if (word == toString(kind)) return kind;
  }
  return std::nullopt;
}

const char* toString(WorldRole role) {
  switch (role) {
    case WorldRole::kObstacle: return "obstacle";
    case WorldRole::kDrawn: return "drawn";
    case WorldRole::kKeepOut: return "keep_out";
    case WorldRole::kWorkspace: return "workspace";
  }
  return "obstacle";
}

std::optional<WorldRole> worldRoleFrom(const std::string& word) {
  for (const WorldRole role : {WorldRole::kObstacle, WorldRole::kDrawn, WorldRole::kKeepOut, WorldRole::kWorkspace}) {
    if (word == toString(role)) return role;
  }
  return std::nullopt;
}

namespace {

bool sameBase(const std::optional<BaseState>& a, const std::optional<BaseState>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return sameBits(a->x, b->x) && sameBits(a->y, b->y) && sameBits(a->yaw, b->yaw);
}

}  // namespace

bool operator==(const WorldItem& a, const WorldItem& b) {
  if (a.points.size() != b.points.size()) return false;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (!sameBits(a.points[i], b.points[i])) return false;
  }
  return a.id == b.id && a.kind == b.kind && a.name == b.name && a.parent == b.parent &&
         sameBits(a.X_WO.matrix().reshaped(), b.X_WO.matrix().reshaped()) && sameBits(a.size, b.size) &&
         sameBits(a.margin_m, b.margin_m) && a.hidden == b.hidden && a.role == b.role && a.source == b.source &&
         sameTemplate(a, b) && sameBase(a.base, b.base);
}

std::uint64_t hashOf(const WorldItem& item) {
  std::uint64_t hash = item.id.value;
  const auto mix = [&hash](std::uint64_t value) {
    hash = (hash ^ value) * 1099511628211ULL;
    hash ^= hash >> 29;
  };
  const auto mixNumber = [&mix](double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    mix(bits);
  };
  mix(static_cast<std::uint64_t>(item.kind));
  mix(std::hash<std::string>()(item.name));
  mix(std::hash<std::string>()(item.parent));
  for (int i = 0; i < 16; ++i) mixNumber(item.X_WO.matrix().data()[i]);
  for (int i = 0; i < 3; ++i) mixNumber(item.size(i));
  for (const auto& point : item.points) {
    for (int i = 0; i < 3; ++i) mixNumber(point(i));
  }
  mix(std::hash<std::string>()(item.template_name));
  for (const auto& [name, value] : item.parameters) {
    mix(std::hash<std::string>()(name));
    mixNumber(value);
  }
  mixNumber(item.margin_m);
  mix((item.hidden ? 1U : 0U) | (static_cast<std::uint64_t>(item.role) << 1U));
  mix(item.source.value);
  if (item.base) {
    for (const double value : {item.base->x, item.base->y, item.base->yaw}) mixNumber(value);
  }
  return hash;
}

Result<WorldItem> worldItemFrom(const vision::Feature& feature) {
  WorldItem item;
  item.name = feature.name;
  item.parent = feature.parent;
  item.margin_m = marginOf(feature);
  auto made = [&]() -> Result<WorldItem> {
    switch (feature.kind) {
      case vision::FeatureKind::kPoint: return worldPointsFrom({feature});
      case vision::FeatureKind::kLine: return pipeFrom(feature, item);
      case vision::FeatureKind::kPlane: return slabFrom(feature, item);
      case vision::FeatureKind::kTriad: return boxFrom(feature, item);
    }
    return item;
  }();
  if (!made) return made;
  if (const Status checked = checkWorldItem(*made); !checked) return checked.error();
  return made;
}

WorldItem worldPointsFrom(const std::vector<vision::Feature>& points) {
  WorldItem item;
  item.kind = WorldKind::kPoints;
  item.name = points.front().name;
  item.parent = points.front().parent;
  item.size.setConstant(kPointDiameter_m);
  for (const auto& point : points) {
    item.points.push_back(point.vertices.front().xyz);
    item.margin_m = std::max(item.margin_m, marginOf(point));
  }
  return item;
}

Status checkWorldItem(const WorldItem& item) {
  const auto fail = [&](const std::string& what) { return Status{ErrorCode::kInvalidInput, "'" + item.name + "': " + what}; };
  const bool is_template = item.kind == WorldKind::kTemplate;
  if (is_template == item.parts.empty()) return fail("it has no parts, or parts and no template.");
  for (int i = 0; !is_template && i < 3; ++i) {
    if (item.size(i) >= kLeastSize_m && item.size(i) <= kMostSize_m) continue;
    return fail("a size of " + formatNumber(item.size(i)) + " m is outside " + formatNumber(kLeastSize_m) + " to " +
                formatNumber(kMostSize_m) + " m.");
  }
  if (!(item.margin_m >= 0 && item.margin_m <= 1)) {
    return fail("a margin of " + formatNumber(item.margin_m) + " m is outside 0 to 1 m.");
  }
  if (item.role == WorldRole::kWorkspace && item.kind != WorldKind::kBox) {
    return fail(std::string("a ") + toString(item.kind) + " cannot be a workspace: mark a box, or make it a keep-out zone.");
  }
  if (item.role == WorldRole::kWorkspace && item.size.minCoeff() <= 2 * item.margin_m) {
    return fail("its margin of " + formatNumber(item.margin_m) + " m leaves nothing of the workspace.");
  }
  if (!item.X_WO.matrix().allFinite()) return fail("its pose is not finite.");
  if ((item.kind == WorldKind::kPoints) == item.points.empty()) return fail("it has no points, or points and a body.");
  for (const auto& point : item.points) {
    if (!point.allFinite()) return fail("a point is not finite.");
  }
  return {};
}

std::vector<planning::WorldObject> bodiesOf(const WorldItem& item, bool with_margin) {
  const double grown = with_margin ? (item.role == WorldRole::kWorkspace ? -item.margin_m : item.margin_m) : 0;
  if (item.kind == WorldKind::kTemplate) return partsOf(item, grown, false);
  if (item.kind != WorldKind::kPoints) return {bodyOf(item, grown)};
  std::vector<planning::WorldObject> bodies;
  for (std::size_t i = 0; i < item.points.size(); ++i) {
    planning::WorldObject body = plainBody(item);
    if (item.points.size() > 1) body.name += " " + std::to_string(i + 1);
    body.shape = planning::Sphere{item.size.x() / 2 + grown};
    body.X_WO.translation() = item.points[i];
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<planning::WorldObject> obstaclesOf(const std::vector<WorldItem>& items, const std::string& frame, FeatureId skip,
                                               WorldItemId carried) {
  std::vector<planning::WorldObject> all;
  for (const auto& item : items) {
    const bool handled = skip.valid() && item.source == skip && item.role == WorldRole::kObstacle;
    if (item.role == WorldRole::kDrawn || item.parent != frame || handled) continue;
    const bool goes_along = carried.valid() && item.id == carried;
    for (auto& body : goes_along ? partsOf(item, item.margin_m, true) : bodiesOf(item, true)) all.push_back(std::move(body));
  }
  return all;
}

WorldItem workspaceAround(const Vector3d& base, double reach_m, const std::string& frame) {
  WorldItem item;
  item.name = "Workspace";
  item.parent = frame;
  item.role = WorldRole::kWorkspace;
  item.size = {2 * reach_m, 2 * reach_m, reach_m + kBelowBase_m};
  item.X_WO.translation() = base + Vector3d(0, 0, (reach_m - kBelowBase_m) / 2);
  return item;
}

void addWorldItem(const WorldItem& item, const vision::View& view, vision::Overlay* overlay) {
  if (item.hidden || item.parent != view.parent) return;
  vision::SolidLook look;
  look.role = overlayRole(item.role);
  look.filled = item.role != WorldRole::kWorkspace;   // everything is inside
  for (const auto& point : item.points) vision::addSphere(point, item.size.x() / 2, view, look, overlay);
  if (item.kind == WorldKind::kPoints) return;
  for (const auto& body : partsOf(item, 0, false)) {
    if (const auto* box = std::get_if<planning::Box>(&body.shape)) vision::addBox(body.X_WO, box->size, view, look, overlay);
    if (const auto* c = std::get_if<planning::Cylinder>(&body.shape)) vision::addCylinder(body.X_WO, c->radius, c->length, view, look, overlay);
    if (const auto* s = std::get_if<planning::Sphere>(&body.shape)) vision::addSphere(body.X_WO.translation(), s->radius, view, look, overlay);
  }
  if (item.kind == WorldKind::kTemplate) return;
  if (item.kind == WorldKind::kPipe) vision::addCylinder(item.X_WO, item.size.x() / 2, item.size.z(), view, look, overlay);
  else vision::addBox(item.X_WO, item.size, view, look, overlay);
}

}  // namespace longarm::session
