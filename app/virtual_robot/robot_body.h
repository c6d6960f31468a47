#pragma once

/// @file
/// RobotBody: the virtual robot without its link and its pictures: joints, gripper, world, faults, contacts.

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "app/virtual_robot/arm_motion.h"
#include "app/virtual_robot/base_motion.h"
#include "app/virtual_robot/contact_watch.h"
#include "app/virtual_robot/faults.h"
#include "app/virtual_robot/gripper.h"
#include "app/virtual_robot/joint_errors.h"
#include "app/virtual_robot/joint_servo.h"
#include "app/virtual_robot/pusher.h"
#include "app/virtual_robot/true_world.h"
#include "app/virtual_robot/world_snapshot.h"
#include "core/attitude.h"
#include "core/motion.h"
#include "core/result.h"
#include "planning/world/scenario.h"
#include "planning/world/workcell.h"

namespace longarm::virtual_robot {

/// The camera that a fault strikes where it names none: the left one of a pair, else the first; empty: there is none.
std::string usualCamera(const planning::Workcell& workcell);

struct GoalState {
  planning::ScenarioGoal goal;
  bool reached = false;
};

/// Advances in ticks of 5 ms; every second tick the encoders are read.  Its clock starts at 0.  The same calls at the
/// same ticks with the same seed give the same numbers.  Thread-compatible.
class RobotBody {
 public:
  static constexpr double kTick_s = 0.005;
  static constexpr int kTicksPerReading = 2;
  static constexpr double kQuiet_s = 0.25;         ///< Without a heartbeat for longer the arm brakes.

  /// @param seed  draws the scenario's random pipe, the joints' offsets and the noise.
  /// @returns kInvalidInput when workcell and scenario do not fit (no gripper finger, unknown start pose).
  static Result<std::unique_ptr<RobotBody>> create(const planning::Workcell& workcell,
                                                   const planning::Scenario& scenario, unsigned seed);

  double time_s() const { return static_cast<double>(m_ticks) * kTick_s; }
  void tick();
  /// Whether this tick read the encoders: measured() is new.
  bool readingIsNew() const { return m_ticks % kTicksPerReading == 0; }

  // What the client says.
  void heartbeat();
  void clientLost();                               ///< The arm brakes along the horizon in force.
  /// ArmMotion::accept, or kRefused when there is no heartbeat.
  Status follow(const Horizon& horizon);
  void stop();
  /// BaseMotion::command, or kNotFound, or kRefused when there is no heartbeat or the arm moves.
  Status drive(const BaseTwist& twist);
  Status moveGripper(double joint);
  /// @returns kNotFound, or kInvalidInput for numbers that are not finite.
  Status aim(const std::string& pan_tilt, const std::map<std::string, double>& joints);
  FaultBoard& faults() { return m_faults; }
  /// TrueWorld::showTo.
  void showTo(const std::string& camera, const Pose& X_WC, double magnification) { m_world.showTo(camera, X_WC, magnification); }

  // What it measures.
  /// All joints of the robot, by URDF name, as the encoders read them; stamp on the robot's clock.
  const JointState& measured() const { return m_measured; }
  /// Null when the robot has no base.
  const BaseMotion* base() const { return m_base ? &*m_base : nullptr; }
  /// As its attitude sensor has it; empty when the robot has none.
  std::optional<Attitude> attitude() const;
  bool holding() const { return m_gripper && m_gripper->holding(); }

  // The truth.
  const planning::Workcell& workcell() const { return m_workcell; }
  const planning::Scenario& scenario() const { return m_scenario; }
  unsigned seed() const { return m_seed; }
  const FaultBoard& faults() const { return m_faults; }
  const TrueWorld& world() const { return m_world; }
  const ContactWatch& contacts() const { return m_contacts; }
  const ArmMotion& arm() const { return m_arm; }
  bool quiet() const { return m_quiet; }
  const Eigen::VectorXd& trueConfiguration() const { return m_q; }
  /// True position of every moving joint, by name.
  std::map<std::string, double> trueJoints() const;
  Pose X_WB() const;
  Pose X_WT() const;
  WorldSnapshot snapshot() const;
  std::vector<GoalState> goals() const;

 private:
  struct Axis {
    int q_index;
    JointServo servo;
  };

  RobotBody(const planning::Workcell& workcell, const planning::Scenario& scenario, unsigned seed,
            const Eigen::VectorXd& start, std::optional<FingerZone> zone);
  void later(std::function<void()> command);
  void watchHeartbeat();
  void driveArm();
  void driveOthers();
  void read();
  Eigen::Index stuckJoint() const;

  const planning::Workcell m_workcell;
  const planning::Scenario m_scenario;
  const unsigned m_seed;
  long m_ticks = 0;
  ArmMotion m_arm;
  JointErrors m_errors;
  std::map<std::string, Axis> m_axes;              // joints of neither arm nor gripper
  std::optional<Gripper> m_gripper;
  std::optional<Pusher> m_pusher;                  // with the gripper
  std::optional<BaseMotion> m_base;
  int m_gripper_index = -1;
  TrueWorld m_world;
  ContactWatch m_contacts;
  FaultBoard m_faults;
  std::deque<std::pair<double, std::function<void()>>> m_pending;   // commands on their way to the motors
  Eigen::VectorXd m_motor, m_motor_velocity;       // of the arm, as its encoders see it
  Eigen::VectorXd m_q;                             // true, all joints
  std::vector<int> m_arm_indices;
  std::vector<std::string> m_names;                // of measured(): actuated, then mimic
  JointState m_measured;
  double m_heartbeat_s = -1;
  bool m_quiet = true;
  bool m_slipped_free = true;                      // under stiction: the joint is breaking away
};

}  // namespace longarm::virtual_robot
