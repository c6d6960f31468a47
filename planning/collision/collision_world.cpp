#include "planning/collision/collision_world.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/require.h"
#include "core/text.h"
#include "planning/collision/collision_bodies.h"
#include "planning/world/zone.h"

namespace longarm::planning {

using internal::Body;
using internal::Pair;
using internal::PlacedState;

namespace {

constexpr std::size_t kWord = sizeof(std::uint64_t);

bool noneOf(const unsigned char* flags) {
  std::uint64_t word = 0;
  std::memcpy(&word, flags, kWord);
  return word == 0;
}

}  // namespace

std::string Contact::sentence() const {
  if (distance <= 0) return first + " " + meetingWords(role, second);
  if (role == BodyRole::kKeepIn) return first + " is " + formatFixed(distance * 1000, 1) + " mm from the edge of the workspace " + second;
  return first + " is " + formatFixed(distance * 1000, 1) + " mm from " + second;
}

namespace {

// Entry of q that drives a joint, and how: v = multiplier q + offset.
void drivenBy(const RobotModel& model, const Joint& joint, internal::LinkStep& step) {
  if (joint.mimic_of < 0) {
    step.q_index = joint.q_index;
    return;
  }
  drivenBy(model, model.joints()[static_cast<std::size_t>(joint.mimic_of)], step);
  step.multiplier *= joint.mimic_multiplier;
  step.offset = joint.mimic_multiplier * step.offset + joint.mimic_offset;
}

internal::LinkStep stepOf(const RobotModel& model, const Joint& joint) {
  internal::LinkStep step;
  step.link = joint.child_link;
  step.parent = joint.parent_link;
  step.A = joint.X_PJ.linear();
  step.B.setZero();
  step.C.setZero();
  step.p_0 = joint.X_PJ.translation();
  step.d.setZero();
  if (joint.type == JointType::kFixed) return step;
  drivenBy(model, joint, step);
  if (joint.type == JointType::kPrismatic) {
    step.d = joint.X_PJ.linear() * joint.axis;
    return step;
  }
  // Rodrigues' formula, the parts that do not depend on the angle multiplied out.
  const Eigen::Vector3d& n = joint.axis;
  Eigen::Matrix3d cross;
  cross << 0, -n.z(), n.y(), n.z(), 0, -n.x(), -n.y(), n.x(), 0;
  step.turns = true;
  step.A = joint.X_PJ.linear() * (n * n.transpose());
  step.B = joint.X_PJ.linear() * cross;
  step.C = joint.X_PJ.linear() * (Eigen::Matrix3d::Identity() - n * n.transpose());
  return step;
}

}  // namespace

void CollisionWorld::Impl::addSteps() {
  const auto is_moving = [this](int q_index) {
    return q_index >= 0 && (options.moving.empty() || std::find(options.moving.begin(), options.moving.end(), q_index) != options.moving.end());
  };
  for (int i = 0; i < model->dof(); ++i) {
    if (!is_moving(i)) still.push_back(i);
  }
  link_moves.assign(model->links().size(), 0);
  std::vector<int> open{model->rootLink()};
  while (!open.empty()) {
    const int parent = open.back();
    open.pop_back();
    for (const auto& joint : model->joints()) {
      if (joint.parent_link != parent) continue;
      steps.push_back(stepOf(*model, joint));
      const bool moves = link_moves[static_cast<std::size_t>(parent)] != 0 || is_moving(steps.back().q_index);
      link_moves[static_cast<std::size_t>(joint.child_link)] = moves ? 1 : 0;
      open.push_back(joint.child_link);
    }
  }
}

void CollisionWorld::Impl::addLinkBodies() {
  addSteps();
  for (std::size_t link = 0; link < model->links().size(); ++link) {
    for (const auto& shape : model->links()[link].collisions) {
      Body body;
      body.name = model->links()[link].name;
      body.link = static_cast<int>(link);
      body.X_LS = shape.X_LS;
      body.geometry = internal::toFcl(shape.shape);
      body.convex = internal::convexOf(shape.shape);
      body.bounds = boundsOf(shape.shape);
      if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&shape.shape)) body.mesh = *mesh;
      keep(std::move(body));
    }
  }
}

