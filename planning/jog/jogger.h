#pragma once

/// @file
/// Jogger: moves the arm as long as the operator holds a key, one horizon from rest at every instant.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/motion.h"
#include "planning/collision/collision_world.h"
#include "planning/jog/jog_command.h"
#include "planning/jog/velocity_horizon.h"
#include "planning/world/workcell.h"

namespace longarm::planning {

struct JogOptions {
  JogSpeeds speeds;
  VelocityHorizonOptions horizon;
  double slow_from_m = 0.10;       ///< Distance from obstacles at which the arm slows down ...
  double creep_from_m = 0.015;     ///< ... to a creep here.
  double self_slow_from_m = 0.02, self_creep_from_m = 0.004;   ///< The same for link against link.
  double command_life_s = 0.2;     ///< A command that is not repeated for longer has been let go of.
};

/// What holds a jog back, for the display.
struct JogReport {
  double factor = 1;               ///< Of the wanted speed that is driven.
  double clearance = 0;            ///< Of the robot from obstacles and of its links from one another, at most 1 [m].
  std::string reason;              ///< Empty: nothing holds it back.
};

/// Every horizon ends at rest at a place that is inside the joint limits and free of collision on the way; where
/// none goes on that way, the horizon in force is left to end.  Pure logic: the caller supplies time.  Thread-compatible.
class Jogger {
 public:
  /// @param workcell With a model; its objects are the obstacles.
  explicit Jogger(std::shared_ptr<const Workcell> workcell, JogOptions options = {});
  ~Jogger();

  /// What is held now; repeat it while it is held.  @returns kInvalidInput as jogVelocity().
  Status command(const JogCommand& command, double now_s);
  void release();
  /// STOP was pressed or a horizon was refused: forgets the horizon in force.
  void halt();
  /// Obstacles from now on, besides the robot itself.
  void setObjects(const std::vector<WorldObject>& objects);

  /// Whether something is held, or the arm still moves by what was.
  bool active(double now_s) const;
  /// @param q Full configuration as measured; where the arm is taken from when it stands.
  /// @returns the horizon to send; no points when the one in force is to go on, or nothing moves.
  Horizon tick(double now_s, const Eigen::VectorXd& q);
  const JogReport& report() const { return m_report; }

 private:
  struct Base;
  Base baseAt(double now_s, const Eigen::VectorXd& q) const;
  bool inForce(double now_s) const;
  double obstacleFactor(const Eigen::VectorXd& q, const Eigen::VectorXd& joints, double wanted_speed);
  bool goesOn(const Base& base, const std::vector<TrajectoryPoint>& points, const Eigen::VectorXd& q);
  bool insideLimits(const Eigen::VectorXd& from, const Eigen::VectorXd& to);
  Horizon horizonOf(std::vector<TrajectoryPoint> points, double now_s);
  double tipSpeed(const Eigen::VectorXd& q, const Eigen::VectorXd& joints) const;

  std::shared_ptr<const Workcell> m_workcell;
  JogOptions m_options;
  AllowedPairs m_allowed;
  std::unique_ptr<CollisionWorld> m_world;
  std::optional<JogCommand> m_command;
  double m_commanded_s = 0;
  Trajectory m_in_force;
  double m_start_s = 0;
  bool m_braking = false;          // what is in force was sent after the command was let go of
  std::uint64_t m_sequence = 0;
  JogReport m_report;
};

}  // namespace longarm::planning
