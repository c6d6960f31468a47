#pragma once

/// @file
/// TrueWorld: where the scenario's objects really are.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/virtual_robot/mechanism.h"
#include "core/pose.h"
#include "planning/world/scenario.h"

namespace longarm::virtual_robot {

/// Objects in the world frame (base_link where the robot started), one of them perhaps held by the gripper, others
/// falling.  Thread-compatible.
class TrueWorld {
 public:
  explicit TrueWorld(const planning::Scenario& scenario);

  const std::vector<planning::ScenarioObject>& objects() const { return m_objects; }
  /// Where an object was at the start.  @pre index < objects().size()
  const Pose& startPose(std::size_t index) const { return m_start[index]; }
  std::optional<std::size_t> indexOf(const std::string& name) const;

  const std::vector<Mechanism>& mechanisms() const { return m_mechanisms; }
  /// Whether it belongs to a mechanism: no finger pushes it aside, and it does not fall.
  bool guided(std::size_t index) const;

  /// Moves an object, e.g. when a finger pushes it.  No effect on what is guided.
  void place(std::size_t index, const Pose& X_WO);
  /// Slides an object over what it stands on; what ends beyond an edge falls.
  /// @returns false, and nothing moves, where something else is in the way.
  bool slide(std::size_t index, const Pose& X_WO);
  /// The gripper has closed on it; `X_TO` is its pose in the tool frame.
  void hold(std::size_t index, const Pose& X_TO);
  /// Moves the held object to where the tool is, or as far along its mechanism as the hand leads it.
  /// @returns false when the hand has lost it: too far from the way that the mechanism leaves, or turned out of it.
  bool carry(const Pose& X_WT);
  /// Lets go: the held object falls straight down until it meets something, unless it is guided.
  void release();
  /// What is held before this camera (ScenarioObject::before) is placed by it from now on.
  /// @param X_WC as it stood at the start  @param magnification of its lens since then, > 0
  void showTo(const std::string& camera, const Pose& X_WC, double magnification);
  /// One tick of falling, and of what is carried about.
  void step(double seconds);

  std::optional<std::size_t> held() const { return m_held; }
  /// Whether what is held moves rigidly with the tool.
  bool heldFreely() const { return m_held && !guided(*m_held); }
  const Pose& heldInTool() const { return m_X_TO; }
  std::string heldName() const;
  /// Changes whenever an object that is not held has moved, or one is taken or let go.
  long revision() const { return m_revision; }

 private:
  struct Fall {
    std::size_t index;
    double way, done, speed;
  };
  struct Spectator {
    Pose X_WC;
    double magnification;
  };

  std::vector<planning::WorldObject> others(std::size_t index) const;
  bool standsOver(std::size_t index) const;
  void fall(std::size_t index);
  Mechanism* mechanismOf(std::size_t index);
  Pose onRoute(const planning::ScenarioObject& object) const;
  bool lead(Mechanism& mechanism, const Pose& X_WT);

  std::vector<planning::ScenarioObject> m_objects;
  std::vector<Mechanism> m_mechanisms;
  double m_told = 0;                     // value of the moving mechanism at the last revision
  std::vector<Pose> m_start;
  std::optional<std::size_t> m_held;
  Pose m_X_TO = Pose::Identity();
  std::vector<Fall> m_falls;
  std::map<std::string, Spectator> m_spectators;
  double m_time_s = 0;
  long m_revision = 0;
};

}  // namespace longarm::virtual_robot