void CollisionWorld::Impl::keep(Body body) {
  if (!body.geometry) return;
  const Eigen::Vector3d& half = body.bounds.half;
  const bool round = body.convex && body.convex->kind == internal::Convex::Kind::kCylinder;
  body.ball = body.convex && body.convex->kind == internal::Convex::Kind::kPoint ? body.convex->margin
              : round ? std::hypot(half.x(), half.z()) : half.norm();
  body.turned = !body.X_LS.linear().isIdentity(0);
  any_mesh = any_mesh || !body.convex;
  bodies.push_back(std::move(body));
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
  body.convex = internal::convexOf(object.shape);
  body.bounds = boundsOf(object.shape);
  if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&object.shape)) body.mesh = *mesh;
  if (!object.attached_link.empty()) body.link = model->linkIndex(object.attached_link).valueOr(-1);
  keep(std::move(body));
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
      pair.dear = !a.convex || !b.convex;
      pair.zone = a.role != BodyRole::kSolid || b.role != BodyRole::kSolid;
      pairs.push_back(std::move(pair));
    }
  }
}

// Everything that does not change from one state to the next of a motion is placed once.
void CollisionWorld::Impl::placeAll(const Eigen::VectorXd& q, PlacedState& state) const {
  if (state.q.size() == q.size() && state.q == q) return;
  ++counters.states;
  const bool known = state.q.size() == q.size() && std::all_of(still.begin(), still.end(), [&](int i) { return state.q[i] == q[i]; });
  if (!known) {
    LONGARM_REQUIRE(q.size() == model->dof(), "configuration of the wrong size");
    state.links.assign(model->links().size(), Pose::Identity());
    state.poses.resize(bodies.size());
    state.covers.resize(bodies.size());
    state.boxes.resize(bodies.size());
    state.bounds.resize(any_mesh ? bodies.size() : 0);
  }
  for (const auto& step : steps) {
    const bool moves = link_moves[static_cast<std::size_t>(step.link)] != 0;
    if (known && !moves) continue;
    const Pose& X_RP = state.links[static_cast<std::size_t>(step.parent)];
    Pose& X = state.links[static_cast<std::size_t>(step.link)];
    const double v = step.q_index < 0 ? 0 : step.multiplier * q[step.q_index] + step.offset;
    if (step.turns) {
      X.linear().noalias() = X_RP.linear().lazyProduct(step.A + std::sin(v) * step.B + std::cos(v) * step.C);
    } else {
      X.linear().noalias() = X_RP.linear().lazyProduct(step.A);
    }
    X.translation() = X_RP.translation();
    X.translation().noalias() += X_RP.linear().lazyProduct(step.p_0 + v * step.d);
  }
  if (!known) placeBodies(false, state);
  placeBodies(true, state);
  state.q = q;
}

void CollisionWorld::Impl::placeBodies(bool moving, PlacedState& state) const {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const bool moves = body.link >= 0 && link_moves[static_cast<std::size_t>(body.link)] != 0;
    if (moves != moving) continue;
    Pose& X = state.poses[i];
    if (body.link < 0) {
      X = body.X_LS;
    } else {
      const Pose& X_RL = state.links[static_cast<std::size_t>(body.link)];
      if (body.turned) X.linear().noalias() = X_RL.linear().lazyProduct(body.X_LS.linear());
      else X.linear() = X_RL.linear();
      X.translation() = X_RL.translation();
      X.translation().noalias() += X_RL.linear().lazyProduct(body.X_LS.translation());
    }
    internal::Cover& cover = state.covers[i];
    cover.center = X.translation();
    cover.center.noalias() += X.linear().lazyProduct(body.bounds.center);
    cover.half.noalias() = X.linear().cwiseAbs().lazyProduct(body.bounds.half);
    cover.radius = body.ball;
    state.boxes.set(i, cover.center, cover.half);
    if (any_mesh) state.bounds[i] = place(body.bounds, X);
  }
}

const internal::LookedAt& CollisionWorld::Impl::lookedAt() const {
  if (looked_at_valid) return looked_at;
  internal::Boxes sized;
  sized.resize(bodies.size());
  const std::size_t columns = sized.padded();
  const auto moves = [this](int body) {
    const int link = bodies[static_cast<std::size_t>(body)].link;
    return link >= 0 && link_moves[static_cast<std::size_t>(link)] != 0;
  };
  looked_at = {};
  std::vector<int> row_of(bodies.size(), -1);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!moves(static_cast<int>(i))) continue;
    row_of[i] = static_cast<int>(looked_at.movers.size());
    looked_at.movers.push_back(static_cast<int>(i));
  }
  looked_at.rows.assign(looked_at.movers.size() * columns, -1);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!active(pairs[i])) continue;
    looked_at.pairs.push_back(static_cast<int>(i));
    const bool first = row_of[static_cast<std::size_t>(pairs[i].a)] >= 0;
    const auto row = static_cast<std::size_t>(row_of[static_cast<std::size_t>(first ? pairs[i].a : pairs[i].b)]);
    looked_at.rows[row * columns + static_cast<std::size_t>(first ? pairs[i].b : pairs[i].a)] = static_cast<int>(i);
  }
  for (const int pair : looked_at.rows) looked_at.asked.push_back(pair >= 0 ? 1 : 0);
  looked_at.reach.setZero(static_cast<Eigen::Index>(looked_at.pairs.size()), model->dof());
  for (std::size_t i = 0; i < looked_at.pairs.size(); ++i) {
    const Pair& pair = pairs[static_cast<std::size_t>(looked_at.pairs[i])];
    looked_at.dear.push_back(pair.dear ? 1 : 0);
    looked_at.self.push_back(pair.self ? 1 : 0);
    for (const auto& [index, reach] : pair.bound) looked_at.reach(static_cast<Eigen::Index>(i), index) += reach;
  }
  looked_at_valid = true;
  return looked_at;
}

