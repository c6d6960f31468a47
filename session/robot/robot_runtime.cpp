#include "session/robot/robot_runtime.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <mutex>
#include <thread>

#include "core/text.h"
#include "session/robot/robot_core.h"

namespace longarm::session {
namespace {

constexpr double kTick_s = 0.02;
constexpr double kStepAnswer_s = 60;      // A step may take pictures on a busy machine; a robot that is gone is seen at once.
constexpr std::size_t kMaxEvents = 1000;  // Waiting for the motion thread; older ones are dropped.

}  // namespace

const char* toString(RobotMode mode) {
  switch (mode) {
    case RobotMode::kLive:
      return "LIVE";
    case RobotMode::kVirtual:
      return "VIRTUAL";
    case RobotMode::kReplay:
      return "REPLAY";
  }
  return "?";
}

const char* toString(LinkState state) {
  switch (state) {
    case LinkState::kClosed:
      return "closed";
    case LinkState::kConnecting:
      return "connecting";
    case LinkState::kUp:
      return "up";
    case LinkState::kQuiet:
      return "quiet";
    case LinkState::kLost:
      return "lost";
  }
  return "?";
}

struct RobotRuntime::Impl {
  std::shared_ptr<const planning::Workcell> workcell;
  RuntimeOptions options;
  SteadyClock steady;
  ManualClock manual{1000};
  std::atomic<bool> quit{false};
  std::thread thread;
  std::mutex life_mutex;  // One start, restart or end at a time.

  mutable std::mutex core_mutex;  // Held for copying a pointer only.
  std::shared_ptr<RobotCore> core;

  std::mutex event_mutex;  // Held for adding and taking only.
  std::deque<RuntimeEvent> events;
  std::mutex listener_mutex;
  std::vector<std::function<void(const RuntimeEvent&)>> listeners;

  const Clock& clock() const {
    if (options.lockstep) return manual;
    return steady;
  }

  std::shared_ptr<RobotCore> current() const {
    std::lock_guard<std::mutex> lock(core_mutex);
    return core;
  }

  void exchange(std::shared_ptr<RobotCore> next) {
    std::lock_guard<std::mutex> lock(core_mutex);
    core.swap(next);
  }

  void queue(const std::string& kind, const std::string& source, const std::string& text) {
    std::lock_guard<std::mutex> lock(event_mutex);
    if (events.size() >= kMaxEvents) events.pop_front();
    events.push_back({clock().now_s(), kind, source, text});
  }

  void dispatch() {
    std::deque<RuntimeEvent> taken;
    {
      std::lock_guard<std::mutex> lock(event_mutex);
      taken.swap(events);
    }
    if (taken.empty()) return;
    std::lock_guard<std::mutex> lock(listener_mutex);
    for (const auto& event : taken) {
      for (const auto& listener : listeners) listener(event);
    }
  }

  Status startCore() {
    auto made = RobotCore::create(workcell, options, clock(),
                                  [this](const std::string& kind, const std::string& source,
                                         const std::string& text) { queue(kind, source, text); });
    if (!made) return made.error();
    exchange(*made);
    quit.store(false);
    if (!options.lockstep) thread = std::thread([this, life = *made] { run(*life); });
    return {};
  }

  void run(RobotCore& life) {
    const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(kTick_s));
    for (auto next = std::chrono::steady_clock::now(); !quit.load();) {
      life.tick();
      dispatch();
      next += period;
      const auto now = std::chrono::steady_clock::now();
      if (next < now) next = now;  // Late: go on from here instead of catching up.
      std::this_thread::sleep_until(next);
    }
  }

  void endCore() {
    if (const auto life = current()) life->stop("console", "the console ends the connection");
    quit.store(true);
    if (thread.joinable()) thread.join();
    exchange(nullptr);
    dispatch();
  }

  // What a call answers while no robot is connected.
  static Error noRobot() { return {ErrorCode::kDisconnected, "no robot is connected; restart it"}; }

  Result<std::shared_ptr<hardware::Camera>> camera(const std::string& name) const {
    const auto life = current();
    if (!life) return noRobot();
    const auto found = life->devices().cameras.find(name);
    if (found == life->devices().cameras.end()) {
      return Error{ErrorCode::kNotFound, "this robot has no camera \"" + name + "\""};
    }
    return found->second;
  }
};

RobotRuntime::RobotRuntime() : m_impl(std::make_unique<Impl>()) {}

Result<std::unique_ptr<RobotRuntime>> RobotRuntime::start(std::shared_ptr<const planning::Workcell> workcell,
                                                          RuntimeOptions options) {
  std::unique_ptr<RobotRuntime> runtime(new RobotRuntime());
  runtime->m_impl->workcell = std::move(workcell);
  runtime->m_impl->options = std::move(options);
  if (auto status = runtime->m_impl->startCore(); !status) return status.error();
  return runtime;
}

RobotRuntime::~RobotRuntime() {
  std::lock_guard<std::mutex> lock(m_impl->life_mutex);
  m_impl->endCore();
}

