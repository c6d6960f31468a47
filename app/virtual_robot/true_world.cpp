#include "app/virtual_robot/true_world.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "app/virtual_robot/shape_rays.h"
#include "planning/collision/body_distance.h"
#include "planning/collision/bounds.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kGravity = 9.81;        // [m/s^2]
constexpr double kGround = 0;            // height of the ground [m]
constexpr double kLift = 0.002;          // what reaches no higher than this above the bottom of what slides is slid over [m]
constexpr double kGivesTurn = 0.6;       // a hand turned further than this out of a handle loses it [rad]
constexpr double kTold = 0.005;          // a mechanism that has moved so far counts as a changed world [rad or m]

// Lowest and highest point [m].
std::pair<double, double> heights(const planning::WorldObject& body) {
  const planning::ShapeBounds bounds = planning::boundsOf(body.shape);
  const double middle = (body.X_WO * bounds.center).z(), half = body.X_WO.linear().row(2).cwiseAbs().dot(bounds.half.transpose());
  return {middle - half, middle + half};
}

}  // namespace

TrueWorld::TrueWorld(const planning::Scenario& scenario) : m_objects(scenario.objects) {
  for (const auto& object : m_objects) m_start.push_back(object.body.X_WO);
  for (const auto& spec : scenario.mechanisms) {
    std::vector<std::size_t> moves;
    for (const auto& name : spec.moves) {
      if (const auto index = indexOf(name)) moves.push_back(*index);
    }
    m_mechanisms.emplace_back(spec, moves);
  }
}

bool TrueWorld::guided(std::size_t index) const {
  return std::any_of(m_mechanisms.begin(), m_mechanisms.end(), [&](const Mechanism& m) { return m.carries(index); });
}

Mechanism* TrueWorld::mechanismOf(std::size_t index) {
  for (auto& mechanism : m_mechanisms) {
    if (mechanism.carries(index)) return &mechanism;
  }
  return nullptr;
}

std::optional<std::size_t> TrueWorld::indexOf(const std::string& name) const {
  for (std::size_t i = 0; i < m_objects.size(); ++i) {
    if (m_objects[i].body.name == name) return i;
  }
  return {};
}

void TrueWorld::place(std::size_t index, const Pose& X_WO) {
  if (guided(index)) return;
  m_objects[index].body.X_WO = X_WO;
  ++m_revision;
}

void TrueWorld::hold(std::size_t index, const Pose& X_TO) {
  m_held = index;
  m_X_TO = X_TO;
  if (const Mechanism* mechanism = mechanismOf(index)) m_told = mechanism->value();
  ++m_revision;
}

bool TrueWorld::carry(const Pose& X_WT) {
  if (!m_held) return false;
  if (Mechanism* mechanism = mechanismOf(*m_held)) return lead(*mechanism, X_WT);
  m_objects[*m_held].body.X_WO = X_WT * m_X_TO;
  return true;
}

// The held body turns or slides with its mechanism; the hand may turn about the axis of a round handle.
bool TrueWorld::lead(Mechanism& mechanism, const Pose& X_WT) {
  const Pose& start = m_start[*m_held];
  const Eigen::Vector3d grip_O = m_X_TO.inverse().translation();
  const double off = mechanism.follow(start * grip_O, X_WT.translation());
  const Pose motion = mechanism.motion(mechanism.value());
  for (const std::size_t index : mechanism.moves()) m_objects[index].body.X_WO = motion * m_start[index];
  if (std::abs(mechanism.value() - m_told) > kTold) {
    m_told = mechanism.value();
    ++m_revision;
  }
  const Pose& there = m_objects[*m_held].body.X_WO;
  const Pose wanted = X_WT * m_X_TO;
  const bool round = std::holds_alternative<planning::Cylinder>(m_objects[*m_held].body.shape);
  const double turned = round ? std::acos(std::clamp(there.linear().col(2).dot(wanted.linear().col(2)), -1.0, 1.0))
                              : Eigen::AngleAxisd(there.linear().transpose() * wanted.linear()).angle();
  return off <= mechanism.spec().gives && turned <= kGivesTurn;
}

