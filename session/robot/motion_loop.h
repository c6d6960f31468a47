#pragma once

/// @file
/// MotionLoop: one cycle of the motion thread.  Player to gate, and everything that must end a motion.

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/motion.h"
#include "core/result.h"
#include "hardware/device.h"
#include "hardware/motion_gate.h"
#include "planning/jog/jogger.h"
#include "planning/player/player.h"
#include "session/robot/base_drive.h"
#include "session/robot/play_order.h"

namespace longarm::session {

struct MotionLoopOptions {
  double start_tolerance = 0.01;  ///< [rad or m]
  double max_state_age_s = 0.2;
  bool gui_watchdog = true;
  double gui_stop_jog_s = 0.25, gui_stop_motion_s = 0.5, gui_silent_s = 1.2;
  planning::PlayerOptions player;
  planning::JogOptions jog;
};

struct MotionState {
  planning::PlayerState player = planning::PlayerState::kEmpty;
  double cursor = 0, arm_cursor = 0, duration = 0, rate = 0, speed = 1;
  std::string notice;
  bool jogging = false;
  planning::JogReport jog;
  DriveState drive;
};

/// Time comes from the clock that is given, so that a thread or a lockstep simulation drives it alike.
/// Thread-safe; tick() is called from one thread only.
class MotionLoop {
 public:
  /// Called for what happens: kind, source, text, as RuntimeEvent.  No lock of the loop is held.
  using Report =
      std::function<void(const std::string& kind, const std::string& source, const std::string& text)>;

  /// Borrows gate and clock, which must outlive it.  @param workcell With a model and the arm's limits.
  MotionLoop(std::shared_ptr<hardware::RobotArm> arm, hardware::MotionGate& gate,
             std::shared_ptr<const planning::Workcell> workcell, const Clock& clock, MotionLoopOptions options,
             Report report);

  /// As RobotRuntime's functions of the same names.
  Status load(const Trajectory& trajectory, double at_s = 0);
  void unload();
  Status confine(double low_s, double high_s);
  Status play(const PlayOrder& order = {});
  void keepRunning() { m_held_s.store(m_clock.now_s()); }
  void pause();
  void setSpeed(double factor);
  Status scrub(double cursor_s);
  Trajectory trajectory() const;
  MotionState state() const;
  Status jog(const planning::JogCommand& command);
  void releaseJog();
  /// A robot that drives; call before the first tick.
  void setBase(std::shared_ptr<hardware::MobileBase> base, const BaseLimits& limits);
  Status drive(const BaseTwist& wanted);
  void releaseDrive();
  void setObstacles(const std::vector<planning::WorldObject>& objects);

  void touchGui() { m_gui_s.store(m_clock.now_s()); }
  /// Whether the window has been alive lately enough to tell the robot so: long enough for the pause that comes
  /// first to end on the path.
  bool heartbeatAllowed() const { return guiAge() < m_options.gui_silent_s; }
  /// STOP was pressed: the player halts in the next tick.  Any thread; no lock.
  void noteStop() noexcept { m_stop_seen.store(true); }

  /// One cycle, about every 20 ms.
  void tick();

 private:
  double guiAge() const;
  Status checkAtPath(double tau) const;
  Status checkBasePlace() const;
  Status takePlaceOnPath();
  Result<Eigen::VectorXd> measured() const;
  void watchGui();
  void watchHold();
  void pauseBecause(const std::string& text);
  Horizon jogHorizon();
  void submit(const Horizon& horizon);
  void haltWith(const std::string& kind, const std::string& source, const std::string& owner, const std::string& text);
  void reportChange(planning::PlayerState before, planning::PlayerState after) const;

  const std::shared_ptr<const planning::Workcell> m_workcell;
  const std::shared_ptr<hardware::RobotArm> m_arm;
  hardware::MotionGate& m_gate;
  const std::vector<std::string> m_joints;
  const Clock& m_clock;
  const MotionLoopOptions m_options;
  const Report m_report;
  std::atomic<double> m_gui_s;
  std::atomic<double> m_held_s{0};
  std::atomic<bool> m_stop_seen{false};
  planning::PlayerState m_last = planning::PlayerState::kEmpty;  // After the last tick; tick()'s thread only.
  std::shared_ptr<hardware::MobileBase> m_base;                  // Null: none.
  std::shared_ptr<const BaseState> m_loaded_at;                  // Where it stood when the motion was loaded.
  std::unique_ptr<BaseDrive> m_drive;                            // Null: no base.
  mutable std::mutex m_mutex;  // Guards what follows; never held while something is sent.
  planning::Player m_player;
  planning::Jogger m_jogger;
  bool m_only_held = false;  // The motion runs while keepRunning() is repeated.
  std::string m_notice;
};

}  // namespace longarm::session