RobotMode RobotRuntime::mode() const { return m_impl->options.mode; }
const planning::Workcell& RobotRuntime::workcell() const { return *m_impl->workcell; }
const Clock& RobotRuntime::clock() const { return m_impl->clock(); }

RuntimeStatus RobotRuntime::status() const {
  RuntimeStatus out;
  out.mode = mode();
  const auto core = m_impl->current();
  if (!core) {
    out.link = LinkState::kLost;
    out.link_text = Impl::noRobot().message;
    out.faults.push_back(out.link_text);
    return out;
  }
  const auto link = core->link();
  out.link = link.state;
  out.link_text = link.text;
  out.state_age_s = link.state_age_s;
  const auto motion = core->loop().state();
  out.player = motion.player;
  out.cursor = motion.cursor;
  out.arm_cursor = motion.arm_cursor;
  out.duration = motion.duration;
  out.rate = motion.rate;
  out.speed = motion.speed;
  out.notice = motion.notice;
  out.jogging = motion.jogging;
  out.jog = motion.jog;
  out.driving = motion.drive.driving;
  out.drive_notice = motion.drive.notice;
  if (core->devices().base) {
    if (const auto odometry = core->devices().base->odometry()) out.base = *odometry;
  }
  out.up = core->up();
  out.faults = core->faults();
  core->describeMotion(out);
  return out;
}

Status RobotRuntime::waitUntilUp(double timeout_s) {
  const SteadyClock steady;
  const double end = steady.now_s() + timeout_s;
  while (status().link != LinkState::kUp) {
    const auto core = m_impl->current();
    if (!core || (core->process() && !core->process()->running())) {
      return {ErrorCode::kDisconnected, core ? core->link().text : Impl::noRobot().message};
    }
    if (steady.now_s() > end) {
      return {ErrorCode::kTimeout,
              "no joint state within " + formatNumber(timeout_s) + " s: " + status().link_text};
    }
    if (m_impl->options.lockstep) {
      (void)step(kTick_s);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return {};
}

std::shared_ptr<const JointState> RobotRuntime::jointState() const {
  const auto core = m_impl->current();
  return core ? core->devices().arm->jointState() : nullptr;
}

Result<JointState> RobotRuntime::jointStateAt(double stamp_s) const {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  return core->devices().arm->jointStateAt(stamp_s);
}

Result<Eigen::VectorXd> RobotRuntime::configuration() const {
  const auto joints = jointState();
  if (!joints) return Error{ErrorCode::kStale, "the robot has not told its joints yet"};
  Eigen::VectorXd q = workcell().model->neutral();
  workcell().model->assign(*joints, q);
  return q;
}

Status RobotRuntime::load(const Trajectory& trajectory, double at_s) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  auto status = core->loop().load(trajectory, at_s);
  m_impl->queue(status ? "load" : "refused", "operator",
                status ? formatFixed(trajectory.duration(), 2) + " s" : status.error().message);
  return status;
}

void RobotRuntime::unload() {
  if (const auto core = m_impl->current()) core->loop().unload();
}

Status RobotRuntime::confine(double low_s, double high_s) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  return core->loop().confine(low_s, high_s);
}

Status RobotRuntime::play(const PlayOrder& order) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  const auto link = core->link();
  auto status = link.state == LinkState::kUp
                    ? core->loop().play(order)
                    : Status{ErrorCode::kStale,
                             "play: the link is " + std::string(toString(link.state)) + ": " + link.text};
  m_impl->queue(status ? "play" : "refused", "operator", status ? "" : status.error().message);
  return status;
}

void RobotRuntime::keepRunning() {
  if (const auto core = m_impl->current()) core->loop().keepRunning();
}

void RobotRuntime::pause() {
  if (const auto core = m_impl->current()) {
    core->loop().pause();
    m_impl->queue("pause", "operator", "");
  }
}

void RobotRuntime::setSpeed(double factor) {
  if (const auto core = m_impl->current()) core->loop().setSpeed(factor);
}

Status RobotRuntime::scrub(double cursor_s) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  return core->loop().scrub(cursor_s);
}

Status RobotRuntime::jog(const planning::JogCommand& command) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  return core->loop().jog(command);
}

void RobotRuntime::releaseJog() {
  if (const auto core = m_impl->current()) core->loop().releaseJog();
}

Status RobotRuntime::drive(const BaseTwist& wanted) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  return core->loop().drive(wanted);
}

void RobotRuntime::releaseDrive() {
  if (const auto core = m_impl->current()) core->loop().releaseDrive();
}

void RobotRuntime::setObstacles(const std::vector<planning::WorldObject>& objects) {
  if (const auto core = m_impl->current()) core->loop().setObstacles(objects);
}

Trajectory RobotRuntime::trajectory() const {
  const auto core = m_impl->current();
  return core ? core->loop().trajectory() : Trajectory{};
}

void RobotRuntime::stop(const std::string& source, const std::string& reason) noexcept {
  if (const auto core = m_impl->current()) core->stop(source, reason);
}

Status RobotRuntime::resetStop() {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  auto status = core->resetStop();
  m_impl->queue(status ? "reset" : "refused", "operator", status ? "" : status.error().message);
  return status;
}

