#pragma once

/// @file
/// ContactWatch: what has touched what, by the true geometry.

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "app/virtual_robot/true_world.h"
#include "core/pose.h"
#include "planning/collision/collision_world.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {

struct ContactEvent {
  std::string a, b;                      ///< Names of links, objects, or "ground".
  double time_s = 0;                     ///< When they first touched.
};

/// Remembers each pair once.  Not counted: gripper links on graspable objects, and what a held object lay on when it was
/// taken.  Thread-compatible.
class ContactWatch {
 public:
  /// @param touch_goals  objects whose being touched by any link is remembered as well, see touched().
  ContactWatch(const planning::Workcell& workcell, std::set<std::string> touch_goals);
  ~ContactWatch();

  /// Looks at the true configuration (full) with the base at X_WB.
  /// @param shift  A base that has moved by less since it was last prepared for counts as standing there [m].
  void check(const Eigen::VectorXd& q, const Pose& X_WB, const TrueWorld& world, double now_s, double shift);

  const std::vector<ContactEvent>& contacts() const { return m_contacts; }
  bool touched(const std::string& object) const { return m_touched.count(object) != 0; }

 private:
  using Pair = std::pair<std::string, std::string>;

  std::vector<planning::WorldObject> bodies(const Pose& X_WB, const TrueWorld& world) const;
  void rebuild(const Pose& X_WB, const TrueWorld& world);
  void noteSupports(const Eigen::VectorXd& q, const TrueWorld& world);
  void allow(planning::CollisionWorld& collisions, const Pair& pair) const;
  void checkTouchGoals(const Eigen::VectorXd& q);

  const planning::Workcell& m_workcell;
  const std::set<std::string> m_touch_goals;
  planning::AllowedPairs m_link_pairs, m_all_link_pairs;
  std::unique_ptr<planning::CollisionWorld> m_collisions, m_touch_collisions;
  std::vector<planning::WorldObject> m_bodies;
  std::set<Pair> m_seen;                 // recorded or left out: not looked at again
  std::set<Pair> m_supports;             // of the object that is held
  std::vector<ContactEvent> m_contacts;
  std::set<std::string> m_touched;
  std::string m_held;
  long m_revision = -1;
  Pose m_X_WB = Pose::Identity();
};

}  // namespace longarm::virtual_robot
