#include "session/robot/motion_loop.h"

#include <cmath>
#include <utility>

#include "core/text.h"

namespace longarm::session {
namespace {

using planning::PlayerState;

constexpr const char* kOwner = "player";
constexpr const char* kJogOwner = "jog";

bool isMoving(PlayerState state) { return state == PlayerState::kPlaying || state == PlayerState::kPausing; }

bool isLinkTrouble(ErrorCode code) { return code == ErrorCode::kStale || code == ErrorCode::kDisconnected; }

}  // namespace

MotionLoop::MotionLoop(std::shared_ptr<hardware::RobotArm> arm, hardware::MotionGate& gate,
                       std::shared_ptr<const planning::Workcell> workcell, const Clock& clock,
                       MotionLoopOptions options, Report report)
    : m_workcell(std::move(workcell)),
      m_arm(std::move(arm)),
      m_gate(gate),
      m_joints(m_workcell->armJointNames()),
      m_clock(clock),
      m_options(options),
      m_report(std::move(report)),
      m_gui_s(clock.now_s()),
      m_player(m_workcell->arm_limits, options.player),
      m_jogger(m_workcell, options.jog) {}

double MotionLoop::guiAge() const { return m_options.gui_watchdog ? m_clock.now_s() - m_gui_s.load() : 0; }

Result<Eigen::VectorXd> MotionLoop::measured() const {
  const auto state = m_arm->jointState();
  if (!state) return Error{ErrorCode::kStale, "the robot has not told its joints yet"};
  const double age = m_clock.now_s() - state->stamp_s;
  if (age > m_options.max_state_age_s) {
    return Error{ErrorCode::kStale, "the newest joint state is " + formatFixed(age, 2) + " s old (limit " +
                                        formatNumber(m_options.max_state_age_s) + " s); check the link"};
  }
  return state->positionsOf(m_joints);
}

// Whether the arm stands where the loaded path is at tau.
Status MotionLoop::checkAtPath(double tau) const {
  const auto here = measured();
  if (!here) return here.error();
  const Eigen::VectorXd path = m_player.trajectory().sample(tau).positions;
  Eigen::Index worst = 0;
  const double off = (*here - path).cwiseAbs().maxCoeff(&worst);
  if (off <= m_options.start_tolerance) return {};
  return {ErrorCode::kStale,
          "joint " + m_joints[static_cast<std::size_t>(worst)] + " is at " + formatFixed((*here)[worst], 4) +
              ", the path at " + formatFixed(path[worst], 4) + " (limit of the difference " +
              formatNumber(m_options.start_tolerance) + "); plan again from where the robot is"};
}

// A motion is a way through the world, not only of the joints.
Status MotionLoop::checkBasePlace() const {
  const auto now = m_base ? m_base->odometry() : nullptr;
  if (!now || !m_loaded_at || samePlace(*now, *m_loaded_at)) return {};
  const BaseShift shift = shiftBetween(*now, *m_loaded_at);
  return {ErrorCode::kStale, "the base has moved by " + formatFixed(shift.way * 1000, 0) + " mm and " +
                                 formatFixed(shift.turn * 180 / M_PI, 1) +
                                 " deg since this motion was loaded; plan again"};
}

// Where a motion goes on: at the player's cursor when the arm stands there, else at the arm's own place on the
// path, for the robot may have braked along it by itself.
Status MotionLoop::takePlaceOnPath() {
  const bool halted = m_player.state() == PlayerState::kHalted;
  const auto at_cursor = halted ? Status() : checkAtPath(m_player.armCursor());
  if (!halted && at_cursor) return {};
  const auto here = measured();
  if (!here) return here.error();
  const auto resumed = m_player.resumeFrom(*here, m_options.start_tolerance);
  return resumed || halted ? resumed : at_cursor;
}

Status MotionLoop::load(const Trajectory& trajectory, double at_s) {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (isMoving(m_player.state()))
    return {ErrorCode::kRefused, "load: the arm is moving; pause or stop it first"};
  if (trajectory.joint_names != m_joints) {
    return {ErrorCode::kInvalidInput, "trajectory: its joints are not those of the arm, in the arm's order"};
  }
  const double speed = m_player.speed();
  if (auto status = m_player.load(trajectory); !status) {
    m_player.clear();
    return status;
  }
  m_player.setSpeed(speed);
  m_loaded_at = m_base ? m_base->odometry() : nullptr;
  auto status = at_s > 0 ? m_player.standAt(at_s) : Status();
  if (status) status = checkAtPath(at_s);
  if (!status) {
    m_player.clear();
    return status;
  }
  m_notice.clear();
  return {};
}

void MotionLoop::unload() {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (!isMoving(m_player.state())) m_player.clear();
}

Status MotionLoop::confine(double low_s, double high_s) {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_player.confine(low_s, high_s);
}

Status MotionLoop::play(const PlayOrder& order) {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_player.state() == PlayerState::kEmpty) return {ErrorCode::kRefused, "play: no motion is loaded"};
  if (m_gate.stopped()) return {ErrorCode::kRefused, "play: STOP is latched; reset it first"};
  if (m_stop_seen.load()) return {ErrorCode::kRefused, "play: the stop is still being carried out"};
  if (auto status = checkBasePlace(); !status) return status;
  if (!isMoving(m_player.state())) {
    if (auto status = takePlaceOnPath(); !status) return status;
  }
  if (auto status = m_gate.acquire(kOwner); !status) return status;
  if (order.until_s) {
    if (auto status = m_player.playUntil(*order.until_s); !status) return status;
  } else {
    m_player.play();
  }
  m_only_held = order.only_held;
  keepRunning();
  m_notice.clear();
  return {};
}