std::vector<planning::WorldObject> TrueWorld::others(std::size_t index) const {
  std::vector<planning::WorldObject> out;
  for (std::size_t i = 0; i < m_objects.size(); ++i) {
    if (i != index) out.push_back(m_objects[i].body);
  }
  return out;
}

// Whether something carries its middle; to see whether any of it is carried costs a thousand times more.
bool TrueWorld::standsOver(std::size_t index) const {
  const Eigen::Vector3d& middle = m_objects[index].body.X_WO.translation();
  const double most = planning::boundingRadius(m_objects[index].body.shape) + kLift;
  if (middle.z() - kGround <= most) return true;
  const auto others = this->others(index);
  return std::any_of(others.begin(), others.end(), [&](const planning::WorldObject& other) {
    const auto hit = other.collides ? planning::rayDistance(other.shape, other.X_WO, middle, -Eigen::Vector3d::UnitZ()) : std::nullopt;
    return hit && *hit > 0 && *hit <= most;
  });
}

void TrueWorld::fall(std::size_t index) {
  const double way = fallDistance(m_objects[index].body, others(index), kGround);
  if (way > 0) m_falls.push_back({index, way, 0, 0});
}

bool TrueWorld::slide(std::size_t index, const Pose& X_WO) {
  if (guided(index) || m_held == index) return false;
  planning::WorldObject moved = m_objects[index].body;
  moved.X_WO = X_WO;
  const double bottom = heights(moved).first + kLift;        // what it stands on is not in its way
  for (const auto& other : others(index)) {
    if (other.collides && heights(other).second > bottom && planning::bodyDistance(moved, other, kLift) <= 0) return false;
  }
  place(index, X_WO);
  const auto falls = [index](const Fall& fall) { return fall.index == index; };
  if (!standsOver(index) && std::none_of(m_falls.begin(), m_falls.end(), falls)) fall(index);
  return true;
}

void TrueWorld::release() {
  if (!m_held) return;
  if (guided(*m_held)) {
    m_held.reset();
    ++m_revision;
    return;
  }
  fall(*m_held);
  m_held.reset();
  ++m_revision;
}

void TrueWorld::showTo(const std::string& camera, const Pose& X_WC, double magnification) {
  m_spectators.insert_or_assign(camera, Spectator{X_WC, magnification});
}

Pose TrueWorld::onRoute(const planning::ScenarioObject& object) const {
  Pose X = object.onRoute(m_time_s);
  if (object.before.empty()) return X;
  const auto found = m_spectators.find(object.before);
  if (found == m_spectators.end()) return X;
  X.translation().z() *= found->second.magnification;
  return found->second.X_WC * X;
}

void TrueWorld::step(double seconds) {
  m_time_s += seconds;
  for (std::size_t i = 0; i < m_objects.size(); ++i) {
    if (m_objects[i].route.empty() || m_held == i) continue;
    m_objects[i].body.X_WO = onRoute(m_objects[i]);
    if (m_objects[i].body.collides) ++m_revision;
  }
  for (auto& fall : m_falls) {
    fall.speed += kGravity * seconds;
    const double down = std::min(fall.speed * seconds, fall.way - fall.done);
    fall.done += down;
    m_objects[fall.index].body.X_WO.translation().z() -= down;
    ++m_revision;
  }
  m_falls.erase(std::remove_if(m_falls.begin(), m_falls.end(),
                               [this](const Fall& f) { return f.done >= f.way || (m_held && *m_held == f.index); }),
                m_falls.end());
}

std::string TrueWorld::heldName() const { return m_held ? m_objects[*m_held].body.name : std::string(); }

}  // namespace longarm::virtual_robot
