#include "planning/collision/collision_world.h"

#include <algorithm>
#include <cmath>

#include "core/require.h"
#include "core/text.h"
#include "planning/collision/collision_bodies.h"
#include "planning/world/zone.h"

namespace longarm::planning {

using internal::Body;
using internal::Pair;
using internal::PlacedState;

std::string Contact::sentence() const {
  if (distance <= 0) return first + " " + meetingWords(role, second);
  if (role == BodyRole::kKeepIn) return first + " is " + formatFixed(distance * 1000, 1) + " mm from the edge of the workspace " + second;
  return first + " is " + formatFixed(distance * 1000, 1) + " mm from " + second;
}

void CollisionWorld::Impl::addLinkBodies() {
  for (std::size_t link = 0; link < model->links().size(); ++link) {
    for (const auto& shape : model->links()[link].collisions) {
      Body body;
      body.name = model->links()[link].name;
      body.link = static_cast<int>(link);
      body.X_LS = shape.X_LS;
      body.geometry = internal::toFcl(shape.shape);
      body.bounds = boundsOf(shape.shape);
      if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&shape.shape)) body.mesh = *mesh;
      if (body.geometry) bodies.push_back(std::move(body));
    }
  }
}

void CollisionWorld::Impl::addObjects(const std::vector<WorldObject>& objects) {
  for (const auto& object : objects) {
    if (!object.collides) continue;
    for (const auto& barrier : barriersOf(object)) addObject(barrier);
  }
}

void CollisionWorld::Impl::addObject(const WorldObject& object) {
  Body body;
  body.name = object.name;
  body.object = true;
  body.role = object.role;
  body.X_LS = object.X_WO;
  body.geometry = internal::toFcl(object.shape);
  body.bounds = boundsOf(object.shape);
  if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&object.shape)) body.mesh = *mesh;
  if (!object.attached_link.empty()) body.link = model->linkIndex(object.attached_link).valueOr(-1);
  if (body.geometry) bodies.push_back(std::move(body));
}

// Whether an attached object may touch this link: the carrier, its parent and its children.
bool CollisionWorld::Impl::carriedBy(const Body& object, int link) const {
  if (object.link == link) return true;
  for (const auto& joint : model->joints()) {
    if (joint.parent_link == object.link && joint.child_link == link) return true;
    if (joint.child_link == object.link && joint.parent_link == link) return true;
  }
  return false;
}

void CollisionWorld::Impl::addPairs(const AllowedPairs& allowed) {
  const auto moves = [this](const MotionBound& bound) {
    if (options.moving.empty()) return !bound.empty();
    return std::any_of(bound.begin(), bound.end(), [this](const auto& entry) {
      return std::find(options.moving.begin(), options.moving.end(), entry.first) != options.moving.end();
    });
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      const Body& a = bodies[i];
      const Body& b = bodies[j];
      if (a.link == b.link || (a.link < 0 && b.link < 0)) continue;
      Pair pair;
      pair.a = static_cast<int>(i);
      pair.b = static_cast<int>(j);
      pair.self = a.link >= 0 && b.link >= 0;
      if (a.link >= 0 && b.link >= 0 && !a.object && !b.object) {
        pair.allowed = allowed.count({std::min(a.link, b.link), std::max(a.link, b.link)}) > 0;
      } else if (pair.self) {
        pair.allowed = (a.object && carriedBy(a, b.link)) || (b.object && carriedBy(b, a.link));
      }
      const int meeting = pair.self ? commonAncestor(*model, a.link, b.link) : -1;
      if (a.link >= 0) pair.bound = motionBound(*model, a.link, meeting, a.bounds, a.X_LS);
      if (b.link >= 0) {
        const MotionBound other = motionBound(*model, b.link, meeting, b.bounds, b.X_LS);
        pair.bound.insert(pair.bound.end(), other.begin(), other.end());
      }
      pair.moving = moves(pair.bound);
      pair.zone = a.role != BodyRole::kSolid || b.role != BodyRole::kSolid;
      pairs.push_back(std::move(pair));
    }
  }
}

void CollisionWorld::Impl::placeAll(const Eigen::VectorXd& q, PlacedState& state) const {
  ++counters.states;
  model->forward(q, state.links);
  state.poses.resize(bodies.size());
  state.bounds.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    state.poses[i] = body.link < 0 ? body.X_LS : state.links[static_cast<std::size_t>(body.link)] * body.X_LS;
    state.bounds[i] = place(body.bounds, state.poses[i]);
  }
}

double CollisionWorld::Impl::bound(const Pair& pair, const PlacedState& state) const {
  return distanceBound(state.bounds[static_cast<std::size_t>(pair.a)], state.bounds[static_cast<std::size_t>(pair.b)]);
}

double CollisionWorld::Impl::distance(const Pair& pair, const PlacedState& state, double cap) const {
  ++counters.queries;
  const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
  const double d = internal::fclDistance(*bodies[a].geometry, state.poses[a], *bodies[b].geometry, state.poses[b], cap);
  if (d <= 0 || (!bodies[a].mesh && !bodies[b].mesh) || bound(pair, state) > 0) return d;
  // Surfaces do not meet, yet one may lie wholly inside the other.
  const auto holds = [&](std::size_t outer, std::size_t inner) {
    if (!bodies[outer].mesh) return false;
    const Eigen::Vector3d p = bodies[inner].mesh ? bodies[inner].mesh->vertices.front() : bodies[inner].bounds.center;
    return insideMesh(*bodies[outer].mesh, state.poses[outer].inverse() * (state.poses[inner] * p));
  };
  return holds(a, b) || holds(b, a) ? 0 : d;
}