void MotionLoop::pause() {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_player.pause();
}

void MotionLoop::setSpeed(double factor) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_player.setSpeed(factor);
}

Status MotionLoop::scrub(double cursor_s) {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_player.scrub(cursor_s);
}

Trajectory MotionLoop::trajectory() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return m_player.trajectory();
}

MotionState MotionLoop::state() const {
  std::lock_guard<std::mutex> lock(m_mutex);
  return {m_player.state(),
          m_player.cursor(),
          m_player.armCursor(),
          m_player.duration(),
          m_player.rate(),
          m_player.speed(),
          m_notice,
          m_jogger.active(m_clock.now_s()),
          m_jogger.report(),
          m_drive ? m_drive->state() : DriveState()};
}

Status MotionLoop::jog(const planning::JogCommand& command) {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (m_gate.stopped()) return {ErrorCode::kRefused, "jog: STOP is latched; reset it first"};
  if (m_stop_seen.load()) return {ErrorCode::kRefused, "jog: the stop is still being carried out"};
  if (isMoving(m_player.state())) return {ErrorCode::kRefused, "jog: a motion is being played; pause it first"};
  if (const auto here = measured(); !here) return here.error();
  if (auto status = m_gate.acquire(kJogOwner); !status) return status;
  auto status = m_jogger.command(command, m_clock.now_s());
  if (status) m_notice.clear();
  return status;
}

void MotionLoop::releaseJog() {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_jogger.release();
}

void MotionLoop::setBase(std::shared_ptr<hardware::MobileBase> base, const BaseLimits& limits) {
  m_gate.setBase(base, limits);
  m_base = base;
  m_drive = std::make_unique<BaseDrive>(std::move(base), m_gate, limits, m_clock, m_report);
}

Status MotionLoop::drive(const BaseTwist& wanted) {
  if (!m_drive) return {ErrorCode::kRefused, "drive: this robot has no base that can be driven"};
  if (m_stop_seen.load()) return {ErrorCode::kRefused, "drive: the stop is still being carried out"};
  return m_drive->command(wanted);
}

void MotionLoop::releaseDrive() {
  if (m_drive) m_drive->release();
}

void MotionLoop::setObstacles(const std::vector<planning::WorldObject>& objects) {
  std::lock_guard<std::mutex> lock(m_mutex);
  m_jogger.setObjects(objects);
}

// `m_mutex` is held.
Horizon MotionLoop::jogHorizon() {
  const double now_s = m_clock.now_s();
  if (guiAge() >= m_options.gui_stop_jog_s) m_jogger.release();
  if (!m_jogger.active(now_s)) {
    m_gate.release(kJogOwner);
    return {};
  }
  const auto state = m_arm->jointState();
  if (!state || now_s - state->stamp_s > m_options.max_state_age_s) return {};   // what is in force ends at rest
  Eigen::VectorXd q = m_workcell->model->neutral();
  m_workcell->model->assign(*state, q);
  return m_jogger.tick(now_s, q);
}

void MotionLoop::tick() {
  watchGui();
  watchHold();
  PlayerState now;
  Horizon horizon;
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (m_stop_seen.exchange(false)) {
      m_player.halt();
      m_jogger.halt();
    }
    horizon = m_player.tick(m_clock.now_s());
    now = m_player.state();
    if (!isMoving(now)) {
      m_gate.release(kOwner);
      horizon = jogHorizon();
    }
  }
  if (!horizon.points.empty()) submit(horizon);
  if (m_drive) m_drive->tick(guiAge() < m_options.gui_stop_jog_s);
  m_gate.watch();
  reportChange(std::exchange(m_last, now), now);
}

void MotionLoop::watchGui() {
  const double age = guiAge();
  if (age < m_options.gui_stop_motion_s) return;
  pauseBecause("the window has not answered for " + formatFixed(age, 1) + " s: motion paused");
}

// A dead man's switch, as for jogging.
void MotionLoop::watchHold() {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (!m_only_held || m_clock.now_s() - m_held_s.load() < m_options.gui_stop_jog_s) return;
  }
  pauseBecause("Play is not held any more: motion paused");
}

void MotionLoop::pauseBecause(const std::string& text) {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (m_player.state() != PlayerState::kPlaying) return;
    m_player.pause();
    m_notice = text;
  }
  m_report("pause", "watchdog", text);
}

void MotionLoop::submit(const Horizon& horizon) {
  const auto status = m_gate.submit(horizon);
  if (status || m_gate.stopped()) return;
  if (isLinkTrouble(status.error().code)) {
    m_gate.stop("link", status.error().message);
    haltWith("fault", "link", horizon.owner, status.error().message);
  } else {
    haltWith("refused", "gate", horizon.owner, status.error().message);
  }
}

void MotionLoop::haltWith(const std::string& kind, const std::string& source, const std::string& owner,
                          const std::string& text) {
  {
    std::lock_guard<std::mutex> lock(m_mutex);
    if (owner == kOwner) m_player.halt();
    m_jogger.halt();
    m_notice = text;
  }
  m_report(kind, source, text);
}

void MotionLoop::reportChange(PlayerState before, PlayerState after) const {
  if (before == after || !isMoving(before)) return;
  if (after == PlayerState::kDone) m_report("done", kOwner, "the motion has reached its end");
  if (after == PlayerState::kReady) m_report("done", kOwner, "the motion is back at its start");
  if (after == PlayerState::kPaused) m_report("pause", kOwner, "the arm stands still on the path");
}

}  // namespace longarm::session