double CollisionWorld::Impl::bound(const Pair& pair, const PlacedState& state) const {
  const double low = coverBound(pair.a, pair.b, state);
  const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
  return pair.dear ? std::max(low, distanceBound(state.bounds[a], state.bounds[b])) : low;
}

double CollisionWorld::Impl::distance(const Pair& pair, const PlacedState& state, double cap) const {
  ++counters.queries;
  const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
  if (bodies[a].convex && bodies[b].convex) {
    if (const auto d = internal::convexDistance(*bodies[a].convex, state.poses[a], *bodies[b].convex, state.poses[b], cap, &pair.axis)) return *d;
  }
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

double CollisionWorld::Impl::clearance(const Pair& pair, const PlacedState& state, double cap) const {
  const Body &a = bodies[static_cast<std::size_t>(pair.a)], &b = bodies[static_cast<std::size_t>(pair.b)];
  if (a.convex && b.convex) {
    ++counters.queries;
    const Pose &X_A = state.poses[static_cast<std::size_t>(pair.a)], &X_B = state.poses[static_cast<std::size_t>(pair.b)];
    if (const auto d = internal::convexClearance(*a.convex, X_A, *b.convex, X_B, cap, padding(pair), &pair.axis)) return *d;
  }
  return distance(pair, state, cap);
}

bool CollisionWorld::Impl::within(const Pair& pair, const PlacedState& state, double limit) const {
  const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
  if (bodies[a].convex && bodies[b].convex) {
    ++counters.queries;
    if (const auto is = internal::convexWithin(*bodies[a].convex, state.poses[a], *bodies[b].convex, state.poses[b], limit)) return *is;
  }
  return distance(pair, state, limit + 1e-3) <= limit;
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
  m_impl->looked_at_valid = false;
}

bool CollisionWorld::inCollision(const Eigen::VectorXd& q, Contact* contact) const {
  Impl& impl = *m_impl;
  PlacedState& state = impl.scratch;
  impl.placeAll(q, state);
  const internal::LookedAt& look = impl.lookedAt();
  const std::size_t columns = state.boxes.padded();
  impl.near.resize(columns);
  const double widest = std::max(impl.options.padding, impl.options.self_padding);
  for (std::size_t row = look.movers.size(); row-- > 0;) {      // what is far out touches first
    internal::nearBoxes(state.boxes, static_cast<std::size_t>(look.movers[row]), widest, &look.asked[row * columns],
                        impl.near.data());
    for (std::size_t other = 0; other < columns; ++other) {
      if (other % kWord == 0) {
        while (other < columns && noneOf(&impl.near[other])) other += kWord;   // most are far
        if (other >= columns) break;
      }
      if (impl.near[other] == 0) continue;
      const Pair& pair = impl.pairs[static_cast<std::size_t>(look.rows[row * columns + other])];
      const double limit = impl.padding(pair);
      if ((pair.dear && impl.bound(pair, state) > limit) || !impl.within(pair, state, limit)) continue;
      if (contact != nullptr) impl.report(pair, impl.distance(pair, state, limit + 1e-3), contact);
      return true;
    }
  }
  return false;
}

bool CollisionWorld::Impl::anyTouches(const Eigen::VectorXd& q, bool zones_only, Contact* contact) const {
  placeAll(q, scratch);
  for (const auto& pair : pairs) {
    if (pair.zone ? !pair.moving : (pair.allowed || zones_only)) continue;
    if (bound(pair, scratch) > 0 || !within(pair, scratch, 0)) continue;
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

std::vector<int> movingIndices(const RobotModel& model, const JointGroup& group) {
  std::vector<int> out;
  for (const int joint : group.joints) out.push_back(model.joints()[static_cast<std::size_t>(joint)].q_index);
  return out;
}

}  // namespace longarm::planning
