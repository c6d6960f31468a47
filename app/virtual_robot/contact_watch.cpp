#include "app/virtual_robot/contact_watch.h"

#include <algorithm>

namespace longarm::virtual_robot {
namespace {

constexpr double kSupportDistance = 0.004;   // closer when it is taken: it lay on it [m]
constexpr int kMostAtOnce = 32;

planning::WorldObject groundBody() {
  planning::WorldObject ground;
  ground.name = "ground";
  ground.shape = planning::Box{{40, 40, 1}};
  ground.X_WO.translation().z() = -0.5;
  return ground;
}

std::pair<std::string, std::string> sorted(const planning::Contact& contact) {
  return {std::min(contact.first, contact.second), std::max(contact.first, contact.second)};
}

}  // namespace

ContactWatch::ContactWatch(const planning::Workcell& workcell, std::set<std::string> touch_goals)
    : m_workcell(workcell),
      m_touch_goals(std::move(touch_goals)),
      m_link_pairs(planning::allowedPairs(workcell)) {
  const int links = static_cast<int>(workcell.model->links().size());
  for (int a = 0; a < links; ++a) {
    for (int b = a + 1; b < links; ++b) m_all_link_pairs.insert({a, b});
  }
}

ContactWatch::~ContactWatch() = default;

// Everything in the robot's root frame; what is held hangs on the tool.
std::vector<planning::WorldObject> ContactWatch::bodies(const Pose& X_WB, const TrueWorld& world) const {
  std::vector<planning::WorldObject> out = {groundBody()};
  for (const auto& object : world.objects()) out.push_back(object.body);
  for (auto& body : out) body.X_WO = X_WB.inverse() * body.X_WO;
  if (world.heldFreely()) {
    auto& body = out[*world.held() + 1];
    body.attached_link = m_workcell.arm.tip_link;
    body.X_WO = world.heldInTool();
  }
  return out;
}

void ContactWatch::allow(planning::CollisionWorld& collisions, const Pair& pair) const {
  collisions.allow(pair.first, {pair.second});
  collisions.allow(pair.second, {pair.first});
}

void ContactWatch::rebuild(const Pose& X_WB, const TrueWorld& world) {
  m_revision = world.revision();
  m_X_WB = X_WB;
  m_bodies = bodies(X_WB, world);
  m_collisions = std::make_unique<planning::CollisionWorld>(m_workcell.model, m_bodies, m_link_pairs);
  const std::vector<std::string> fingers = m_workcell.gripper ? m_workcell.gripper->links : std::vector<std::string>{};
  for (const auto& object : world.objects()) {
    if (object.graspable) m_collisions->allow(object.body.name, fingers);
  }
  for (const auto& pair : m_seen) allow(*m_collisions, pair);
  for (const auto& pair : m_supports) allow(*m_collisions, pair);
  std::vector<planning::WorldObject> goals;
  for (const auto& body : m_bodies) {
    if (m_touch_goals.count(body.name) != 0 && body.attached_link.empty()) goals.push_back(body);
  }
  m_touch_collisions.reset();
  if (goals.empty()) return;
  m_touch_collisions = std::make_unique<planning::CollisionWorld>(m_workcell.model, goals, m_all_link_pairs);
}

// What the object lies on at the moment it is taken may go on touching it until it is let go.
void ContactWatch::noteSupports(const Eigen::VectorXd& q, const TrueWorld& world) {
  m_held = world.heldName();
  m_supports.clear();
  if (m_held.empty()) return;
  planning::CollisionOptions options;
  options.padding = kSupportDistance;
  options.self_padding = 0;
  planning::CollisionWorld near(m_workcell.model, m_bodies, m_all_link_pairs, options);
  for (const auto& body : m_bodies) {
    if (body.name == m_held) continue;
    for (const auto& link : m_workcell.model->links()) near.allow(body.name, {link.name});
  }
  if (m_workcell.gripper) near.allow(m_held, m_workcell.gripper->links);
  planning::Contact contact;
  for (int i = 0; i < kMostAtOnce && near.inCollision(q, &contact); ++i) {
    m_supports.insert(sorted(contact));
    allow(near, sorted(contact));
  }
  for (const auto& pair : m_supports) allow(*m_collisions, pair);
}

void ContactWatch::checkTouchGoals(const Eigen::VectorXd& q) {
  planning::Contact contact;
  for (int i = 0; i < kMostAtOnce && m_touch_collisions && m_touch_collisions->touching(q, &contact); ++i) {
    for (const auto& name : {contact.first, contact.second}) {
      if (m_touch_goals.count(name) != 0) m_touched.insert(name);
    }
    allow(*m_touch_collisions, sorted(contact));
  }
}

void ContactWatch::check(const Eigen::VectorXd& q, const Pose& X_WB, const TrueWorld& world, double now_s,
                         double shift) {
  if (m_revision != world.revision() || (X_WB.matrix() - m_X_WB.matrix()).cwiseAbs().maxCoeff() > shift)
    rebuild(X_WB, world);
  if (m_held != world.heldName()) noteSupports(q, world);
  planning::Contact contact;
  for (int i = 0; i < kMostAtOnce && m_collisions->touching(q, &contact); ++i) {
    const Pair pair = sorted(contact);
    if (m_seen.insert(pair).second) m_contacts.push_back({pair.first, pair.second, now_s});
    const auto a = m_workcell.model->linkIndex(pair.first), b = m_workcell.model->linkIndex(pair.second);
    if (a && b) {
      m_link_pairs.insert({std::min(*a, *b), std::max(*a, *b)});
      rebuild(X_WB, world);
    } else {
      allow(*m_collisions, pair);
    }
  }
  checkTouchGoals(q);
}

}  // namespace longarm::virtual_robot
