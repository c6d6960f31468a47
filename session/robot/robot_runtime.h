#pragma once

/// @file
/// RobotRuntime: the robot as the session sees it.  Owns the devices, the gate, the player and the motion thread;
/// starts and restarts the virtual robot.  The only code above the drivers that can make an arm move.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base_motion.h"
#include "core/clock.h"
#include "core/motion.h"
#include "core/result.h"
#include "hardware/device.h"
#include "hardware/motion_gate.h"
#include "planning/jog/jogger.h"
#include "planning/player/player.h"
#include "planning/world/workcell.h"
#include "session/robot/play_order.h"

namespace longarm::session {

/// What stands behind the devices; shown by word, colour and border.
enum class RobotMode { kLive, kVirtual, kReplay };
const char* toString(RobotMode mode);              ///< "LIVE", "VIRTUAL", "REPLAY"

/// How the connection to the robot does.
enum class LinkState {
  kClosed,       ///< Not opened.
  kConnecting,   ///< Opening, no joint state yet.
  kUp,           ///< Joint states are fresh.
  kQuiet,        ///< Connected, but no joint state for longer than the gate allows.
  kLost          ///< The connection or the robot's process is gone; restart() or a return of the link mends it.
};
const char* toString(LinkState state);             ///< "closed", "connecting", "up", "quiet", "lost"

/// Calls a service of the robot: name and arguments as JSON, the answer's values as JSON.
using ServiceCall = std::function<Result<std::string>(const std::string& service, const std::string& arguments,
                                                      double timeout_s)>;

/// The devices of one robot.  Members may be null or empty where the workcell has none, except the arm.
struct DeviceSet {
  std::shared_ptr<hardware::RobotArm> arm;
  std::shared_ptr<hardware::MobileBase> base;
  std::shared_ptr<hardware::Gripper> gripper;
  std::shared_ptr<hardware::Imu> imu;
  std::map<std::string, std::shared_ptr<hardware::PanTilt>> pan_tilts;   ///< By PanTiltSpec::name.
  std::map<std::string, std::shared_ptr<hardware::Camera>> cameras;      ///< By CameraSpec::name.
  /// Heartbeats go out while the clock is below this; the motion thread keeps it ahead while all is well [s].
  std::shared_ptr<std::atomic<double>> alive_until_s;
  ServiceCall call_service;
};
/// Makes the devices of a workcell that answer at `url`.  `clock` outlives them.
using DeviceFactory =
    std::function<Result<DeviceSet>(const planning::Workcell& workcell, const std::string& url, const Clock& clock)>;

struct RuntimeOptions {
  RobotMode mode = RobotMode::kVirtual;            ///< kVirtual never constructs a driver of workcell.backend.
  std::string scenario = "grab_pipe";              ///< Name or file, for the virtual robot.
  std::string variant;                             ///< "" or "ptz".
  unsigned seed = 1;
  bool ideal = false;                              ///< No offsets, noise, backlash or latency.
  bool cameras = true;                             ///< false: the virtual robot renders nothing.
  bool stream_cameras = true;                      ///< All cameras at once; false: those that streamCamera() asks for.
  bool lockstep = false;                           ///< No threads, no real time: step() drives everything.
  bool gui_watchdog = true;                        ///< Needs touchGui(); programs without a window switch it off.
  double gui_stop_jog_s = 0.25;                    ///< Window silent for longer: jog and servo stop.
  double gui_stop_motion_s = 0.5;                  ///< Window silent for longer: trajectories pause.
  double gui_silent_s = 1.2;                       ///< Window silent for longer: the heartbeat ends, the robot brakes by itself.
  double start_tolerance = 0.01;                   ///< Measured joints against a plan's start [rad or m].
  std::string virtual_robot;                       ///< Executable; empty: $LONGARM_VIRTUAL_ROBOT, else beside this one.
  std::function<std::string(const std::string& url)> through;   ///< Puts a proxy in the way; empty: none.
  hardware::GateOptions gate;
  planning::PlayerOptions player;
  planning::JogOptions jog;
  DeviceFactory make_devices;                      ///< Empty: the workcell's driver.
};

/// Everything a display needs about link and motion, at one instant.
struct RuntimeStatus {
  RobotMode mode = RobotMode::kVirtual;
  LinkState link = LinkState::kClosed;
  std::string link_text;                           ///< A sentence for the status strip, e.g. "link lost for 2.1 s".
  double state_age_s = -1;                         ///< Age of the newest joint state; < 0: none yet.
  planning::PlayerState player = planning::PlayerState::kEmpty;
  double cursor = 0, duration = 0;                 ///< Position on the loaded trajectory [s].
  double arm_cursor = 0;  ///< Where the arm is on it; differs from cursor after scrub() [s].
  double rate = 0;                                 ///< d cursor / dt now.
  double speed = 1;                                ///< Wanted factor, -2 ... 2.
  hardware::GateStatus gate;
  bool jogging = false;                            ///< A jog is held, or the arm still moves by one.
  planning::JogReport jog;                         ///< What holds it back.
  bool driving = false;                            ///< A drive is held, or the base still moves by one.
  std::string drive_notice;                        ///< Why the last drive ended by itself.
  std::optional<BaseState> base;                   ///< Newest odometry; empty: none, or no base.
  std::optional<Eigen::Vector3d> up;               ///< Unit, against gravity, in the root frame; empty: not told, or long ago.
  bool moving = false;                             ///< The commanded velocity is not zero.
  bool stop_confirmed = false;                     ///< STOP is latched and the measured joints stand still.
  double tracking_error = 0;                       ///< Largest |commanded - measured| [rad or m].
  std::string tracking_joint;                      ///< Whose it is.
  std::vector<std::string> faults;                 ///< Sentences; empty: none.
  std::string notice;                              ///< Why the last motion ended or was refused; empty: nothing to say.
};

/// Something that happened, for the journal and the status strip.
struct RuntimeEvent {
  double t_s = 0;                                  ///< Runtime's clock [s].
  std::string kind;                                ///< "link", "stop", "reset", "load", "play", "pause", "refused", "done", "fault", "process"
  std::string source, text;
};

/// Pan, tilt and whether they are changing.
struct PanTiltState {
  double pan = 0, tilt = 0;                        ///< [rad]
  bool moving = false;
};

/// Thread-safe; no call waits for the robot except callService() and step().  stop() never waits for anything.
///
/// A plan may be played only from where it starts: load() and play() refuse when a measured joint is further than
/// start_tolerance from the path, and after any stop, link loss or restart nothing moves until resetStop() and a new
/// play() or load().
class RobotRuntime {
 public:
  /// Starts the virtual robot (kVirtual) and the devices; the link comes up later by itself.
  /// @returns kNotFound when the executable is missing, kTimeout when it says no address within 10 s,
  ///   kInvalidInput for a driver that is not known.
  static Result<std::unique_ptr<RobotRuntime>> start(std::shared_ptr<const planning::Workcell> workcell,
                                                     RuntimeOptions options = {});
  ~RobotRuntime();                                 ///< Stops, closes the devices, ends the virtual robot.

