#include "session/robot/robot_core.h"

#include <chrono>
#include <thread>

#include "core/log.h"
#include "core/text.h"
#include "session/robot/rosbridge_devices.h"

namespace longarm::session {
namespace {

constexpr unsigned kUpkeepTicks = 5;    // Upkeep at a fifth of the motion rate: 10 Hz.
constexpr double kAliveAhead_s = 0.15;  // A motion thread that hangs for longer ends the heartbeat.
constexpr double kStart_s = 30;         // The virtual robot says its address long before on a machine that is not busy.
constexpr double kLost_s = 1.0;         // Joint states missing for longer: the link counts as lost.
constexpr double kOldAttitude_s = 1.0;  // An attitude older than this is not known any more.
constexpr double kStill = 0.02;         // Slower than this is standing still [rad/s or m/s].
// The gate's own cap on tool speed, beyond the planner's at twice its speed.
constexpr double kToolSpeedFactor = 2.1;

std::vector<std::string> robotArguments(const RuntimeOptions& options) {
  std::vector<std::string> out = {"--scenario", options.scenario, "--port",
                                  "0",          "--seed",         std::to_string(options.seed)};
  if (!options.variant.empty()) out.insert(out.end(), {"--variant", options.variant});
  if (options.lockstep) out.push_back("--lockstep");
  if (options.ideal) out.push_back("--ideal");
  if (!options.cameras) out.push_back("--no-cameras");
  return out;
}

MotionLoopOptions loopOptions(const RuntimeOptions& options) {
  return {options.start_tolerance, options.gate.max_state_age_s, options.gui_watchdog,
          options.gui_stop_jog_s,  options.gui_stop_motion_s,    options.gui_silent_s,
          options.player,          options.jog};
}

bool onThisMachine(const std::string& url) { return url.rfind("ws://127.0.0.1:", 0) == 0; }

hardware::GateChecks gateChecks(const planning::Workcell& workcell) {
  hardware::GateChecks checks;
  const auto model = workcell.model;
  const auto arm = workcell.arm;
  if (!model) return checks;
  const auto tip = model->linkIndex(arm.tip_link);
  if (!tip) return checks;
  checks.tool_position = [model, arm, link = *tip](const Eigen::VectorXd& values) -> Eigen::Vector3d {
    Eigen::VectorXd q = model->neutral();
    planning::setGroupPositions(*model, arm, values, q);
    return model->forward(q, link).translation();
  };
  checks.max_tool_speed = kToolSpeedFactor * workcell.max_tool_speed;
  return checks;
}

}  // namespace

RobotCore::RobotCore(std::shared_ptr<const planning::Workcell> workcell, const RuntimeOptions& options,
                     const Clock& clock, MotionLoop::Report report)
    : m_cell(std::move(workcell)), m_workcell(*m_cell), m_options(options), m_clock(clock), m_report(std::move(report)) {
  if (!options.stream_cameras) return;
  for (const auto& camera : m_workcell.cameras) m_streams.insert(camera.name);
}

Result<std::shared_ptr<RobotCore>> RobotCore::create(std::shared_ptr<const planning::Workcell> workcell,
                                                     const RuntimeOptions& options, const Clock& clock,
                                                     MotionLoop::Report report) {
  std::shared_ptr<RobotCore> core(new RobotCore(std::move(workcell), options, clock, std::move(report)));
  if (options.mode == RobotMode::kReplay) {
    return Error{ErrorCode::kInvalidInput, "a replay has no robot to connect to"};
  }
  if (auto status = core->connect(); !status) return status.error();
  return core;
}

RobotCore::~RobotCore() {
  if (m_gate) m_gate->stop("console", "the console disconnects");
  for (auto* device : allDevices()) device->close();
}

Status RobotCore::startProcess() {
  const auto executable = VirtualRobotProcess::find(m_options.virtual_robot);
  if (!executable) return executable.error();
  auto process = VirtualRobotProcess::start(*executable, robotArguments(m_options), kStart_s);
  if (!process) return process.error();
  m_process = std::move(*process);
  m_url = m_process->url();
  if (!onThisMachine(m_url)) {
    return {ErrorCode::kRefused, "the virtual robot answers at " + m_url + ", which is not this machine"};
  }
  return {};
}

Status RobotCore::connect() {
  m_url = m_workcell.backend.url;
  const bool own_devices = static_cast<bool>(m_options.make_devices);
  const bool is_virtual = m_options.mode == RobotMode::kVirtual && !own_devices;
  if (is_virtual) {
    if (auto status = startProcess(); !status) return status;
  }
  if (m_options.through) m_url = m_options.through(m_url);
  if (is_virtual && !onThisMachine(m_url)) {
    return {ErrorCode::kRefused, "the virtual robot answers at " + m_url + ", which is not this machine"};
  }
  auto devices = own_devices ? m_options.make_devices(m_workcell, m_url, m_clock)
                             : makeRosbridgeDevices(m_workcell, m_url, m_clock);
  if (!devices) return devices.error();
  m_devices = std::move(*devices);
  makeMotion();
  for (auto* device : allDevices()) {
    if (auto status = device->open(); !status)
      logLine(LogLevel::kWarning, "session.robot", status.error().message);
  }
  if (m_options.lockstep) waitUntilOpen();
  return {};
}

// In lockstep the first cycle finds the devices as it always does, however long the connection takes.
void RobotCore::waitUntilOpen() const {
  constexpr double kPatience_s = 5;
  const SteadyClock steady;
  for (const double end = steady.now_s() + kPatience_s; steady.now_s() < end;) {
    bool opening = false;
    for (const auto* device : allDevices()) opening |= device->state() == hardware::DeviceState::kOpening;
    if (!opening) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

void RobotCore::makeMotion() {
  const auto joints = m_workcell.armJointNames();
  m_gate = std::make_unique<hardware::MotionGate>(m_devices.arm, joints, m_workcell.arm_limits, m_clock,
                                                  m_options.gate, gateChecks(m_workcell));
  m_loop = std::make_unique<MotionLoop>(m_devices.arm, *m_gate, m_cell, m_clock, loopOptions(m_options), m_report);
  if (m_devices.base && m_workcell.base) m_loop->setBase(m_devices.base, *m_workcell.base);
  m_gate->onStop([this](const std::string& source, const std::string& reason) {
    m_loop->noteStop();
    m_report("stop", source, reason);
  });
}

std::vector<hardware::Device*> RobotCore::allDevices() const {
  std::vector<hardware::Device*> out;
  if (m_devices.arm) out.push_back(m_devices.arm.get());
  if (m_devices.base) out.push_back(m_devices.base.get());
  if (m_devices.gripper) out.push_back(m_devices.gripper.get());
  if (m_devices.imu) out.push_back(m_devices.imu.get());
  for (const auto& [name, device] : m_devices.pan_tilts) out.push_back(device.get());
  for (const auto& [name, device] : m_devices.cameras) out.push_back(device.get());
  return out;
}

void RobotCore::tick() {
  m_loop->tick();
  if (m_devices.alive_until_s && m_loop->heartbeatAllowed()) {
    m_devices.alive_until_s->store(m_clock.now_s() + kAliveAhead_s);
  }
  if (m_ticks++ % kUpkeepTicks != 0) return;
  upkeep();
  reportLink();
}

// Devices that need no permission to work become active when their connection stands; the arm waits for
// resetStop().  An arm that has lost its link or is in fault stays stopped until then, whether it moved or not.
void RobotCore::upkeep() {
  if (!m_gate->stopped() && m_devices.arm->state() != hardware::DeviceState::kActive) {
    const auto why = m_devices.arm->message();
    m_gate->stop("link", why.empty() ? "the arm is not active any more; release STOP to go on" : why);
  }
  const auto activate = [](hardware::Device& device) {
    if (device.state() == hardware::DeviceState::kIdle && !device.activate()) return;
  };
  if (m_devices.gripper) activate(*m_devices.gripper);
  if (m_devices.imu) activate(*m_devices.imu);
  for (const auto& [name, device] : m_devices.pan_tilts) activate(*device);
  std::lock_guard<std::mutex> lock(m_mutex);
  for (const auto& [name, device] : m_devices.cameras) {
    const bool wanted = m_streams.count(name) != 0;
    if (wanted) activate(*device);
    if (!wanted && device->state() == hardware::DeviceState::kActive) device->deactivate();
  }
}

void RobotCore::streamCamera(const std::string& name, bool on) {
  std::lock_guard<std::mutex> lock(m_mutex);
  if (on) {
    m_streams.insert(name);
  } else {
    m_streams.erase(name);
  }
}

void RobotCore::reportLink() {
  const auto report = link();
  if (report.state == LinkState::kUp) m_was_up.store(true);
  if (report.state == m_reported_link) return;
  m_reported_link = report.state;
  m_report("link", toString(report.state), report.text);
}

void RobotCore::stop(const std::string& source, const std::string& reason) noexcept {
  m_gate->stop(source, reason);
  if (m_devices.gripper) m_devices.gripper->stop();
  for (const auto& [name, device] : m_devices.pan_tilts) device->stop();
  for (const auto& [name, device] : m_devices.cameras) device->haltLens();
}

Status RobotCore::resetStop() {
  auto& arm = *m_devices.arm;
  if (arm.state() == hardware::DeviceState::kFault) {
    if (auto status = arm.clearFault(); !status) return status;
  }
  for (auto* device : allDevices()) {    // what still fails keeps its fault and says so
    if (device->state() != hardware::DeviceState::kFault) continue;
    if (const auto status = device->clearFault(); !status) m_report("fault", device->name(), status.error().message);
  }
  return m_gate->reset();
}

LinkReport RobotCore::link() const {
  LinkReport report;
  const auto joints = m_devices.arm->jointState();
  if (joints) report.state_age_s = m_clock.now_s() - joints->stamp_s;
  const double age = report.state_age_s;
  if (m_process && !m_process->running()) {
    report.state = LinkState::kLost;
    report.text = "the virtual robot " + m_process->ending() + "; restart it";
  } else if (!joints) {
    report.state =
        m_devices.arm->state() == hardware::DeviceState::kFault ? LinkState::kLost : LinkState::kConnecting;
    const auto why = m_devices.arm->message();
    report.text = why.empty() ? "connecting to " + m_url : why;
  } else if (age > kLost_s) {
    report.state = LinkState::kLost;
    report.text = "link lost for " + formatFixed(age, 1) + " s";
  } else if (age > m_options.gate.max_state_age_s) {
    report.state = LinkState::kQuiet;
    report.text = "no joint state for " + formatFixed(age, 2) + " s";
  } else {
    report.state = LinkState::kUp;
    report.text = "connected";
  }
  return report;
}

std::optional<Eigen::Vector3d> RobotCore::up() const {
  const auto attitude = m_devices.imu ? m_devices.imu->attitude() : nullptr;
  if (!attitude || !m_workcell.imu || m_clock.now_s() - attitude->stamp_s > kOldAttitude_s) return std::nullopt;
  const auto joints = m_devices.arm->jointState();
  const auto link = m_workcell.model->linkIndex(m_workcell.imu->link);
  if (!joints || !link) return std::nullopt;
  Eigen::VectorXd q = m_workcell.model->neutral();
  m_workcell.model->assign(*joints, q);
  return (m_workcell.model->forward(q, *link).linear() * attitude->up).normalized();
}

std::vector<std::string> RobotCore::faults() const {
  std::vector<std::string> out;
  if (m_process && !m_process->running()) out.push_back("The virtual robot " + m_process->ending() + ".");
  for (const auto* device : allDevices()) {
    if (device->state() == hardware::DeviceState::kFault)
      out.push_back(device->name() + ": " + device->message());
  }
  return out;
}

// By measured velocities, or where there are none by the change over the last 0.15 s.
bool RobotCore::standsStill() const {
  const auto joints = m_devices.arm->jointState();
  if (!joints) return false;
  if (joints->velocities.size() > 0) return joints->velocities.cwiseAbs().maxCoeff() < kStill;
  constexpr double kSpan_s = 0.15;
  const auto before = m_devices.arm->jointStateAt(joints->stamp_s - kSpan_s);
  if (!before || before->positions.size() != joints->positions.size()) return false;
  return (joints->positions - before->positions).cwiseAbs().maxCoeff() < kStill * kSpan_s;
}

void RobotCore::describeMotion(RuntimeStatus& status) const {
  status.gate = m_gate->status();
  status.stop_confirmed = status.gate.stopped && standsStill();
  const auto commanded = m_gate->commandedAt(m_clock.now_s());
  if (!commanded) return;
  status.moving = commanded->velocities.size() > 0 && commanded->velocities.cwiseAbs().maxCoeff() > 1e-9;
  const auto joints = m_devices.arm->jointState();
  const auto names = m_workcell.armJointNames();
  if (!joints) return;
  const auto measured = joints->positionsOf(names);
  if (!measured || measured->size() != commanded->positions.size() || measured->size() == 0) return;
  Eigen::Index worst = 0;
  status.tracking_error = (commanded->positions - *measured).cwiseAbs().maxCoeff(&worst);
  status.tracking_joint = names[static_cast<std::size_t>(worst)];
}

}  // namespace longarm::session