double CollisionWorld::Impl::leastDistance(const PlacedState& state, bool self, bool world, double cap,
                                           Contact* nearest) const {
  std::vector<std::pair<double, const Pair*>> order;
  for (const auto& pair : pairs) {
    if (!active(pair) || !(pair.self ? self : world)) continue;
    const double low = bound(pair, state);
    if (low < cap) order.emplace_back(low, &pair);
  }
  std::sort(order.begin(), order.end());
  double best = cap;
  for (const auto& [low, pair] : order) {
    if (low >= best) break;
    const double d = distance(*pair, state, best);
    if (d >= best) continue;
    best = d;
    report(*pair, d, nearest);
  }
  return best;
}

void CollisionWorld::Impl::report(const Pair& pair, double d, Contact* contact) const {
  if (contact == nullptr) return;
  const Body* first = &bodies[static_cast<std::size_t>(pair.a)];
  const Body* second = &bodies[static_cast<std::size_t>(pair.b)];
  if (first->role != BodyRole::kSolid) std::swap(first, second);
  *contact = {first->name, second->name, std::max(d, 0.0), second->role};
}

CollisionWorld::CollisionWorld(std::shared_ptr<const RobotModel> model, const std::vector<WorldObject>& objects,
                               const AllowedPairs& allowed, const CollisionOptions& options)
    : m_impl(std::make_unique<Impl>()) {
  LONGARM_REQUIRE(model != nullptr, "collision world needs a robot model");
  m_impl->model = std::move(model);
  m_impl->options = options;
  m_impl->addLinkBodies();
  m_impl->addObjects(objects);
  m_impl->addPairs(allowed);
}

CollisionWorld::~CollisionWorld() = default;

const RobotModel& CollisionWorld::model() const { return *m_impl->model; }
const CollisionWorld::Counters& CollisionWorld::counters() const { return m_impl->counters; }
double CollisionWorld::padding() const { return m_impl->options.padding; }
double CollisionWorld::selfPadding() const { return m_impl->options.self_padding; }

void CollisionWorld::setPadding(double padding, double self_padding) {
  m_impl->options.padding = padding;
  m_impl->options.self_padding = self_padding;
}

void CollisionWorld::allow(const std::string& object, const std::vector<std::string>& others) {
  const auto matches = [&](const Body& first, const Body& second) {
    return first.object && first.name == object && std::find(others.begin(), others.end(), second.name) != others.end();
  };
  for (auto& pair : m_impl->pairs) {
    const Body& a = m_impl->bodies[static_cast<std::size_t>(pair.a)];
    const Body& b = m_impl->bodies[static_cast<std::size_t>(pair.b)];
    if (!pair.zone && (matches(a, b) || matches(b, a))) pair.allowed = true;
  }
}

bool CollisionWorld::inCollision(const Eigen::VectorXd& q, Contact* contact) const {
  m_impl->placeAll(q, m_impl->scratch);
  for (const auto& pair : m_impl->pairs) {
    if (!m_impl->active(pair)) continue;
    const double padding = m_impl->padding(pair);
    if (m_impl->bound(pair, m_impl->scratch) > padding) continue;
    const double d = m_impl->distance(pair, m_impl->scratch, padding + 1e-3);
    if (d > padding) continue;
    m_impl->report(pair, d, contact);
    return true;
  }
  return false;
}

bool CollisionWorld::Impl::anyTouches(const Eigen::VectorXd& q, bool zones_only, Contact* contact) const {
  placeAll(q, scratch);
  for (const auto& pair : pairs) {
    if (pair.zone ? !pair.moving : (pair.allowed || zones_only)) continue;
    if (bound(pair, scratch) > 0 || distance(pair, scratch, 1e-3) > 0) continue;
    report(pair, 0, contact);
    return true;
  }
  return false;
}

bool CollisionWorld::touching(const Eigen::VectorXd& q, Contact* contact) const { return m_impl->anyTouches(q, false, contact); }
bool CollisionWorld::inZone(const Eigen::VectorXd& q, Contact* contact) const { return m_impl->anyTouches(q, true, contact); }

double CollisionWorld::clearance(const Eigen::VectorXd& q, Contact* nearest, double cap) const {
  m_impl->placeAll(q, m_impl->scratch);
  return m_impl->leastDistance(m_impl->scratch, true, true, cap, nearest);
}

std::pair<double, double> CollisionWorld::clearances(const Eigen::VectorXd& q, double cap) const {
  m_impl->placeAll(q, m_impl->scratch);
  return {m_impl->leastDistance(m_impl->scratch, false, true, cap, nullptr),
          m_impl->leastDistance(m_impl->scratch, true, false, cap, nullptr)};
}

bool CollisionWorld::segmentFree(const Eigen::VectorXd& a, const Eigen::VectorXd& b, Contact* contact) const {
  return m_impl->segmentFree(a, b, contact);
}

std::vector<int> movingIndices(const RobotModel& model, const JointGroup& group) {
  std::vector<int> out;
  for (const int joint : group.joints) out.push_back(model.joints()[static_cast<std::size_t>(joint)].q_index);
  return out;
}

}  // namespace longarm::planning