Status RobotRuntime::setGripper(double position) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  if (!core->devices().gripper) return {ErrorCode::kNotFound, "this robot has no gripper"};
  return core->devices().gripper->setOpening(position);
}

double RobotRuntime::gripperPosition() const {
  const auto core = m_impl->current();
  return core && core->devices().gripper ? core->devices().gripper->position() : 0;
}

bool RobotRuntime::holding() const {
  const auto core = m_impl->current();
  return core && core->devices().gripper && core->devices().gripper->holding();
}

Status RobotRuntime::movePanTilt(const std::string& name, double pan, double tilt) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  const auto found = core->devices().pan_tilts.find(name);
  if (found == core->devices().pan_tilts.end()) {
    return {ErrorCode::kNotFound, "this robot has no pan-tilt \"" + name + "\""};
  }
  return found->second->moveTo(pan, tilt);
}

Result<PanTiltState> RobotRuntime::panTilt(const std::string& name) const {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  const auto found = core->devices().pan_tilts.find(name);
  if (found == core->devices().pan_tilts.end()) {
    return Error{ErrorCode::kNotFound, "this robot has no pan-tilt \"" + name + "\""};
  }
  return PanTiltState{found->second->pan(), found->second->tilt(), found->second->moving()};
}

std::shared_ptr<const hardware::Frame> RobotRuntime::cameraFrame(const std::string& name) const {
  const auto core = m_impl->current();
  if (!core) return nullptr;
  const auto found = core->devices().cameras.find(name);
  return found == core->devices().cameras.end() ? nullptr : found->second->latestFrame();
}

Status RobotRuntime::streamCamera(const std::string& name, bool on) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  if (core->devices().cameras.count(name) == 0) {
    return {ErrorCode::kNotFound, "this robot has no camera \"" + name + "\""};
  }
  core->streamCamera(name, on);
  return {};
}

Status RobotRuntime::setZoom(const std::string& camera, double zoom01) {
  const auto device = m_impl->camera(camera);
  return device ? (*device)->setZoom(zoom01) : Status(device.error());
}

Result<std::optional<double>> RobotRuntime::zoomAt(const std::string& camera, double stamp_s) const {
  const auto device = m_impl->camera(camera);
  if (!device) return device.error();
  if (!(*device)->zooms()) return std::optional<double>();
  const auto zoom = (*device)->zoomAt(stamp_s);
  if (!zoom) return zoom.error();
  return std::optional<double>(*zoom);
}

Status RobotRuntime::setFocus(const std::string& camera, double focus01) {
  const auto device = m_impl->camera(camera);
  return device ? (*device)->setFocus(focus01) : Status(device.error());
}

Status RobotRuntime::focusItself(const std::string& camera) {
  const auto device = m_impl->camera(camera);
  return device ? (*device)->focusItself() : Status(device.error());
}

std::optional<double> RobotRuntime::focus(const std::string& camera) const {
  const auto device = m_impl->camera(camera);
  if (!device || !(*device)->zooms()) return {};
  const auto focus = (*device)->focus();
  return focus ? std::optional<double>(*focus) : std::nullopt;
}

void RobotRuntime::touchGui() {
  if (const auto core = m_impl->current()) core->loop().touchGui();
}

Status RobotRuntime::restart() {
  std::lock_guard<std::mutex> lock(m_impl->life_mutex);
  m_impl->endCore();
  auto status = m_impl->startCore();
  m_impl->queue("process", "operator", status ? "the robot was restarted" : status.error().message);
  return status;
}

int RobotRuntime::virtualRobotPid() const {
  const auto core = m_impl->current();
  return core && core->process() ? core->process()->pid() : 0;
}

Result<std::string> RobotRuntime::callService(const std::string& service, const std::string& arguments,
                                              double timeout_s) {
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  if (!core->devices().call_service) {
    return Error{ErrorCode::kRefused, "service " + service + ": these devices answer no services"};
  }
  return core->devices().call_service(service, arguments, timeout_s);
}

void RobotRuntime::onEvent(std::function<void(const RuntimeEvent&)> callback) {
  std::lock_guard<std::mutex> lock(m_impl->listener_mutex);
  m_impl->listeners.push_back(std::move(callback));
}

Status RobotRuntime::step(double seconds) {
  if (!m_impl->options.lockstep) return {ErrorCode::kRefused, "step: this robot runs in real time"};
  const auto core = m_impl->current();
  if (!core) return Impl::noRobot();
  const int steps = std::max(1, static_cast<int>(std::lround(seconds / kTick_s)));
  for (int i = 0; i < steps; ++i) {
    core->tick();
    m_impl->manual.advance(kTick_s);
    if (core->devices().call_service) {
      const auto answer = core->devices().call_service("/virtual_robot/step", "{\"seconds\": 0.02}", kStepAnswer_s);
      if (!answer) {
        m_impl->dispatch();
        return answer.error();
      }
    }
  }
  m_impl->dispatch();
  return {};
}

}  // namespace longarm::session
