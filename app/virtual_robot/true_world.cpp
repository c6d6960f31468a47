#include "app/virtual_robot/true_world.h"

#include <algorithm>

#include "app/virtual_robot/shape_rays.h"

namespace longarm::virtual_robot {
namespace {

constexpr double kGravity = 9.81;        // [m/s^2]
constexpr double kGround = 0;            // height of the ground [m]

}  // namespace

TrueWorld::TrueWorld(const planning::Scenario& scenario) : m_objects(scenario.objects) {
  for (const auto& object : m_objects) m_start.push_back(object.body.X_WO);
}

std::optional<std::size_t> TrueWorld::indexOf(const std::string& name) const {
  for (std::size_t i = 0; i < m_objects.size(); ++i) {
    if (m_objects[i].body.name == name) return i;
  }
  return {};
}

void TrueWorld::place(std::size_t index, const Pose& X_WO) {
  m_objects[index].body.X_WO = X_WO;
  ++m_revision;
}

void TrueWorld::hold(std::size_t index, const Pose& X_TO) {
  m_held = index;
  m_X_TO = X_TO;
  ++m_revision;
}

void TrueWorld::carry(const Pose& X_WT) {
  if (m_held) m_objects[*m_held].body.X_WO = X_WT * m_X_TO;
}

void TrueWorld::release() {
  if (!m_held) return;
  std::vector<planning::WorldObject> others;
  for (std::size_t i = 0; i < m_objects.size(); ++i) {
    if (i != *m_held) others.push_back(m_objects[i].body);
  }
  const double way = fallDistance(m_objects[*m_held].body, others, kGround);
  if (way > 0) m_falls.push_back({*m_held, way, 0, 0});
  m_held.reset();
  ++m_revision;
}

void TrueWorld::step(double seconds) {
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