  RobotMode mode() const;
  const planning::Workcell& workcell() const;
  const Clock& clock() const;
  RuntimeStatus status() const;
  /// Waits (steps, in lockstep) until the joint state is fresh.  kTimeout / kDisconnected.
  Status waitUntilUp(double timeout_s);

  /// Newest joints of the whole robot; null before the first.
  std::shared_ptr<const JointState> jointState() const;
  Result<JointState> jointStateAt(double stamp_s) const;
  /// The whole configuration q of the workcell's model at the newest joint state.  kStale before the first.
  Result<Eigen::VectorXd> configuration() const;

  /// Takes a trajectory of the arm's joints, cursor at its start.  kStale naming the joint, both values and the
  /// tolerance when the arm is not where the trajectory starts; else as Player::load; kRefused while moving.
  /// @param at_s  Where on it the arm stands [s].
  Status load(const Trajectory& trajectory, double at_s = 0);
  void unload();
  /// As Player::confine().
  Status confine(double low_s, double high_s);
  /// Towards the end (or the start, at negative speed).  kStale as load(), kRefused when STOP is latched, the link is
  /// not up, or nothing is loaded.
  Status play(const PlayOrder& order = {});
  void keepRunning();  ///< For PlayOrder::only_held, at least every 0.2 s.
  void pause();
  void setSpeed(double factor);
  Status scrub(double cursor_s);
  Trajectory trajectory() const;                   ///< The loaded one; empty if none.

  /// Moves the arm as long as this is repeated (at least every 0.2 s), towards nothing that the model knows.
  /// @returns kRefused: STOP is latched, a motion is played; kStale: no fresh joint state; kInvalidInput as Jogger.
  Status jog(const planning::JogCommand& command);
  void releaseJog();                               ///< The arm comes to rest within 0.3 s.
  /// What a jog must not touch, in place of the workcell's objects.
  void setObstacles(const std::vector<planning::WorldObject>& objects);

  /// Drives the base as long as this is repeated (at least every 0.2 s); the arm is held meanwhile.
  /// @returns as BaseDrive::command().
  Status drive(const BaseTwist& wanted);
  void releaseDrive();

  /// STOP.  Latches; every motion ends at the STOP deceleration.  Any thread, no waiting.
  void stop(const std::string& source, const std::string& reason) noexcept;
  /// Lets motion through again; nothing moves until play().
  Status resetStop();

  Status setGripper(double position);              ///< Joint position [m or rad].
  double gripperPosition() const;
  bool holding() const;
  Status movePanTilt(const std::string& name, double pan, double tilt);
  Result<PanTiltState> panTilt(const std::string& name) const;
  /// Newest encoded picture of a camera; null before the first, or if there is no such camera.
  std::shared_ptr<const hardware::Frame> cameraFrame(const std::string& name) const;
  /// Starts or ends the pictures of one camera (each costs the robot and the link time).  kNotFound.
  Status streamCamera(const std::string& name, bool on);
  Status setZoom(const std::string& camera, double zoom01);
  /// Setting of its zoom at a time on clock(); empty for a camera that has none.  kStale, kNotFound.
  Result<std::optional<double>> zoomAt(const std::string& camera, double stamp_s) const;
  Status setFocus(const std::string& camera, double focus01);
  Status focusItself(const std::string& camera);   ///< Until the next setFocus().
  std::optional<double> focus(const std::string& camera) const;   ///< As told last.

  /// The window is alive; called by its 30 Hz timer.
  void touchGui();
  /// After a lost link or a robot process that died: starts it and the devices anew, STOP latched, nothing loaded.
  Status restart();
  /// Process id of the virtual robot, 0 if there is none.
  int virtualRobotPid() const;
  Result<std::string> callService(const std::string& service, const std::string& arguments, double timeout_s = 2);
  /// Called for every event, on the motion thread (in step() in lockstep; the last ones by restart() and the
  /// destructor); must be quick and must not call stop-and-wait functions such as restart().
  void onEvent(std::function<void(const RuntimeEvent&)> callback);

  /// Lockstep only: advances robot and console together in 20 ms steps.  kDisconnected when the robot is gone.
  Status step(double seconds);

 private:
  RobotRuntime();
  struct Impl;
  std::unique_ptr<Impl> m_impl;
};

}  // namespace longarm::session
